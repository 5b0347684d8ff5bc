// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/grey_image.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdlib>
#include <string>

#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/core/random.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::string word(std::uint32_t x) {
  std::string s;
  for (int shift = 24; shift >= 0; shift -= 8) s += static_cast<char>(x >> shift & 0xff);
  return s;
}

std::string chunk(const std::string& body) {
  const uLong crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return word(static_cast<std::uint32_t>(body.size() - 4)) + body + word(static_cast<std::uint32_t>(crc));
}

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           static_cast<uLong>(bytes.size()));
  return out.substr(0, size);
}

/// A PNG file of these bytes a row; row y is filtered by method (y + first) % 5, in two IDAT chunks.
std::string png(const std::vector<std::string>& rows, std::size_t width, int bits, std::size_t first) {
  const std::size_t bpp = static_cast<std::size_t>(bits) / 8;
  std::string data;
  for (std::size_t y = 0; y < rows.size(); ++y) {
    const int filter = static_cast<int>((y + first) % 5);
    data += static_cast<char>(filter);
    for (std::size_t i = 0; i < rows[y].size(); ++i) {
      const auto at = [&](std::size_t row, std::size_t k) {
        return static_cast<int>(static_cast<unsigned char>(rows[row][k]));
      };
      const int a = i < bpp ? 0 : at(y, i - bpp), b = y == 0 ? 0 : at(y - 1, i);
      const int c = i < bpp || y == 0 ? 0 : at(y - 1, i - bpp), p = a + b - c;
      const int pa = std::abs(p - a), pb = std::abs(p - b), pc = std::abs(p - c);
      const int guess[5] = {0, a, b, (a + b) / 2, pa <= pb && pa <= pc ? a : (pb <= pc ? b : c)};
      data += static_cast<char>(at(y, i) - guess[filter]);
    }
  }
  const std::string z = packed(data);
  std::string head =
      "IHDR" + word(static_cast<std::uint32_t>(width)) + word(static_cast<std::uint32_t>(rows.size()));
  head += static_cast<char>(bits);
  head += std::string(4, '\0');
  return "\x89PNG\r\n\x1a\n" + chunk(head) + chunk("IDAT" + z.substr(0, z.size() / 2)) +
         chunk("IDAT" + z.substr(z.size() / 2)) + chunk("IEND");
}

std::vector<std::string> random_rows(std::size_t bytes, std::size_t rows) {
  std::vector<std::string> all(rows, std::string(bytes, '\0'));
  Rng rng(5, bytes);
  for (std::string& row : all) {
    for (char& c : row) c = static_cast<char>(rng.bits());
  }
  return all;
}

TEST(GreyImage, PngsOfBothDepthsAndAllFilters) {
  const test::TempDir dir;
  for (const int bits : {8, 16}) {
    for (std::size_t first = 0; first < 5; ++first) {
      const std::size_t bytes = static_cast<std::size_t>(bits) / 8;
      const auto rows = random_rows(7 * bytes, 11);
      write_file(dir / "a.png", png(rows, 7, bits, first));
      const GreyImage image = read_grey_png(dir / "a.png");
      ASSERT_EQ(image.width, 7u);
      ASSERT_EQ(image.height, 11u);
      EXPECT_EQ(image.white, bits == 16 ? 65535u : 255u);
      for (std::size_t i = 0; i < 77; ++i) {
        unsigned expected = 0;
        for (std::size_t k = 0; k < bytes; ++k)
          expected = expected << 8 | static_cast<unsigned char>(rows[i / 7][i % 7 * bytes + k]);
        EXPECT_EQ(image.grey[i], expected);
      }
    }
  }
}

TEST(GreyImage, PgmsInTextAndBytes) {
  const test::TempDir dir;
  write_file(dir / "t.pgm", "P2\n# a comment\n3 2\n1000 # white\n0 1 2\n998 999 1000\n");
  const GreyImage text = read_pgm(dir / "t.pgm");
  EXPECT_EQ(text.grey, (std::vector<std::uint16_t>{0, 1, 2, 998, 999, 1000}));
  EXPECT_EQ(text.white, 1000u);
  write_file(dir / "b.pgm", std::string("P5 3 2 1000\n") + std::string("\0\0\0\1\0\2\3\346\3\347\3\350", 12));
  EXPECT_EQ(read_pgm(dir / "b.pgm").grey, text.grey);
  write_file(dir / "c.pgm", std::string("P5 2 1 255\n\xff\x01"));
  EXPECT_EQ(read_pgm(dir / "c.pgm").grey, (std::vector<std::uint16_t>{255, 1}));
}

TEST(GreyImage, SaysWhatItCannotRead) {
  const test::TempDir dir;
  const auto fault = [&](const std::string& bytes, bool is_png) {
    write_file(dir / "x", bytes);
    return test::message_of<InputError>([&] { is_png ? read_grey_png(dir / "x") : read_pgm(dir / "x"); });
  };
  const std::string good = png(random_rows(14, 11), 7, 16, 0);
  std::string colour = good.substr(8 + 4, 17), flipped = good;
  colour[4 + 9] = 2;
  EXPECT_NE(fault("\x89PNG\r\n\x1a\n" + chunk(colour) + good.substr(33), true).find("colour type 2"),
            std::string::npos);
  flipped[good.size() / 2] = static_cast<char>(flipped[good.size() / 2] ^ 1);
  EXPECT_NE(fault(flipped, true).find("checksum"), std::string::npos);
  EXPECT_NE(fault("GIF89a", true).find("no PNG"), std::string::npos);
  EXPECT_NE(fault("P6 1 1 255\n", false).find("P5 or P2"), std::string::npos);
  EXPECT_NE(fault("P2 2 2 255\n0 1\n", false).find("ends before"), std::string::npos);
  EXPECT_NE(fault("P2 2 2 255\n0 1 2 256\n", false).find("from 0 to 255"), std::string::npos);
  EXPECT_NE(fault("P2 90000 90000 255\n", false).find("pixels"), std::string::npos);
}

TEST(GreyImageFuzz, DamagedFilesAreRefusedOrPictures) {
  const test::TempDir dir;
  const std::string files[2] = {png(random_rows(14, 11), 7, 16, 0),
                                "P5 3 2 1000\n" + std::string("\0\0\0\1\0\2\3\346\3\347\3\350", 12)};
  Rng rng(2, 0);
  for (int i = 0; i < 600; ++i) {
    std::string bytes = files[i % 2];
    bytes.resize(rng.bits() % (bytes.size() + 1));
    for (int k = 0; k < i % 3 && !bytes.empty(); ++k)
      bytes[rng.bits() % bytes.size()] = static_cast<char>(rng.bits());
    write_file(dir / "x", bytes);
    try {
      const GreyImage image = i % 2 == 0 ? read_grey_png(dir / "x") : read_pgm(dir / "x");
      EXPECT_EQ(image.grey.size(), image.width * image.height);
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace lucerna
