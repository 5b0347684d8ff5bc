// SPDX-License-Identifier: Apache-2.0
// The diagrams of one distribution: what they say against what the distribution is.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/results/svg/svg_cartesian.h"
#include "lucerna/results/svg/svg_cone.h"
#include "lucerna/results/svg/svg_isocandela.h"
#include "lucerna/results/svg/svg_isolux.h"
#include "lucerna/results/svg/svg_zonal.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

IntensityDistribution filled(const std::function<double(double c_deg, double g_deg)>& cd) {
  IntensityDistribution d = uniform_distribution(5.0, 1.0);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) d.at(c, g) = cd(d.c_deg[c], d.gamma_deg[g]);
  }
  return d;
}

double tent(double x, double half_width) { return std::max(0.0, 1.0 - std::abs(x) / half_width); }

/// 1000 cd on the axis, 20 degrees of beam, 36 of field.
IntensityDistribution spot() {
  return filled([](double, double g) { return 1000.0 * tent(g, 20.0); });
}

/// The beam leans 20 degrees towards C0.
IntensityDistribution leaning() {
  return filled([](double c, double g) {
    const double x = g * std::cos(radians(c)), y = g * std::sin(radians(c));
    return 500.0 * tent(std::hypot(x - 20.0, y), 10.0);
  });
}

bool says(const std::string& svg, const std::string& text) { return svg.find(text) != std::string::npos; }

std::vector<double> numbers(const std::string& svg, const std::string& attribute) {
  return test::numbers_in(test::attribute_of(svg, "data-" + attribute).value_or(""));
}

TEST(SvgCartesian, CurveIsTheIntensityOverTheAngle) {
  const IntensityDistribution d = leaning();
  const std::string svg = cartesian_svg(d);
  EXPECT_TRUE(says(svg, "peak 500 cd at C 0°, γ 20°"));
  EXPECT_TRUE(says(svg, "C0 – C180: beam 50 % 10.0°, field 10 % 18.0°"));
  const auto x = numbers(svg, "x"), y = numbers(svg, "y");
  ASSERT_EQ(x.size(), 4u);
  ASSERT_EQ(y.size(), 4u);
  EXPECT_EQ(x[3], 30.0);  // the smallest range that holds 1 % of the peak
  const auto curve = test::polyline_of(svg, "points=");
  ASSERT_GT(curve.size(), 1000u);
  for (const test::TextPoint& p : curve) {
    const double angle = x[2] + (p.x - x[0]) / (x[1] - x[0]) * (x[3] - x[2]);
    const double cd = y[2] + (p.y - y[0]) / (y[1] - y[0]) * (y[3] - y[2]);
    EXPECT_NEAR(cd, 500.0 * tent(angle - 20.0, 10.0), 1.5) << angle;
  }
}

TEST(SvgCartesian, LogarithmUnitsAndZenith) {
  const std::string svg = cartesian_svg(spot(), {.lamp_flux_lm = 500.0}, true);
  EXPECT_TRUE(says(svg, "cd/klm, logarithmic"));
  EXPECT_TRUE(says(svg, " log\""));
  EXPECT_TRUE(says(svg, ">1000<"));
  EXPECT_TRUE(says(svg, ">1<"));
  const auto up = filled([](double, double g) { return 100.0 * tent(180.0 - g, 30.0); });
  EXPECT_TRUE(says(cartesian_svg(up), "over the angle from zenith"));
  IntensityDistribution radiant = spot();
  radiant.unit = FluxUnit::watt;
  EXPECT_TRUE(says(cartesian_svg(radiant, {.lamp_flux_lm = 500.0}), "W/sr over"));
}

// The 50 % line of the leaning beam is about H 0, V 20 with a radius of 5 degrees.
TEST(SvgIsocandela, HalfLineIsWhereTheBeamIs) {
  const std::string svg = isocandela_svg(leaning());
  const auto x = numbers(svg, "x"), y = numbers(svg, "y");
  const auto line = test::polyline_of(svg, "fill=\"none\" stroke=\"#222\" stroke-width=\"2\"");
  ASSERT_GT(line.size(), 30u);
  for (const test::TextPoint& p : line) {
    const double h = x[2] + (p.x - x[0]) / (x[1] - x[0]) * (x[3] - x[2]);
    const double v = y[2] + (p.y - y[0]) / (y[1] - y[0]) * (y[3] - y[2]);
    EXPECT_NEAR(std::hypot(h, v - 20.0), 5.0, 0.35) << h << " " << v;
  }
  EXPECT_TRUE(says(svg, "H → C270"));
}

TEST(SvgIsocandela, RightIsC270BelowAndC90Above) {
  const auto toward = [](double gamma, double c0) {
    return filled([=](double c, double g) {
      return 100.0 * tent(g - gamma, 6.0) * std::max(0.0, std::cos(radians(c - c0)));
    });
  };
  const auto mean_x = [](const std::string& svg) {
    double sum = 0.0;
    const auto line = test::polyline_of(svg, "fill=\"none\" stroke=\"#222\" stroke-width=\"2\"");
    for (const test::TextPoint& p : line) sum += p.x;
    return sum / static_cast<double>(line.size());
  };
  constexpr double kMiddle = 74.0 + 210.0;
  EXPECT_GT(mean_x(isocandela_svg(toward(15.0, 270.0))), kMiddle + 50.0);
  EXPECT_LT(mean_x(isocandela_svg(toward(15.0, 90.0))), kMiddle - 50.0);
  EXPECT_GT(mean_x(isocandela_svg(toward(165.0, 90.0))), kMiddle + 50.0);
}

// Equal areas for equal solid angles. The line of 1 % is at 60.99 degrees, between 100 cd at 60 and 0 at 61.
TEST(SvgSphere, AreasAreSolidAngles) {
  const auto d = filled([](double, double g) { return g <= 60.0 ? 100.0 : 0.0; });
  const std::string svg = sphere_svg(d);
  // The second path: the first is the whole sphere's.
  const std::string whole = "fill=\"#440154\"/>\n<path fill-rule=\"evenodd\"";
  ASSERT_TRUE(says(svg, whole));
  const auto ring =
      test::points_in(test::attribute_of(svg.substr(svg.find(whole) + whole.size()), "d").value_or(""));
  ASSERT_GT(ring.size(), 100u);
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const test::TextPoint &a = ring[i], &b = ring[(i + 1) % ring.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  EXPECT_NEAR(std::abs(0.5 * twice) / (std::numbers::pi * 145.0 * 145.0), 1.0 - std::cos(radians(60.99)),
              0.01);
}

TEST(SvgCone, WidthsAndIlluminance) {
  const std::string svg = cone_svg(spot(), {.last_distance_m = 10.0});
  EXPECT_TRUE(says(svg, "-10.0° to 10.0°"));
  EXPECT_TRUE(says(svg, ">3.53<"));  // 2 x 10 m x tan 10
  EXPECT_TRUE(says(svg, ">0.71<"));  // at 2 m
  EXPECT_TRUE(says(svg, ">250<"));   // 1000 cd at 2 m
  EXPECT_TRUE(says(svg, ">10<"));    // at 10 m
  const std::string lean = cone_svg(leaning(), {.last_distance_m = 10.0});
  EXPECT_TRUE(says(lean, "15.0° to 25.0°"));
  EXPECT_TRUE(says(lean, ">1.98<"));       // 10 m (tan 25 - tan 15)
  EXPECT_TRUE(says(lean, "not reached"));  // in the planes C90 and C270
  EXPECT_TRUE(says(cone_svg(filled([](double, double) { return 1.0; })), "&gt; "));
  EXPECT_THROW(cone_svg(spot(), {.fraction = 0.0}), InputError);
  EXPECT_THROW(cone_svg(spot(), {.last_distance_m = -1.0}), InputError);
}

TEST(SvgIsolux, LevelsAndFigures) {
  const std::string svg = isolux_svg(spot(), {.distance_m = 2.0});
  EXPECT_TRUE(says(svg, "E at the centre 250 "));
  EXPECT_TRUE(says(svg, ">200<"));
  EXPECT_FALSE(says(svg, ">500<"));
  EXPECT_TRUE(says(svg, "C90 is up"));
  const auto up = filled([](double, double g) { return 100.0 * tent(180.0 - g, 30.0); });
  EXPECT_TRUE(says(isolux_svg(up), "above the luminaire – C0 is right, C270 is up"));
  EXPECT_THROW(isolux_svg(spot(), {.distance_m = 0.0}), InputError);
  // 1000 (1 - g / 20) cos^3 g = 100 at g = 17.7 degrees: 2 x 2 m x tan 17.7 across, on 2.6 cm cells.
  const auto width = test::between(svg, "at 10 %: ", "m");
  ASSERT_FALSE(width.empty());
  EXPECT_GE(std::stod(width.front()), 1.25);
  EXPECT_LT(std::stod(width.front()), 1.30);
}

TEST(SvgZonal, BarsAndSums) {
  const auto even = filled([](double, double) { return 100.0; });
  const std::string svg = zonal_svg(even);
  EXPECT_TRUE(says(svg, "1257 lm in all, 50.0 % down, 50.0 % up"));
  EXPECT_TRUE(says(svg, ">109.1<"));  // 200 pi (cos 80 - cos 90)
  EXPECT_TRUE(says(svg, ">100.0<"));
  EXPECT_TRUE(says(svg, ">170–180°<"));
}

TEST(SvgDiagrams, TakeDarknessAndRefuseNonsense) {
  const IntensityDistribution dark = uniform_distribution(90.0, 10.0), none;
  for (const auto& draw : std::vector<std::function<std::string(const IntensityDistribution&)>>{
           [](const auto& d) { return cartesian_svg(d); },
           [](const auto& d) { return cartesian_svg(d, {}, true); },
           [](const auto& d) { return isocandela_svg(d); }, [](const auto& d) { return sphere_svg(d); },
           [](const auto& d) { return cone_svg(d); }, [](const auto& d) { return isolux_svg(d); },
           [](const auto& d) { return zonal_svg(d); }}) {
    const std::string svg = draw(dark);
    EXPECT_TRUE(says(svg, "</svg>"));
    EXPECT_FALSE(says(svg, "nan"));
    EXPECT_FALSE(says(svg, "inf"));
    EXPECT_THROW(draw(none), InputError);
  }
}

}  // namespace
}  // namespace lucerna
