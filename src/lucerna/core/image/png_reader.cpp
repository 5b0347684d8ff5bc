// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <utility>

#include "lucerna/core/image/png.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxPngPixels = std::uint64_t{1} << 24;
constexpr std::uint64_t kMaxPngBytes = std::uint64_t{1} << 28;

/// What a file's chunks say, clause by clause of ISO/IEC 15948.
struct Picture {
  std::uint64_t width = 0, height = 0;
  int bits = 0, colour = 0;
  std::string palette, packed;

  std::uint64_t channels() const { return colour == 2 ? 3 : (colour == 6 ? 4 : (colour == 4 ? 2 : 1)); }
  std::uint64_t pixel_bytes() const { return channels() * static_cast<std::uint64_t>(bits / 8); }
};

class PngReader {
 public:
  explicit PngReader(const std::filesystem::path& path)
      : name_(path.string()), bytes_(read_file(path, kMaxPngBytes)) {}

  GreyImage read() {
    if (bytes_.substr(0, 8) != "\x89PNG\r\n\x1a\n") fail(0, "is no PNG file: it does not begin like one");
    bool ended = false;
    for (std::size_t at = 8; !ended;) ended = chunk(at);
    if (picture_.width == 0) fail(8, "has no header (IHDR)");
    const std::string rows = unpacked();
    GreyImage image{picture_.width,
                    picture_.height,
                    {},
                    picture_.bits == 8 ? 255.0 : 65535.0,
                    picture_.colour == 2 || picture_.colour == 3 || picture_.colour == 6};
    image.value.reserve(picture_.width * picture_.height);
    unfilter(rows, image);
    return image;
  }

 private:
  [[noreturn]] void fail(std::size_t byte, const std::string& what) const {
    throw InputError(fmt::format("{}: byte {}: {}", name_, byte, what));
  }

  std::uint64_t number(std::size_t at) const {
    std::uint64_t x = 0;
    for (std::size_t i = 0; i < 4; ++i) x = x << 8 | static_cast<unsigned char>(bytes_[at + i]);
    return x;
  }

  /// Takes one chunk; true at the last.
  bool chunk(std::size_t& at) {
    if (bytes_.size() - at < 12) fail(at, "ends within a chunk");
    const std::uint64_t n = number(at);
    if (n > bytes_.size() - at - 12) {
      fail(at, fmt::format("found a chunk of {} bytes, only {} are left", n, bytes_.size() - at - 12));
    }
    const std::string type = bytes_.substr(at + 4, 4), data = bytes_.substr(at + 8, n);
    const auto* checked = reinterpret_cast<const Bytef*>(bytes_.data() + at + 4);
    if (crc32(0, checked, static_cast<uInt>(n + 4)) != number(at + 8 + n)) fail(at, "checksum of a chunk");
    if (type == "IHDR") header(at, data);
    if (type == "PLTE") picture_.palette = data;
    if (type == "IDAT") picture_.packed += data;
    at += 12 + n;
    return type == "IEND";
  }

  void header(std::size_t at, const std::string& data) {
    if (data.size() != 13) fail(at, fmt::format("found a header of {} bytes, expected 13", data.size()));
    picture_.width = number(at + 8);
    picture_.height = number(at + 12);
    picture_.bits = static_cast<unsigned char>(data[8]);
    picture_.colour = static_cast<unsigned char>(data[9]);
    const int c = picture_.colour;
    if (c != 0 && c != 2 && c != 3 && c != 4 && c != 6) fail(at, fmt::format("found colour type {}", c));
    if (picture_.bits != 8 && !(picture_.bits == 16 && c != 3)) {
      fail(at, fmt::format("found {} bits a sample, expected 8 or 16", picture_.bits));
    }
    if (data[12] != 0) fail(at, "is interlaced; expected a picture saved without interlacing");
    if (picture_.width == 0 || picture_.height == 0 || picture_.width * picture_.height > kMaxPngPixels) {
      fail(at, fmt::format("found {} x {} pixels, expected 1 to 16 M", picture_.width, picture_.height));
    }
  }

  std::string unpacked() const {
    std::string rows(picture_.height * (1 + picture_.width * picture_.pixel_bytes()), '\0');
    uLongf size = static_cast<uLongf>(rows.size());
    const int status = uncompress(reinterpret_cast<Bytef*>(rows.data()), &size,
                                  reinterpret_cast<const Bytef*>(picture_.packed.data()),
                                  static_cast<uLong>(picture_.packed.size()));
    if (status != Z_OK || size != rows.size()) {
      fail(8, fmt::format("its pixels unpack to {} bytes, expected {} (zlib {})", size, rows.size(), status));
    }
    return rows;
  }

  static int paeth(int a, int b, int c) {
    const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
    return pa <= pb && pa <= pc ? a : (pb <= pc ? b : c);
  }

  void unfilter(const std::string& rows, GreyImage& image) const {
    const std::size_t step = picture_.pixel_bytes(), n = picture_.width * step;
    std::vector<std::uint8_t> before(n, 0), row(n, 0);
    for (std::size_t y = 0; y < picture_.height; ++y) {
      const char* source = rows.data() + y * (n + 1);
      const int filter = static_cast<unsigned char>(*source++);
      if (filter > 4) fail(8, fmt::format("row {} has filter {}, expected 0 to 4", y, filter));
      for (std::size_t i = 0; i < n; ++i) {
        const int left = i >= step ? row[i - step] : 0, up = before[i];
        const int corner = i >= step ? before[i - step] : 0;
        const std::array<int, 5> guess{0, left, up, (left + up) / 2, paeth(left, up, corner)};
        row[i] = static_cast<std::uint8_t>(static_cast<unsigned char>(source[i]) +
                                           guess[static_cast<std::size_t>(filter)]);
      }
      for (std::size_t x = 0; x < picture_.width; ++x) image.value.push_back(grey(row.data() + x * step));
      std::swap(before, row);
    }
  }

  double sample(const std::uint8_t* at) const {
    return picture_.bits == 8 ? *at / 255.0 : (256.0 * at[0] + at[1]) / 65535.0;
  }

  double grey(const std::uint8_t* pixel) const {
    const auto luminance = [](double r, double g, double b) { return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
    if (picture_.colour == 3) {
      const std::size_t entry = 3 * static_cast<std::size_t>(*pixel);
      if (entry + 3 > picture_.palette.size()) fail(8, "a pixel's colour is not in the palette");
      const auto part = [&](std::size_t k) {
        return static_cast<unsigned char>(picture_.palette[entry + k]) / 255.0;
      };
      return luminance(part(0), part(1), part(2));
    }
    const std::size_t step = static_cast<std::size_t>(picture_.bits / 8);
    if (picture_.colour == 2 || picture_.colour == 6) {
      return luminance(sample(pixel), sample(pixel + step), sample(pixel + 2 * step));
    }
    return sample(pixel);
  }

  std::string name_, bytes_;
  Picture picture_;
};

}  // namespace

GreyImage read_png_grey(const std::filesystem::path& path) { return PngReader(path).read(); }

}  // namespace lucerna
