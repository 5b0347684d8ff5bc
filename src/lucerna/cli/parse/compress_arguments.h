// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lucerna/cli/parse/command.h"
#include "lucerna/cli/parse/session.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

/// What the options of `compress` say, as text.
struct CompressArguments {
  std::vector<std::string> inputs;
  std::string output, method = "adaptive", max_bytes, flux, seed = "1", held_out = "2e6", report;

  std::vector<std::filesystem::path> files() const { return {inputs.begin(), inputs.end()}; }
};

/// Adds them to a command. `arguments` and `session` must outlive it.
void add_compress_options(Command& command, CompressArguments& arguments, Session& session);

/// Throws UsageError on what cannot be, by the words alone.
CompressOptions compress_options(const CompressArguments& arguments);

/// Before the work: inputs are ray files, the results can be written. Throws InputError.
void check_compress(const CompressArguments& arguments);

}  // namespace lucerna::cli
