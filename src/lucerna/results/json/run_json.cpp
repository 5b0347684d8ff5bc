// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/run_json.h"

#include <nlohmann/json.hpp>
#include <set>

#include "lucerna/core/io/file.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/version.h"

namespace lucerna {

nlohmann::ordered_json run_json(const RunRecord& run, std::optional<std::uint64_t> seed,
                                const std::string& isa) {
  using Json = nlohmann::ordered_json;
  Json head;
  head["program_version"] = std::string(version());
  head["schema_version"] = kJsonSchemaVersion;
  head["command"] = run.command;
  head["seed"] = seed ? Json(*seed) : Json();
  head["threads"] = ThreadLimit::current();
  head["isa"] = isa;
  head["inputs"] = Json::array();
  std::set<std::filesystem::path> seen;
  for (const auto& path : run.inputs) {
    if (!seen.insert(path).second) continue;
    head["inputs"].push_back({{"path", path.string()}, {"sha256", sha256_of_file(path)}});
  }
  head["wall_s"] = Json::object();
  for (const auto& [name, elapsed] : run.wall_s) head["wall_s"][name] = elapsed;
  return head;
}

}  // namespace lucerna
