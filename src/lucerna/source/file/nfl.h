// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/flux_unit.h"

namespace lucerna {

/// Four ASCII characters that name a method or a section.
using NflTag = std::array<char, 4>;

/// A model file (.nfl) taken apart, whatever its method: docs/reference/nfl.md has every byte.
struct NflFile {
  NflTag method{};
  double flux = 0.0;
  FluxUnit flux_unit = FluxUnit::lumen;
  std::uint64_t training_rays = 0;

  struct Section {
    NflTag tag{};
    std::string bytes;  // not compressed
  };
  std::vector<Section> sections;
  /// The oldest version of the format that has all that the sections hold.
  std::uint32_t version = 1;

  void add(const NflTag& tag, std::string bytes) { sections.push_back({tag, std::move(bytes)}); }
};

inline constexpr std::string_view kNflMagic{"\x89NFL\r\n\x1a\n", 8};
/// Larger files and sections are refused: no model comes near.
inline constexpr std::uint64_t kNflLargestFile = std::uint64_t{1} << 28,
                               kNflLargestSection = std::uint64_t{1} << 28;
/// Bytes that a stored byte may stand for at most (plus 64 KiB a section).
inline constexpr std::uint64_t kNflLargestRatio = 4096;

/// The tag with bytes that do not print as '?'.
std::string printable_tag(const NflTag& tag);

/// The bytes of a file: header, section table, zstd-compressed sections, SHA-256.
std::string encode_nfl(const NflFile& file);

/// The inverse. Throws InputError "NAME: byte N: found, expected" unless the bytes are one whole file of a
/// known version; allocates nothing that the bytes' own length does not vouch for.
NflFile decode_nfl(std::string_view bytes, std::string_view name);

/// Appends little-endian numbers to a section.
class NflWriter {
 public:
  void u8(std::uint8_t x) { bytes_.push_back(static_cast<char>(x)); }
  void u32(std::uint32_t x) { number(x, 4); }
  void u64(std::uint64_t x) { number(x, 8); }
  void f64(double x);
  /// 7 bits a byte, the low ones first, the high bit set but in the last.
  void varint(std::uint64_t x);
  /// Signed numbers near 0 as short varints.
  void signed_varint(std::int64_t x);
  std::string take() { return std::move(bytes_); }

 private:
  void number(std::uint64_t x, int count);
  std::string bytes_;
};

/// Takes a section's numbers one by one; throws InputError naming file, section and byte when they end or
/// make no sense.
class NflReader {
 public:
  /// The section must exist. `file` and `name` must outlive the reader.
  NflReader(const NflFile& file, const NflTag& tag, std::string_view name);

  std::uint8_t u8();
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  /// Refuses what is not finite.
  double f64();
  std::uint64_t varint();
  std::int64_t signed_varint();

  std::size_t left() const { return bytes_.size() - at_; }
  /// Refuses bytes that nobody read.
  void finish() const;
  [[noreturn]] void fail(std::string_view what) const;
  void expect(bool good, std::string_view what) const {
    if (!good) fail(what);
  }

 private:
  std::uint64_t number(std::size_t count);
  std::string_view bytes_, name_;
  NflTag tag_;
  std::size_t at_ = 0;
};

}  // namespace lucerna
