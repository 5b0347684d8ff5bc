// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#pragma GCC visibility push(default)
namespace lucerna {

/// Everything that Lucerna throws. The text says what is wrong, where, what was found and what was expected.
class Error : public std::runtime_error {
 public:
  /// `option` is a literal: it is not copied.
  explicit Error(const std::string& what, std::string_view option = {})
      : std::runtime_error(what), option_(option) {}

  /// The field of the call's options that would help: "salvage", "flux", "format", "device"; empty where none
  /// is known.
  std::string_view option() const noexcept { return option_; }

 private:
  std::string_view option_;
};

/// The input is bad: a file, a project, a set of rays.
class InputError : public Error {
 public:
  using Error::Error;
};

/// The call itself is bad: an unknown option, a format that cannot be chosen.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// The caller's Progress asked to stop. What was whole has been written.
class Interrupted : public Error {
 public:
  Interrupted() : Error("interrupted") {}
};

}  // namespace lucerna
#pragma GCC visibility pop
