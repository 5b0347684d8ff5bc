// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/image/png.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::size_t big_endian(const std::string& bytes, std::size_t at) {
  std::size_t x = 0;
  for (std::size_t i = at; i < at + 4; ++i) x = x << 8 | static_cast<unsigned char>(bytes.at(i));
  return x;
}

struct Chunk {
  std::string type, data;
};

/// The chunks of a file; each checksum must hold.
std::vector<Chunk> chunks(const std::string& bytes) {
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  std::vector<Chunk> result;
  for (std::size_t at = 8; at < bytes.size();) {
    const std::size_t n = big_endian(bytes, at);
    const std::string body = bytes.substr(at + 4, 4 + n);
    EXPECT_EQ(big_endian(bytes, at + 8 + n),
              crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size())));
    result.push_back({body.substr(0, 4), body.substr(4)});
    at += 12 + n;
  }
  return result;
}

TEST(Png, PixelsComeBackThroughTheStandardsChunks) {
  const test::TempDir dir;
  constexpr std::size_t kWidth = 5, kHeight = 3;
  std::vector<std::uint8_t> rgb;
  for (std::size_t i = 0; i < 3 * kWidth * kHeight; ++i) rgb.push_back(static_cast<std::uint8_t>(37 * i));
  write_png(dir / "a.png", kWidth, kHeight, rgb);
  const std::vector<Chunk> all = chunks(read_file(dir / "a.png", 1 << 20));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].type, "IHDR");
  EXPECT_EQ(all[0].data, std::string("\0\0\0\5\0\0\0\3\x08\x02\0\0\0", 13));
  EXPECT_EQ(all[1].type, "IDAT");
  EXPECT_EQ(all[2].type, "IEND");
  EXPECT_EQ(all[2].data, "");
  std::string rows(kHeight * (3 * kWidth + 1) + 1, '\0');
  uLongf size = static_cast<uLongf>(rows.size());
  ASSERT_EQ(
      uncompress(reinterpret_cast<Bytef*>(rows.data()), &size,
                 reinterpret_cast<const Bytef*>(all[1].data.data()), static_cast<uLong>(all[1].data.size())),
      Z_OK);
  ASSERT_EQ(size, rows.size() - 1);
  for (std::size_t y = 0; y < kHeight; ++y) {
    EXPECT_EQ(rows[y * (3 * kWidth + 1)], '\0');  // filter
    for (std::size_t i = 0; i < 3 * kWidth; ++i)
      EXPECT_EQ(static_cast<std::uint8_t>(rows[y * (3 * kWidth + 1) + 1 + i]), rgb[y * 3 * kWidth + i]);
  }
}

TEST(Png, RefusesPlacesThatCannotBeWritten) {
  const test::TempDir dir;
  const std::vector<std::uint8_t> rgb(3, 0);
  EXPECT_THROW(write_png(dir / "none" / "a.png", 1, 1, rgb), InputError);
}

/// A PNG of the given samples, every row with its own filter type by rule of the standard (clause 9).
std::string filtered_png(std::size_t width, const std::vector<std::vector<int>>& rows, int bits, int colour,
                         const std::string& extra = "") {
  const auto be = [](std::uint32_t x) {
    return std::string{static_cast<char>(x >> 24), static_cast<char>(x >> 16), static_cast<char>(x >> 8),
                       static_cast<char>(x)};
  };
  const auto piece = [&](const std::string& body) {
    const auto crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
    return be(static_cast<std::uint32_t>(body.size() - 4)) + body + be(static_cast<std::uint32_t>(crc));
  };
  const std::size_t step = rows[0].size() / width;
  std::string raw;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    const int filter = static_cast<int>(y % 5);
    raw += static_cast<char>(filter);
    for (std::size_t i = 0; i < rows[y].size(); ++i) {
      const int a = i >= step ? rows[y][i - step] : 0, b = y > 0 ? rows[y - 1][i] : 0;
      const int c = i >= step && y > 0 ? rows[y - 1][i - step] : 0, p = a + b - c;
      const int near_a = std::abs(p - a), near_b = std::abs(p - b), near_c = std::abs(p - c);
      const int paeth = near_a <= near_b && near_a <= near_c ? a : (near_b <= near_c ? b : c);
      const int guesses[5] = {0, a, b, (a + b) / 2, paeth};
      raw += static_cast<char>(rows[y][i] - guesses[filter]);
    }
  }
  uLongf size = compressBound(static_cast<uLong>(raw.size()));
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(raw.data()),
           static_cast<uLong>(raw.size()));
  packed.resize(size);
  const std::string header = be(static_cast<std::uint32_t>(width)) +
                             be(static_cast<std::uint32_t>(rows.size())) + static_cast<char>(bits) +
                             static_cast<char>(colour) + std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + piece("IHDR" + header) + extra + piece("IDAT" + packed) + piece("IEND");
}

TEST(Png, ReadsEveryFilterAndSampleSize) {
  const test::TempDir dir;
  for (const int step : {1, 2, 3, 6}) {  // grey 8, grey 16, RGB 8, RGB 16
    std::vector<std::vector<int>> rows;
    for (int y = 0; y < 7; ++y) {
      rows.emplace_back();
      for (int i = 0; i < 4 * step; ++i) rows.back().push_back((91 * y * y + 53 * i + 17) % 256);
    }
    const bool wide = step % 2 == 0, rgb = step >= 3;
    write_file(dir / "a.png", filtered_png(4, rows, wide ? 16 : 8, rgb ? 2 : 0));
    const GreyImage image = read_png_grey(dir / "a.png");
    ASSERT_EQ(image.width, 4u);
    ASSERT_EQ(image.height, 7u);
    const auto sample = [&](std::size_t y, std::size_t k) {
      return wide ? (256.0 * rows[y][2 * k] + rows[y][2 * k + 1]) / 65535.0 : rows[y][k] / 255.0;
    };
    for (std::size_t y = 0; y < 7; ++y) {
      for (std::size_t x = 0; x < 4; ++x) {
        const double expected =
            rgb ? 0.2126 * sample(y, 3 * x) + 0.7152 * sample(y, 3 * x + 1) + 0.0722 * sample(y, 3 * x + 2)
                : sample(y, x);
        EXPECT_NEAR(image.value[y * 4 + x], expected, 1e-12) << step << " " << x << " " << y;
      }
    }
  }
}

TEST(Png, ReadsWhatItWrites) {
  const test::TempDir dir;
  std::vector<std::uint8_t> rgb;
  for (int i = 0; i < 6 * 5; ++i) rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(8 * i));
  write_png(dir / "a.png", 6, 5, rgb);
  const GreyImage image = read_png_grey(dir / "a.png");
  for (std::size_t i = 0; i < 30; ++i)
    EXPECT_NEAR(image.value[i], 8.0 * static_cast<double>(i) / 255.0, 1e-12);
}

TEST(PngFuzz, DamagedFilesAreRefusedNotRead) {
  const test::TempDir dir;
  const std::string good = filtered_png(3, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, 8, 0);
  for (std::size_t n = 0; n < good.size(); ++n) {
    write_file(dir / "a.png", good.substr(0, n));
    EXPECT_THROW(read_png_grey(dir / "a.png"), InputError) << n;
    std::string bad = good;
    bad[n] = static_cast<char>(bad[n] ^ 0x41);
    write_file(dir / "a.png", bad);
    EXPECT_THROW(read_png_grey(dir / "a.png"), InputError) << n;  // a checksum, or the signature
  }
}

}  // namespace
}  // namespace lucerna
