// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/error.h"

namespace lucerna {

std::string_view to_string(ErrorCause cause) {
  switch (cause) {
    case ErrorCause::invalid:
      return "invalid";
    case ErrorCause::out_of_range:
      return "out of range";
    case ErrorCause::missing:
      return "missing";
    case ErrorCause::unknown_key:
      return "unknown key";
    case ErrorCause::contradiction:
      return "contradiction";
    case ErrorCause::mismatch:
      return "mismatch";
    case ErrorCause::not_found:
      return "not found";
    case ErrorCause::unreadable:
      return "unreadable";
    case ErrorCause::unwritable:
      return "unwritable";
    case ErrorCause::no_space:
      return "no space";
    case ErrorCause::damaged:
      return "damaged";
    case ErrorCause::unsupported:
      return "unsupported";
    case ErrorCause::usage:
      return "usage";
    case ErrorCause::interrupted:
      return "interrupted";
  }
  return "";
}

namespace detail {

void check_failed(const char* condition, const char* file, int line, const std::string& values) {
  throw std::logic_error(
      fmt::format("internal check failed: {} ({}) at {}:{}", condition, values, file, line));
}

}  // namespace detail
}  // namespace lucerna
