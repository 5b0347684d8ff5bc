// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/image/pgm.h"

#include <gtest/gtest.h>

#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/random.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

const std::string kBinary = "P5 3 2 1000\n" + std::string("\0\0\0\1\0\2\3\346\3\347\3\350", 12);

TEST(Pgm, TextAndBytes) {
  const test::TempDir dir;
  write_file(dir / "t.pgm", "P2\n# a comment\n3 2\n1000 # white\n0 1 2\n998 999 1000\n");
  const GreyImage text = read_pgm(dir / "t.pgm");
  EXPECT_EQ(text.width, 3u);
  EXPECT_EQ(text.value, (std::vector<double>{0.0, 1e-3, 2e-3, 0.998, 0.999, 1.0}));
  EXPECT_EQ(text.white, 1000.0);
  write_file(dir / "b.pgm", kBinary);
  EXPECT_EQ(read_pgm(dir / "b.pgm").value, text.value);
  write_file(dir / "c.pgm", std::string("P5 2 1 255\n\xff\x33"));
  EXPECT_EQ(read_pgm(dir / "c.pgm").value, (std::vector<double>{1.0, 0.2}));
}

TEST(Pgm, SaysWhatItCannotRead) {
  const test::TempDir dir;
  const auto fault = [&](const std::string& bytes) {
    write_file(dir / "x", bytes);
    return test::message_of<InputError>([&] { read_pgm(dir / "x"); });
  };
  EXPECT_NE(fault("P6 1 1 255\n").find("P5 or P2"), std::string::npos);
  EXPECT_NE(fault("P2 2 2 255\n0 1\n").find("ends before"), std::string::npos);
  EXPECT_NE(fault("P2 2 2 255\n0 1 2 256\n").find("from 0 to 255"), std::string::npos);
  EXPECT_NE(fault("P2 90000 90000 255\n").find("pixels"), std::string::npos);
}

TEST(PgmFuzz, DamagedFilesAreRefusedOrPictures) {
  const test::TempDir dir;
  Rng rng(2, 0);
  for (int i = 0; i < 400; ++i) {
    std::string bytes = kBinary;
    bytes.resize(rng.bits() % (bytes.size() + 1));
    for (int k = 0; k < i % 3 && !bytes.empty(); ++k)
      bytes[rng.bits() % bytes.size()] = static_cast<char>(rng.bits());
    write_file(dir / "x", bytes);
    try {
      const GreyImage image = read_pgm(dir / "x");
      EXPECT_EQ(image.value.size(), image.width * image.height);
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace lucerna
