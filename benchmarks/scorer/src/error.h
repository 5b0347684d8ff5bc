// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace bench {

/// A file that cannot be used: which file, where in it, what was found, what was expected.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& file, const std::string& place, const std::string& found,
             const std::string& expected)
      : std::runtime_error(file + ": " + place + ": found " + found + ", expected " + expected) {}
};

}  // namespace bench
