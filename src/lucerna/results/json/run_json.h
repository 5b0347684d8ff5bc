// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/progress.h"

namespace lucerna {

/// What a run was made of, for the record.
struct RunRecord {
  /// As a shell would take it; empty where a program called the library.
  std::string command;
  /// Files that the result depends on; each once.
  std::vector<std::filesystem::path> inputs;
  /// Wall times by phase.
  std::vector<std::pair<std::string, double>> wall_s;
};

/// The keys that every JSON result begins with: program_version, schema_version, command, seed, threads, isa,
/// inputs with their hashes, wall_s. `isa` is the instruction set that computed it. Reads the inputs whole;
/// throws InputError where one cannot be read.
nlohmann::ordered_json run_json(const RunRecord& run, std::optional<std::uint64_t> seed,
                                const std::string& isa = "scalar");

/// write_report (report.h) with what a model's page says of its run; the inputs are added.
void write_report(const std::filesystem::path& input, const std::filesystem::path& html,
                  const std::vector<std::filesystem::path>& ray_files, RunRecord run, Progress& progress);

}  // namespace lucerna
