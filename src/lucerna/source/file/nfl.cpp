// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/file/nfl.h"

#include <openssl/evp.h>
#include <zstd.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr std::uint32_t kNewestVersion = 2;
constexpr std::size_t kHeader = 56, kTableEntry = 24, kDigest = 32;
constexpr std::uint32_t kMaxSections = 1024;
constexpr int kZstdLevel = 19;

std::string sha256(std::string_view bytes) {
  std::string digest(kDigest, '\0');
  unsigned int length = 0;
  LUCERNA_CHECK(EVP_Digest(bytes.data(), bytes.size(), reinterpret_cast<unsigned char*>(digest.data()),
                           &length, EVP_sha256(), nullptr) == 1 &&
                    length == kDigest,
                "SHA-256 gave {} bytes", length);
  return digest;
}

std::string compressed(const std::string& bytes) {
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t n = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kZstdLevel);
  LUCERNA_CHECK(!ZSTD_isError(n), "zstd: {}", ZSTD_getErrorName(n));
  out.resize(n);
  LUCERNA_CHECK(bytes.size() <= kNflLargestSection && bytes.size() <= kNflLargestRatio * n + 65536,
                "a section of {} bytes, {} stored", bytes.size(), n);
  return out;
}

std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t x = 0;
  for (std::size_t i = 0; i < count; ++i)
    x |= std::uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  return x;
}

NflTag tag_at(std::string_view bytes, std::size_t at) {
  NflTag tag;
  std::memcpy(tag.data(), bytes.data() + at, tag.size());
  return tag;
}

void check_frame(std::string_view bytes, std::string_view name) {
  const std::size_t known = std::min(bytes.size(), kNflMagic.size());
  if (known == 0 || bytes.substr(0, known) != kNflMagic.substr(0, known)) {
    throw_input_error(name, "byte 0", "not a Lucerna model file");
  }
  if (bytes.size() < kHeader + kDigest) {
    throw_input_error(name, fmt::format("byte {}", bytes.size()),
                      "the file ends; a model has at least {} bytes", kHeader + kDigest);
  }
  const std::uint64_t version = number_at(bytes, 8, 4);
  if (version < 1 || version > kNewestVersion) {
    throw_input_error(name, "byte 8", "version {}; this program reads versions 1 to {}", version,
                      kNewestVersion);
  }
  const std::uint64_t size = number_at(bytes, 16, 8);
  if (size != bytes.size()) {
    throw_input_error(name, "byte 16", "the file should have {} bytes, it has {}", size, bytes.size());
  }
  const std::string_view body = bytes.substr(0, bytes.size() - kDigest);
  if (sha256(body) != bytes.substr(body.size())) {
    throw_input_error(name, fmt::format("byte {}", body.size()),
                      "the checksum does not match: the file is damaged");
  }
}

std::string section_bytes(std::string_view stored, std::uint64_t raw, std::string_view name, std::size_t at) {
  const std::string place = fmt::format("byte {}", at);
  // What the frame itself says must agree before anything is allocated.
  const unsigned long long said = ZSTD_getFrameContentSize(stored.data(), stored.size());
  if (said != raw || raw > kNflLargestSection || raw > kNflLargestRatio * stored.size() + 65536) {
    throw_input_error(name, place, "the section's size {} is not what its data says", raw);
  }
  std::string out(raw, '\0');
  const std::size_t n = ZSTD_decompress(out.data(), out.size(), stored.data(), stored.size());
  if (ZSTD_isError(n) || n != raw)
    throw_input_error(name, place, "the section does not decompress to {} bytes", raw);
  return out;
}

}  // namespace

std::string printable_tag(const NflTag& tag) {
  std::string text;
  for (const char c : tag) text += c > ' ' && c < '\x7f' ? c : '?';
  return text;
}

std::string encode_nfl(const NflFile& file) {
  std::vector<std::string> stored;
  std::uint64_t total = kHeader + kDigest + kTableEntry * file.sections.size();
  for (const auto& section : file.sections) {
    stored.push_back(compressed(section.bytes));
    total += stored.back().size();
  }
  NflWriter w;
  for (const char c : kNflMagic) w.u8(static_cast<std::uint8_t>(c));
  w.u32(file.version);
  for (const char c : file.method) w.u8(static_cast<std::uint8_t>(c));
  w.u64(total);
  w.f64(file.flux);
  w.u64(file.training_rays);
  w.u32(file.flux_unit == FluxUnit::lumen ? 0 : 1);
  w.u32(static_cast<std::uint32_t>(file.sections.size()));
  w.u64(0);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    for (const char c : file.sections[i].tag) w.u8(static_cast<std::uint8_t>(c));
    w.u32(0);
    w.u64(file.sections[i].bytes.size());
    w.u64(stored[i].size());
  }
  std::string bytes = w.take();
  for (const std::string& s : stored) bytes += s;
  return bytes + sha256(bytes);
}

NflFile decode_nfl(std::string_view bytes, std::string_view name) {
  check_frame(bytes, name);
  NflFile file;
  file.method = tag_at(bytes, 12);
  file.flux = std::bit_cast<double>(number_at(bytes, 24, 8));
  if (!std::isfinite(file.flux) || file.flux <= 0.0) {
    throw_input_error(name, "byte 24", "flux {}; expected a number > 0", file.flux);
  }
  file.training_rays = number_at(bytes, 32, 8);
  file.version = static_cast<std::uint32_t>(number_at(bytes, 8, 4));
  const std::uint64_t unit = number_at(bytes, 40, 4), count = number_at(bytes, 44, 4);
  if (unit > 1) throw_input_error(name, "byte 40", "flux unit {}; expected 0 (lm) or 1 (W)", unit);
  file.flux_unit = unit == 0 ? FluxUnit::lumen : FluxUnit::watt;
  const std::size_t end = bytes.size() - kDigest;
  if (count > kMaxSections || kHeader + count * kTableEntry > end) {
    throw_input_error(name, "byte 44", "{} sections do not fit in {} bytes", count, bytes.size());
  }
  std::size_t at = kHeader + static_cast<std::size_t>(count) * kTableEntry;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = kHeader + i * kTableEntry;
    const std::uint64_t raw = number_at(bytes, entry + 8, 8), stored = number_at(bytes, entry + 16, 8);
    if (stored > end - at) {
      throw_input_error(name, fmt::format("byte {}", entry + 16), "{} bytes of section '{}', {} are left",
                        stored, printable_tag(tag_at(bytes, entry)), end - at);
    }
    file.add(tag_at(bytes, entry), section_bytes(bytes.substr(at, stored), raw, name, at));
    at += stored;
  }
  if (at != end)
    throw_input_error(name, fmt::format("byte {}", at), "{} bytes belong to no section", end - at);
  return file;
}

void NflWriter::number(std::uint64_t x, int count) {
  for (int i = 0; i < count; ++i) u8(static_cast<std::uint8_t>(x >> (8 * i)));
}

void NflWriter::f64(double x) { u64(std::bit_cast<std::uint64_t>(x)); }

void NflWriter::varint(std::uint64_t x) {
  for (; x > 0x7f; x >>= 7) u8(static_cast<std::uint8_t>(x | 0x80));
  u8(static_cast<std::uint8_t>(x));
}

void NflWriter::signed_varint(std::int64_t x) {
  varint(static_cast<std::uint64_t>(x) << 1 ^ static_cast<std::uint64_t>(x >> 63));
}

NflReader::NflReader(const NflFile& file, const NflTag& tag, std::string_view name) : name_(name), tag_(tag) {
  for (const auto& section : file.sections) {
    if (section.tag != tag) continue;
    bytes_ = section.bytes;
    return;
  }
  throw_input_error(name, "", "section '{}' is missing", printable_tag(tag));
}

void NflReader::fail(std::string_view what) const {
  throw_input_error(name_, fmt::format("section '{}', byte {}", printable_tag(tag_), at_), "{}", what);
}

std::uint64_t NflReader::number(std::size_t count) {
  if (left() < count) fail("the section ends too early");
  const std::uint64_t x = number_at(bytes_, at_, count);
  at_ += count;
  return x;
}

std::uint8_t NflReader::u8() { return static_cast<std::uint8_t>(number(1)); }

double NflReader::f64() {
  const double x = std::bit_cast<double>(number(8));
  if (!std::isfinite(x)) fail("a number that is not finite");
  return x;
}

std::uint64_t NflReader::varint() {
  std::uint64_t x = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const std::uint64_t byte = u8();
    x |= (byte & 0x7f) << shift;
    if (byte < 0x80) return x;
  }
  fail("a number of more than 64 bits");
}

std::int64_t NflReader::signed_varint() {
  const std::uint64_t x = varint();
  return static_cast<std::int64_t>(x >> 1) ^ -static_cast<std::int64_t>(x & 1);
}

void NflReader::finish() const {
  if (left() != 0) fail(fmt::format("{} bytes too many", left()));
}

}  // namespace lucerna
