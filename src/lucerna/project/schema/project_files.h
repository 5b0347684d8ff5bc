// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <string>

namespace lucerna {

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
    if (key.str() == "file" && node.is_string()) change(node.as_string()->get());
  }
}

}  // namespace lucerna
