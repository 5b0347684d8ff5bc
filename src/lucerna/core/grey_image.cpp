// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/grey_image.h"

#include <zlib.h>

#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include "lucerna/core/error.h"
#include "lucerna/core/file.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 26;

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t x = 0;
  for (const char c : bytes.substr(0, 4)) x = x << 8 | static_cast<unsigned char>(c);
  return x;
}

/// The chunks of a PNG file, each with its place.
class PngReader {
 public:
  explicit PngReader(const std::filesystem::path& path)
      : file_(path.string()), bytes_(read_file(path, kMostBytes)) {
    if (!std::string_view(bytes_).starts_with("\x89PNG\r\n\x1a\n")) fail(0, "this is no PNG");
  }

  GreyImage read() {
    std::string packed;
    for (std::string_view type; type != "IEND";) {
      const std::string_view data = chunk(type);
      if (type == "IHDR") header(data);
      if (type == "IDAT") packed += data;
    }
    if (image_.width == 0) fail(8, "found no IHDR chunk");
    return unfilter(unpack(packed));
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(std::size_t at, fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, fmt::format("byte {}", at), text, std::forward<Args>(args)...);
  }

  /// The next chunk's data; sets `type`.
  std::string_view chunk(std::string_view& type) {
    const std::string_view rest = std::string_view(bytes_).substr(at_);
    if (rest.size() < 12) fail(at_, "the file ends, expected a chunk");
    const std::uint32_t size = big_endian(rest);
    if (size > rest.size() - 12) fail(at_, "a chunk of {} bytes, the file holds {}", size, rest.size() - 12);
    const std::string_view body = rest.substr(4, size + 4);
    const uLong crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
    if (crc != big_endian(rest.substr(size + 8))) fail(at_, "a chunk's checksum does not fit");
    at_ += size + 12;
    type = body.substr(0, 4);
    return body.substr(4);
  }

  void header(std::string_view data) {
    if (data.size() != 13) fail(8, "an IHDR of {} bytes, expected 13", data.size());
    const std::uint32_t width = big_endian(data), height = big_endian(data.substr(4));
    const int bits = static_cast<unsigned char>(data[8]), colour = static_cast<unsigned char>(data[9]);
    if (width == 0 || height == 0 || std::uint64_t{width} * height > kMostPixels)
      fail(16, "{} x {} pixels, expected 1 to {}", width, height, kMostPixels);
    if (colour != 0 || (bits != 8 && bits != 16)) {
      fail(24, "a picture of colour type {} and {} bits, expected grey (type 0) of 16 or 8 bits", colour,
           bits);
    }
    if (data[12] != 0) fail(28, "the picture is interlaced, expected plain rows");
    image_.width = width;
    image_.height = height;
    image_.white = bits == 16 ? 65535 : 255;
    bytes_a_pixel_ = static_cast<std::size_t>(bits / 8);
  }

  std::string unpack(const std::string& packed) const {
    const std::size_t size = image_.height * (image_.width * bytes_a_pixel_ + 1);
    // Deflate packs at most about 1 : 1032, so a small file cannot ask for much memory.
    if (size / 1040 > packed.size()) fail(8, "{} packed bytes cannot hold the picture", packed.size());
    std::string rows(size, '\0');
    uLongf got = static_cast<uLongf>(size);
    const int status =
        uncompress(reinterpret_cast<Bytef*>(rows.data()), &got, reinterpret_cast<const Bytef*>(packed.data()),
                   static_cast<uLong>(packed.size()));
    if (status != Z_OK || got != size) fail(8, "the picture's data is damaged");
    return rows;
  }

  static int paeth(int a, int b, int c) {
    const int p = a + b - c, pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
    return pa <= pb && pa <= pc ? a : (pb <= pc ? b : c);
  }

  GreyImage unfilter(std::string rows) {
    const std::size_t row_bytes = image_.width * bytes_a_pixel_;
    image_.grey.resize(image_.width * image_.height);
    for (std::size_t y = 0; y < image_.height; ++y) {
      char* const row = rows.data() + y * (row_bytes + 1) + 1;
      const int filter = static_cast<unsigned char>(row[-1]);
      if (filter > 4) fail(8, "row {} has filter {}, expected 0 to 4", y + 1, filter);
      const auto byte = [](char c) { return static_cast<int>(static_cast<unsigned char>(c)); };
      for (std::size_t i = 0; i < row_bytes; ++i) {
        const bool first = i < bytes_a_pixel_;
        const int left = first ? 0 : byte(row[i - bytes_a_pixel_]);
        const int up = y == 0 ? 0 : byte(*(row + i - (row_bytes + 1)));
        const int corner = first || y == 0 ? 0 : byte(*(row + i - (row_bytes + 1) - bytes_a_pixel_));
        const int guess[5] = {0, left, up, (left + up) / 2, paeth(left, up, corner)};
        row[i] = static_cast<char>(byte(row[i]) + guess[filter]);
      }
      for (std::size_t x = 0; x < image_.width; ++x) {
        const char* const p = row + x * bytes_a_pixel_;
        image_.grey[y * image_.width + x] =
            static_cast<std::uint16_t>(bytes_a_pixel_ == 2 ? byte(p[0]) << 8 | byte(p[1]) : byte(p[0]));
      }
    }
    return std::move(image_);
  }

  std::string file_, bytes_;
  std::size_t at_ = 8, bytes_a_pixel_ = 1;
  GreyImage image_;
};

/// The numbers of a PGM file; comments run from # to the end of the line.
class PgmReader {
 public:
  explicit PgmReader(const std::filesystem::path& path)
      : file_(path.string()), bytes_(read_file(path, kMostBytes)) {}

  GreyImage read() {
    const std::string_view kind = std::string_view(bytes_).substr(0, 2);
    if (kind != "P5" && kind != "P2") fail("this is no PGM: expected P5 or P2");
    at_ = 2;
    GreyImage image;
    image.width = number(1, kMostPixels);
    image.height = number(1, kMostPixels);
    if (image.height > kMostPixels / image.width)
      fail("{} x {} pixels, expected at most {}", image.width, image.height, kMostPixels);
    image.white = static_cast<std::uint32_t>(number(1, 65535));
    const std::size_t n = image.width * image.height;
    const std::size_t each = image.white > 255 ? 2 : 1;
    if (kind == "P5") ++at_;  // one white space ends the header
    const std::size_t least = kind == "P5" ? n * each : 2 * n - 1;
    if (at_ > bytes_.size() || bytes_.size() - at_ < least) fail("the file ends before its {} pixels", n);
    image.grey.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      if (kind == "P2") {
        image.grey[i] = static_cast<std::uint16_t>(number(0, image.white));
        continue;
      }
      unsigned value = 0;
      for (std::size_t k = 0; k < each; ++k) value = value << 8 | static_cast<unsigned char>(bytes_[at_++]);
      if (value > image.white) fail("found {}, expected at most {}", value, image.white);
      image.grey[i] = static_cast<std::uint16_t>(value);
    }
    return image;
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw_input_error(file_, fmt::format("byte {}", at_), text, std::forward<Args>(args)...);
  }

  void skip() {
    while (at_ < bytes_.size()) {
      const char c = bytes_[at_];
      if (c == '#') {
        at_ = std::min(bytes_.find('\n', at_), bytes_.size());
      } else if (c == ' ' || (c >= '\t' && c <= '\r')) {
        ++at_;
      } else {
        return;
      }
    }
  }

  std::uint64_t number(std::uint64_t least, std::uint64_t most) {
    skip();
    std::uint64_t value = 0;
    const std::size_t begin = at_;
    while (at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9' && value <= most)
      value = 10 * value + static_cast<std::uint64_t>(bytes_[at_++] - '0');
    if (at_ == begin || value < least || value > most) {
      fail("found '{}', expected a whole number from {} to {}", bytes_.substr(begin, 12), least, most);
    }
    return value;
  }

  std::string file_, bytes_;
  std::size_t at_ = 0;
};

}  // namespace

GreyImage read_grey_png(const std::filesystem::path& path) { return PngReader(path).read(); }

GreyImage read_pgm(const std::filesystem::path& path) { return PgmReader(path).read(); }

}  // namespace lucerna
