// SPDX-License-Identifier: Apache-2.0
#include "tests/support/result_paths.h"

#include <nlohmann/json.hpp>

#include "lucerna/results/json/result_fields.h"

namespace lucerna::test {

namespace {

using Json = nlohmann::ordered_json;

bool is_estimate(const Json& json) {
  return json.size() == 2 && json.contains("value") && json.contains("standard_error");
}
bool is_box_error(const Json& json) {
  return json.size() == 4 && json.contains("value") && json.contains("floor");
}

void collect(const Json& json, const std::string& path, std::set<std::string>& out) {
  if (json.is_object() && !is_estimate(json) && !is_box_error(json)) {
    for (const auto& [key, value] : json.items()) collect(value, path.empty() ? key : path + "." + key, out);
  } else if (json.is_array() && !(json.size() > 0 && json.front().is_number())) {
    for (const Json& item : json) collect(item, path + "[]", out);
  } else {
    out.insert(path);
  }
}

}  // namespace

std::set<std::string> result_paths(const Json& json) {
  std::set<std::string> paths;
  collect(json, "", paths);
  return paths;
}

std::set<std::string> unknown_paths(const Json& json, const std::set<std::string_view>& of,
                                    std::set<std::string_view>& unseen) {
  std::set<std::string> unknown;
  for (const std::string& path : result_paths(json)) {
    bool known = false;
    for (const auto& fields : {result_fields(), command_fields()}) {
      for (const ResultField& f : fields) {
        if (!of.contains(f.of) || !stands_for(f.path, path)) continue;
        known = true;
        unseen.erase(f.path);
      }
    }
    if (!known) unknown.insert(path);
  }
  return unknown;
}

}  // namespace lucerna::test
