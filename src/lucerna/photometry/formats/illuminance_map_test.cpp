// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/formats/illuminance_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lucerna/core/image/png.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using testing::HasSubstr;

IlluminanceMap read(const std::string& text) {
  const test::TempDir dir;
  write_file(dir / "e.csv", text);
  return read_illuminance_csv(dir / "e.csv");
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(IlluminanceMap, RowsLieLikeAPicture) {
  for (const char* text :
       {"1,2,3\n4,5,6\n", "# lx\n\n1;2;3\r\n4;5;6\r\n", "1 2  3\n4 5 6", "1\t2\t3\n4\t5\t6\n"}) {
    const IlluminanceMap map = read(text);
    ASSERT_EQ(map.nx, 3u);
    ASSERT_EQ(map.ny, 2u);
    EXPECT_EQ(map.value, (std::vector<double>{4, 5, 6, 1, 2, 3}));  // the first row is the side of +y
  }
}

TEST(IlluminanceMap, PlacesMayComeInAnyOrder) {
  const IlluminanceMap map = read(
      "x_mm,y_mm,illuminance_lx,standard_error\n10,5,6,0.1\n-10,5,4,\n0,5,5,\n-10,-5,1,\n0,-5,2,\n10,-5,3,"
      "\n");
  ASSERT_EQ(map.nx, 3u);
  ASSERT_EQ(map.ny, 2u);
  EXPECT_EQ(map.value, (std::vector<double>{1, 2, 3, 4, 5, 6}));
}

TEST(IlluminanceMap, IsBilinearBetweenCentresAndLevelToTheSides) {
  const IlluminanceMap map = read("3,4\n1,2\n");
  EXPECT_DOUBLE_EQ(map.at(0, 0), 2.5);
  EXPECT_DOUBLE_EQ(map.at(-0.5, -0.5), 1.0);
  EXPECT_DOUBLE_EQ(map.at(-1, -1), 1.0);
  EXPECT_DOUBLE_EQ(map.at(1, 1), 4.0);
  EXPECT_DOUBLE_EQ(map.at(0.25, -0.5), 1.75);
  EXPECT_EQ(map.at(1.001, 0), 0.0);
}

TEST(IlluminanceMap, APictureIsItsLinearSamplesTopUp) {
  const test::TempDir dir;
  const std::vector<std::uint8_t> rgb{255, 255, 255, 0, 0, 0, 51, 51, 51, 102, 102, 102};
  write_png(dir / "e.png", 2, 2, rgb);
  const IlluminanceMap map = read_illuminance_png(dir / "e.png");
  EXPECT_THAT(map.value,
              testing::ElementsAre(testing::DoubleNear(0.2, 1e-12), testing::DoubleNear(0.4, 1e-12),
                                   testing::DoubleNear(1.0, 1e-12), 0.0));
}

TEST(IlluminanceMap, NamesWhatIsWrongAndWhere) {
  EXPECT_THAT(refusal("1,2\n3\n"), HasSubstr("line 2: found 1 numbers, expected 2"));
  EXPECT_THAT(refusal("1,2\n3,x\n"), HasSubstr("line 2: found 'x', expected a number"));
  EXPECT_THAT(refusal("1,-2\n"), HasSubstr("line 1: found -2"));
  EXPECT_THAT(refusal("1,,2\n"), HasSubstr("line 1: found ''"));
  EXPECT_THAT(refusal("0,0\n0,0\n"), HasSubstr("dark"));
  EXPECT_THAT(refusal(""), HasSubstr("found no numbers"));
  EXPECT_THAT(refusal("x_mm,y_mm,lx\n0,0,1\n1,0,1\n0,1,1\n"), HasSubstr("do not fill a grid of 2 x 2"));
  EXPECT_THAT(refusal("x_mm,y_mm,lx\n0,0,1\n1,0,1\n5,0,1\n"), HasSubstr("even grid"));
  EXPECT_THAT(refusal("x_mm,y_mm,lx\n0,0,1\n0,0,1\n1,0,1\n1,0,1\n"), HasSubstr("do not fill"));
  EXPECT_THAT(refusal("x_mm,y_mm,lx\n0,0,1\n0,0,1\n1,0,1\n0,1,1\n"), HasSubstr("line 3"));
}

}  // namespace
}  // namespace lucerna
