// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "lucerna/core/io/error.h"

namespace lucerna {

/// Numbers and arrays as the bytes that ranks of one program send each other, in the machine's byte order.
inline void append(std::string& bytes, std::uint64_t number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// Takes it from the front. That there are eight bytes is checked.
inline std::uint64_t take(std::string_view& bytes) {
  std::uint64_t number = 0;
  LUCERNA_CHECK(bytes.size() >= sizeof number, "a message ends {} bytes early", sizeof number - bytes.size());
  std::memcpy(&number, bytes.data(), sizeof number);
  bytes.remove_prefix(sizeof number);
  return number;
}

/// The bits of a number.
inline void append_double(std::string& bytes, double number) {
  append(bytes, std::bit_cast<std::uint64_t>(number));
}
inline double take_double(std::string_view& bytes) { return std::bit_cast<double>(take(bytes)); }

/// The length, then the characters.
inline void append_text(std::string& bytes, std::string_view text) {
  append(bytes, std::uint64_t{text.size()});
  bytes += text;
}
inline std::string take_text(std::string_view& bytes) {
  const std::uint64_t n = take(bytes);
  LUCERNA_CHECK(n <= bytes.size(), "a message of {} bytes is to hold a text of {}", bytes.size(), n);
  std::string text(bytes.substr(0, n));
  bytes.remove_prefix(n);
  return text;
}

/// The length, then the items.
template <class T>
void append(std::string& bytes, const std::vector<T>& items) {
  static_assert(std::is_trivially_copyable_v<T>);
  append(bytes, std::uint64_t{items.size()});
  if (!items.empty()) bytes.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T));
}

/// The length is checked against the bytes that there are.
template <class T>
void take(std::string_view& bytes, std::vector<T>& items) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::uint64_t n = take(bytes);
  LUCERNA_CHECK(n <= bytes.size() / sizeof(T), "a message of {} bytes is to hold {} items", bytes.size(), n);
  items.resize(n);
  if (items.empty()) return;
  std::memcpy(items.data(), bytes.data(), items.size() * sizeof(T));
  bytes.remove_prefix(items.size() * sizeof(T));
}

}  // namespace lucerna
