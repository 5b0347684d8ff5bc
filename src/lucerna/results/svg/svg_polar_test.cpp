// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_polar.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/results/svg/svg_canvas.h"

namespace lucerna {
namespace {

IntensityDistribution batwing() {
  IntensityDistribution d = uniform_distribution(15.0, 2.5);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    const double side = std::cos(radians(d.c_deg[c]));
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      const double x = (d.gamma_deg[g] - 30.0) / 14.0;
      d.at(c, g) = d.gamma_deg[g] < 90.0 ? 150.0 + 300.0 * (0.2 + 0.8 * side * side) * std::exp(-x * x) : 0.0;
    }
  }
  return d;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(SvgPolar, DrawsSolidAndDashedCurveAndLabels) {
  const std::string svg = polar_svg(batwing(), {.title = "Wings & more"});
  EXPECT_EQ(count(svg, "stroke-dasharray=\"9 5\""), 2u);  // C90-C270 and its legend
  EXPECT_NE(svg.find("Wings &amp; more"), std::string::npos);
  for (const char* label : {">C0 – C180<", ">C90 – C270<", ">0°<", ">90°<", ">100<", ">400<"}) {
    EXPECT_NE(svg.find(label), std::string::npos) << label;
  }
  EXPECT_EQ(svg.find(">120°<"), std::string::npos);  // nothing goes up: half a disc
}

TEST(SvgPolar, UplightUsesTheUpperHalf) {
  IntensityDistribution d = uniform_distribution(90.0, 5.0);
  for (std::size_t c = 0; c < 4; ++c) d.at(c, 36) = 100.0;
  const std::string svg = polar_svg(d);
  EXPECT_NE(svg.find(">180°<"), std::string::npos);
  EXPECT_EQ(svg.find(">30°<"), std::string::npos);
}

TEST(SvgPolar, PerKilolumenScalesTheRings) {
  const std::string svg = polar_svg(batwing(), {.lamp_flux_lm = 2000.0});
  EXPECT_NE(svg.find("cd/klm"), std::string::npos);
  EXPECT_NE(svg.find(">200<"), std::string::npos);
  EXPECT_EQ(svg.find(">400<"), std::string::npos);
}

TEST(SvgPolar, TakesDarknessAndRefusesNonsense) {
  EXPECT_NE(polar_svg(uniform_distribution(90.0, 10.0)).find("</svg>"), std::string::npos);
  EXPECT_THROW(polar_svg(IntensityDistribution{}), InputError);
}

TEST(SvgCanvas, RoundStepsAndLabels) {
  EXPECT_DOUBLE_EQ(nice_step(930.0, 5), 200.0);
  EXPECT_DOUBLE_EQ(nice_step(1000.0, 5), 200.0);
  EXPECT_DOUBLE_EQ(nice_step(0.012, 5), 0.0025);
  EXPECT_EQ(label_number(1234.56), "1235");
  EXPECT_EQ(label_number(0.25), "0.25");
  EXPECT_EQ(label_number(12.0), "12");
}

}  // namespace
}  // namespace lucerna
