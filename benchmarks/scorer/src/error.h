// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <stdexcept>
#include <string>

namespace bench {

/// A number as messages have it: nine digits, the shortest form.
inline std::string shown(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

/// A file that cannot be used: which file, where in it, what was found, what was expected.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& file, const std::string& place, const std::string& found,
             const std::string& expected)
      : std::runtime_error(file + ": " + place + ": found " + found + ", expected " + expected) {}
};

}  // namespace bench
