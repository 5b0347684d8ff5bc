// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

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

/// An error in a file: "FILE: byte 20: ray count 5000000 needs 140000000 bytes, the file has 2816".
template <class... Args>
[[noreturn]] void throw_input_error(std::string_view file, std::string_view place,
                                    fmt::format_string<Args...> text, Args&&... args) {
  const std::string what = fmt::format(text, std::forward<Args>(args)...);
  throw InputError(place.empty() ? fmt::format("{}: {}", file, what)
                                 : fmt::format("{}: {}: {}", file, place, what));
}

namespace detail {
[[noreturn]] void check_failed(const char* condition, const char* file, int line, const std::string& values);
}

}  // namespace lucerna

/// An invariant of our own: always on; on failure throws std::logic_error with the condition and the values
/// given, `LUCERNA_CHECK(i < n, "i = {}, n = {}", i, n)`. Never for bad input.
#define LUCERNA_CHECK(condition, ...)                                                              \
  do {                                                                                             \
    if (!(condition)) [[unlikely]] {                                                               \
      ::lucerna::detail::check_failed(#condition, __FILE__, __LINE__, ::fmt::format(__VA_ARGS__)); \
    }                                                                                              \
  } while (false)
