// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "lucerna/project/schema/project_keys.h"

namespace lucerna {

/// Whether a key of that name, in any table, names a file.
inline bool names_file(std::string_view key) {
  return std::ranges::any_of(project_keys(),
                             [&](const ProjectKey& k) { return k.type == KeyType::file && k.key == key; });
}

/// Calls `change(name)` with the name of every file in the tables, a string that it may replace.
template <class Change>
void for_each_file(toml::table& table, const Change& change) {
  for (auto&& [key, node] : table) {
    if (auto* inner = node.as_table()) for_each_file(*inner, change);
    if (auto* array = node.as_array()) {
      for (auto&& item : *array) {
        if (auto* inner = item.as_table()) for_each_file(*inner, change);
      }
    }
    if (node.is_string() && names_file(key.str())) change(node.as_string()->get());
  }
}

}  // namespace lucerna
