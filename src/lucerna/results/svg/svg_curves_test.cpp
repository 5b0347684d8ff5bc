// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_curves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

/// The points of the first polyline of the colour.
std::vector<test::TextPoint> line_of(const std::string& svg, const std::string& color) {
  return test::polyline_of(svg, "stroke=\"" + color + "\"");
}

std::vector<double> axis_of(const std::string& svg, const std::string& name) {
  return test::numbers_in(test::attribute_of(svg, "data-" + name).value_or(""));
}

TEST(SvgCurves, PointsLieWhereTheAxesSay) {
  CurvePlot plot{.title = "t", .x = {.label = "x"}, .y = {.label = "y", .log = true}};
  plot.curves.push_back({.name = "a", .x = {0.0, 1.0, 2.0, 3.0}, .y = {0.5, 5.0, 0.0, 50.0}});
  const std::string svg = curves_svg(plot);
  const auto x = axis_of(svg, "x"), y = axis_of(svg, "y");
  ASSERT_EQ(x.size(), 4u);
  ASSERT_EQ(y.size(), 4u);
  EXPECT_LE(y[2], 0.5);
  EXPECT_GE(y[3], 50.0);
  const auto line = line_of(svg, "#0072b2");
  ASSERT_EQ(line.size(), 3u) << "zero has no place on a logarithmic axis";
  const std::vector<std::pair<double, double>> wanted{{0.0, 0.5}, {1.0, 5.0}, {3.0, 50.0}};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(line[i].x, x[0] + (wanted[i].first - x[2]) / (x[3] - x[2]) * (x[1] - x[0]), 0.01);
    const double share = std::log(wanted[i].second / y[2]) / std::log(y[3] / y[2]);
    EXPECT_NEAR(line[i].y, y[0] + share * (y[1] - y[0]), 0.01);
  }
}

TEST(SvgCurves, LinearAxesBeginAtZeroUnlessToldOtherwise) {
  CurvePlot plot{.title = "t"};
  plot.curves.push_back({.name = "a", .x = {40.0, 90.0}, .y = {7.0, 8.0}});
  EXPECT_EQ(axis_of(curves_svg(plot), "x")[2], 0.0);
  plot.x.first = 40.0;
  EXPECT_EQ(axis_of(curves_svg(plot), "x")[2], 40.0);
  plot.curves[0].x = {-40.0, 90.0};
  plot.x.first.reset();
  EXPECT_LE(axis_of(curves_svg(plot), "x")[2], -40.0);
}

TEST(SvgCurves, NothingToDrawIsBadInput) {
  CurvePlot plot{.title = "empty", .y = {.log = true}};
  EXPECT_THROW(curves_svg(plot), InputError);
  plot.curves.push_back({.name = "a", .x = {1.0}, .y = {0.0}});
  EXPECT_THROW(curves_svg(plot), InputError);
  plot.curves[0].y = {1.0};
  EXPECT_NE(curves_svg(plot).find("<circle"), std::string::npos) << "one point is a dot";
}

}  // namespace
}  // namespace lucerna
