// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

#include "lucerna/error.h"

namespace lucerna {

/// A file that breaks its format, which `option` (a literal, Error::option) of the call would help with.
template <class... Args>
[[noreturn]] void throw_input_error_for(std::string_view option, std::string_view file,
                                        std::string_view place, fmt::format_string<Args...> text,
                                        Args&&... args) {
  const std::string what = fmt::format(text, std::forward<Args>(args)...);
  throw InputError(
      place.empty() ? fmt::format("{}: {}", file, what) : fmt::format("{}: {}: {}", file, place, what),
      ErrorCause::damaged, option);
}

/// A file that breaks its format: "FILE: byte 20: ray count 5000000 needs 140000000 bytes, the file has
/// 2816".
template <class... Args>
[[noreturn]] void throw_input_error(std::string_view file, std::string_view place,
                                    fmt::format_string<Args...> text, Args&&... args) {
  throw_input_error_for("", file, place, text, std::forward<Args>(args)...);
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
