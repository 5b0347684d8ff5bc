// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace lucerna {

/// Everything that Lucerna throws. The text says what is wrong, where, what was found and what was expected.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The input is bad: a file, a project, a set of rays. The program ends with exit code 1.
class InputError : public Error {
 public:
  using Error::Error;
};

/// The call itself is bad: an unknown option, a format that cannot be chosen. Exit code 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// The caller's Progress asked to stop. Exit code 3; what was whole has been written.
class Interrupted : public Error {
 public:
  Interrupted() : Error("interrupted") {}
};

}  // namespace lucerna
