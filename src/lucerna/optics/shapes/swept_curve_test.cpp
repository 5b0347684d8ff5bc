// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/swept_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/shapes/faceted_surface.h"
#include "lucerna/reflector.h"

namespace lucerna {
namespace {

std::vector<ProfileKnot> arc(double radius, double to_deg, int n) {
  std::vector<ProfileKnot> knots;
  for (int i = 0; i <= n; ++i) {
    const double a = to_deg * std::numbers::pi / 180.0 * i / n;
    knots.push_back({radius * std::sin(a), radius * (1.0 - std::cos(a))});
  }
  return knots;
}

template <class Make>
std::string error_of(Make&& make) {
  try {
    make();
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

// Fourth order: a circle through n points is right to about (step)^4 / 100 of its radius (four times that at
// a free end).
TEST(SweptCurve, FollowsACircleFromTheAxisPastTheEquator) {
  for (const int n : {12, 48}) {
    const SweptCurve curve(arc(20.0, 160.0, n), Sweep::revolution);
    const double step = 160.0 / 180.0 * std::numbers::pi / n, bound = 20.0 * std::pow(step, 4) / 25.0;
    for (double u = 0.0; u <= 1.0; u += 1e-3) {
      const SweptCurve::Point p = curve.at(u);
      EXPECT_NEAR(std::hypot(p.r_mm, p.z_mm - 20.0), 20.0, bound) << u;
      const double inward = (p.normal_r * -p.r_mm + p.normal_z * (20.0 - p.z_mm)) / 20.0;
      EXPECT_GT(inward, 1.0 - 1e-3) << "the inside reflects";
    }
  }
}

// What the tracer relies on: pieces join end to end, are monotone in their own coordinate, and every box of
// the tree holds its pieces.
TEST(SweptCurve, PiecesJoinAndBoxesHoldThem) {
  const SweptCurve curve({{5, 0}, {5, 8}, {14, 12}, {18, 25}, {9, 33}, {11, 40}, {12, 55}},
                         Sweep::revolution);
  const auto& pieces = curve.pieces();
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const CurvePiece& p = pieces[i];
    EXPECT_NE(p.from, p.to);
    EXPECT_TRUE(i == 0 || p.along_z != pieces[i - 1].along_z || p.from == pieces[i - 1].to);
    const double(&k)[4] = p.along_z ? p.z : p.r;
    double before = k[0];
    for (int j = 1; j <= 16; ++j) {
      const double s = j / 16.0, m = k[0] + s * (k[1] + s * (k[2] + s * k[3]));
      EXPECT_GT((m - before) * (p.to - p.from), 0.0);
      before = m;
    }
    EXPECT_NEAR(before, p.to, 1e-12);
  }
  std::size_t leaves = 0;
  for (std::size_t n = 0; n < curve.nodes().size(); ++n) {
    const CurveNode& node = curve.nodes()[n];
    leaves += node.piece >= 0;
    for (std::size_t k = n; k < static_cast<std::size_t>(node.skip); ++k) {
      const CurveNode& inner = curve.nodes()[k];
      EXPECT_TRUE(inner.r0 >= node.r0 && inner.r1 <= node.r1 && inner.z0 >= node.z0 && inner.z1 <= node.z1);
      if (inner.piece < 0) continue;
      const CurvePiece& p = pieces[static_cast<std::size_t>(inner.piece)];
      for (int j = 0; j <= 8; ++j) {
        const double s = j / 8.0, r = p.r[0] + s * (p.r[1] + s * (p.r[2] + s * p.r[3]));
        EXPECT_TRUE(r >= node.r0 - 1e-12 && r <= node.r1 + 1e-12);
      }
    }
  }
  EXPECT_EQ(leaves, pieces.size());
}

TEST(SweptCurve, RefusesWhatIsNoCurve) {
  const auto make = [](const std::vector<ProfileKnot>& knots) {
    return error_of([&] { SweptCurve(knots, Sweep::revolution); });
  };
  EXPECT_NE(make({{0, 0}, {20, 10}, {20, 30}, {5, 20}, {10, 5}, {30, 2}}).find("crosses itself"),
            std::string::npos);
  EXPECT_NE(make({{1, 0}}).find("at least 2"), std::string::npos);
  EXPECT_NE(make({{1, 0}, {1, 0}, {2, 3}}).find("points 1 and 2 are the same"), std::string::npos);
  EXPECT_NE(make({{1, 0}, {-1, 5}}).find("point 2 is [-1, 5]"), std::string::npos);
  EXPECT_NE(make({{0, 0}, {0, 5}}).find("on the axis"), std::string::npos);
  EXPECT_NE(make({{0, 0}, {NAN, 5}}).find("point 2"), std::string::npos);
  EXPECT_NE(make({{20, 0}, {20, 10}, {0.1, 11}, {0.1, 30}, {20, 31}}).find("over the axis"),
            std::string::npos);
}

TEST(SweptCurve, ProfileFamiliesPickItUpByThemselves) {
  EXPECT_EQ(profile_reflector({{0, 0}, {10, 3}, {20, 15}}, Aperture::circle(40.0)).curve, nullptr);
  EXPECT_NE(profile_reflector({{10, 0}, {10, 50}}, Aperture::circle(20.0)).curve, nullptr) << "a tube";
  EXPECT_NE(profile_reflector({{10, 0}, {12, 50}, {12.5, 80}}, Aperture::circle(25.0)).curve, nullptr)
      << "steep";
  EXPECT_NE(profile_trough(arc(20.0, 150.0, 20), Aperture::rectangle(20.0, 100.0)).curve, nullptr);
  // The mouth's diameter, as a project has it by default, represents the whole curve.
  const Reflector deep = profile_reflector(arc(20.0, 150.0, 20), Aperture::circle(20.0));
  EXPECT_NEAR(deep.aperture.half_x_mm(), 20.0, 1e-3);
  EXPECT_NO_THROW(profile_reflector(arc(20.0, 150.0, 20), Aperture::circle(60.0)));
  EXPECT_NE(
      error_of([] { profile_reflector(arc(20.0, 150.0, 20), Aperture::circle(30.0)); }).find("cut it twice"),
      std::string::npos);
  EXPECT_NE(error_of([] {
              profile_reflector({{20, 9}, {10, 3}, {0, 0}}, Aperture::circle(40.0));
            }).find("from the rim to the axis"),
            std::string::npos);
  EXPECT_THROW(FacetedSurface(deep.surface, 5.0, 10.0), InputError);
  EXPECT_THROW(deep_ellipse_reflector(10.0, 40.0, 41.0), InputError);
  EXPECT_NEAR(deep.surface->at(12.0, 0.0).z_mm, 20.0 - 16.0, 0.02) << "the lowest sheet, as chords";
}

}  // namespace
}  // namespace lucerna
