// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/comparison/view_picture.h"

#include <gtest/gtest.h>

#include <array>

namespace lucerna {
namespace {

using Rgb = std::array<int, 3>;

Rgb pixel(const ComparisonPicture& p, std::size_t x, std::size_t y) {
  const std::size_t at = 3 * (y * p.width + x);
  return {p.rgb.at(at), p.rgb.at(at + 1), p.rgb.at(at + 2)};
}

TEST(ComparisonPicture, ShowsBothAndWhereTheyDiffer) {
  // Two columns of three rows, lowest row first; the cell for the rest after them is not shown.
  const std::vector<double> a{0.0, 1.0, 2.0, 4.0, 3.0, 0.0, 99.0}, b{0.0, 1.0, 2.0, 2.0, 3.0, 1.0, -99.0};
  constexpr std::size_t kZoom = 2;
  const ComparisonPicture p = comparison_picture(2, 3, a, b, kZoom);
  EXPECT_EQ(p.white, 4.0);
  EXPECT_EQ(p.difference, 2.0);
  EXPECT_EQ(p.height, 3 * kZoom);
  const std::size_t third = p.width - 2 * kZoom, bottom = p.height - 1;
  EXPECT_EQ(pixel(p, 0, bottom), (Rgb{0, 0, 0})) << "0 is black";
  EXPECT_EQ(pixel(p, 2, bottom), (Rgb{255, 255, 255})) << "the most is white";
  EXPECT_EQ(pixel(p, third + 2, bottom), (Rgb{0, 0, 255})) << "2 less of at most 2: blue";
  EXPECT_EQ(pixel(p, third + 2, 0), (Rgb{255, 128, 128})) << "1 more: half red";
  EXPECT_EQ(pixel(p, third, 0), (Rgb{255, 255, 255})) << "no difference";
  EXPECT_EQ(pixel(p, 0, 0), pixel(p, 1, 1)) << "a cell is a square of pixels";
}

TEST(ComparisonPicture, LightnessRises) {
  std::vector<double> ramp(256);
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<double>(i);
  const ComparisonPicture p = comparison_picture(256, 1, ramp, ramp, 1);
  double last = -1.0;
  for (std::size_t x = 0; x < 256; ++x) {
    const Rgb c = pixel(p, x, 0);
    const double lightness = 0.30 * c[0] + 0.59 * c[1] + 0.11 * c[2];
    EXPECT_GT(lightness, last - 1.0) << x;
    last = lightness;
  }
  EXPECT_EQ(comparison_picture(1, 1, std::vector<double>{0.0}, std::vector<double>{0.0}, 1).difference, 0.0);
}

}  // namespace
}  // namespace lucerna
