// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_contour.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

SampledField sampled(std::size_t nx, std::size_t ny, const std::function<double(double, double)>& value) {
  SampledField f;
  for (std::size_t i = 0; i < nx; ++i) f.x.push_back(static_cast<double>(i));
  for (std::size_t i = 0; i < ny; ++i) f.y.push_back(static_cast<double>(ny - i));
  for (const double y : f.y) {
    for (const double x : f.x) f.value.push_back(value(x, y));
  }
  return f;
}

double area(const std::vector<SvgPoint>& ring) {
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const SvgPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return std::abs(0.5 * twice);
}

TEST(SvgContour, CircleIsOneClosedLineOfItsRadius) {
  const auto f = sampled(81, 61, [](double x, double y) { return -std::hypot(x - 40.3, y - 31.1); });
  const auto lines = contour_lines(f, -20.0);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].front().x, lines[0].back().x);
  EXPECT_EQ(lines[0].front().y, lines[0].back().y);
  for (const SvgPoint& p : lines[0]) EXPECT_NEAR(std::hypot(p.x - 40.3, p.y - 31.1), 20.0, 0.01);
  EXPECT_NEAR(area(lines[0]), std::numbers::pi * 400.0, 2.0);
}

TEST(SvgContour, LinesEndAtTheBorderAndRingsGoAlongIt) {
  const auto f = sampled(11, 21, [](double x, double) { return x; });
  const auto lines = contour_lines(f, 3.25);
  ASSERT_EQ(lines.size(), 1u);
  ASSERT_EQ(lines[0].size(), 21u);
  for (const SvgPoint& p : lines[0]) EXPECT_DOUBLE_EQ(p.x, 3.25);
  const auto rings = contour_rings(f, 3.25);
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_NEAR(area(rings[0]), 6.75 * 20.0, 1e-9);
  EXPECT_NEAR(area(contour_rings(f, -1.0).at(0)), 200.0, 1e-9);  // everything
  EXPECT_TRUE(contour_rings(f, 11.0).empty());
}

TEST(SvgContour, RingInRingIsAHole) {
  const auto f =
      sampled(101, 101, [](double x, double y) { return -std::abs(std::hypot(x - 50.2, y - 50.7) - 30.0); });
  const auto rings = contour_rings(f, -5.0);
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_NEAR(std::abs(area(rings[0]) - area(rings[1])), std::numbers::pi * (35.0 * 35.0 - 25.0 * 25.0), 6.0);
}

// A checkerboard has a saddle in every cell: no crossing may be lost or used twice.
TEST(SvgContour, SaddlesUseEveryCrossingOnce) {
  for (const double level : {-0.3, 0.0, 0.3}) {
    const auto f =
        sampled(14, 9, [](double x, double y) { return std::fmod(x + y, 2.0) < 0.5 ? 1.0 : -1.0; });
    std::set<std::pair<double, double>> seen;
    std::size_t points = 0;
    for (auto line : contour_lines(f, level)) {
      if (line.front().x == line.back().x && line.front().y == line.back().y) line.pop_back();
      for (const SvgPoint& p : line) seen.insert({p.x, p.y});
      points += line.size();
    }
    EXPECT_EQ(points, 13u * 9u + 14u * 8u);  // each edge of the grid is crossed
    EXPECT_EQ(seen.size(), points);
  }
}

TEST(SvgContour, SizesMustAgree) {
  EXPECT_THROW(contour_lines({.x = {0, 1}, .y = {0, 1}, .value = {1}}, 0.5), std::logic_error);
}

TEST(SvgContour, LabelsNeverTouch) {
  SvgCanvas canvas(400.0, 200.0);
  LineLabels labels;
  for (int i = 0; i < 8; ++i) {
    std::vector<SvgPoint> line;
    for (int k = 0; k <= 100; ++k) line.push_back({3.0 * k, 50.0 + 4.0 * i});
    labels.write(canvas, line, "50 %");
  }
  const std::string svg = canvas.str();
  std::vector<std::array<double, 3>> boxes;
  for (const std::string& rect : test::between(svg, "<rect", ">")) {
    if (test::attribute_of(rect, "height") != "13.00") continue;
    const auto number = [&](const char* name) { return std::stod(test::attribute_of(rect, name).value()); };
    boxes.push_back({number("x"), number("y"), number("width")});
  }
  EXPECT_GE(boxes.size(), 6u) << "there is room beside each other";
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_TRUE(std::abs(boxes[i][0] - boxes[j][0]) > boxes[i][2] ||
                  std::abs(boxes[i][1] - boxes[j][1]) > 13.0);
    }
  }
  const std::size_t before = canvas.str().size();
  labels.write(canvas, {{0.0, 0.0}, {30.0, 0.0}}, "short");
  EXPECT_EQ(canvas.str().size(), before);
}

}  // namespace
}  // namespace lucerna
