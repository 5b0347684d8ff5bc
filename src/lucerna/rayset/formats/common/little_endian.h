// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/core/io/error.h"

namespace lucerna {

/// The number of type T at `offset` of `bytes` (little-endian file, little-endian machine; record_file.cpp
/// asserts it).
template <class T>
T load(std::span<const std::byte> bytes, std::size_t offset) {
  LUCERNA_CHECK(offset <= bytes.size() && sizeof(T) <= bytes.size() - offset, "offset {} of {}", offset,
                bytes.size());
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

/// Puts a number at `offset` of `bytes`.
template <class T>
void store(std::span<std::byte> bytes, std::size_t offset, const T& value) {
  LUCERNA_CHECK(offset <= bytes.size() && sizeof(T) <= bytes.size() - offset, "offset {} of {}", offset,
                bytes.size());
  std::memcpy(bytes.data() + offset, &value, sizeof(T));
}

/// A fixed field of `size` chars as text: up to the first NUL, without blanks at the end; control characters
/// become '?'.
inline std::string load_text(std::span<const std::byte> bytes, std::size_t offset, std::size_t size) {
  std::string text(size, '\0');
  std::memcpy(text.data(), bytes.subspan(offset, size).data(), size);
  text.resize(std::min(text.find('\0'), text.size()));
  text.resize(text.find_last_not_of(' ') + 1);
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return text;
}

/// Puts as much of `text` as fits into `size - 1` bytes at `offset`; the rest of the field stays as it is.
inline void store_text(std::span<std::byte> bytes, std::size_t offset, std::size_t size,
                       std::string_view text) {
  const std::size_t n = std::min(text.size(), size - 1);
  std::memcpy(bytes.subspan(offset, size).data(), text.data(), n);
}

}  // namespace lucerna
