// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// All of a message: what() ends at a zero byte, and a terminal obeys others.
std::string printable(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7f) {
      out += fmt::format("\\x{:02x}", byte);
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

Error::Error(const std::string& what, ErrorCause cause, std::string_view option)
    : std::runtime_error(printable(what)), cause_(cause), option_(option) {}

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
