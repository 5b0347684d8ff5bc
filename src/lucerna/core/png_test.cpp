// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/png.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <string>
#include <vector>

#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
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

}  // namespace
}  // namespace lucerna
