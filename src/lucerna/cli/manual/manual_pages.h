// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace lucerna::cli {

/// A page of section 1 of the manual, in the macros of man(7).
struct ManualPage {
  /// Of its file: "lucerna-trace.1".
  std::string name;
  std::string text;
};

/// "lucerna.1", then one for each command, from the program's own options.
std::vector<ManualPage> manual_pages();

}  // namespace lucerna::cli
