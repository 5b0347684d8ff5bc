// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lucerna {

/// Numbers and arrays as the bytes that ranks of one program send each other, in the machine's byte order.
inline void append(std::string& bytes, std::uint64_t number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// Takes it from the front, which must have eight bytes.
inline std::uint64_t take(std::string_view& bytes) {
  std::uint64_t number = 0;
  std::memcpy(&number, bytes.data(), sizeof number);
  bytes.remove_prefix(sizeof number);
  return number;
}

/// The length, then the items.
template <class T>
void append(std::string& bytes, const std::vector<T>& items) {
  static_assert(std::is_trivially_copyable_v<T>);
  append(bytes, std::uint64_t{items.size()});
  if (!items.empty()) bytes.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T));
}

template <class T>
void take(std::string_view& bytes, std::vector<T>& items) {
  static_assert(std::is_trivially_copyable_v<T>);
  items.resize(take(bytes));
  if (items.empty()) return;
  std::memcpy(items.data(), bytes.data(), items.size() * sizeof(T));
  bytes.remove_prefix(items.size() * sizeof(T));
}

}  // namespace lucerna
