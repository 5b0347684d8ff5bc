// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/etendue_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/source.h"

namespace lucerna {
namespace {

DesignRays emitter_rays(EmitterKind kind) {
  EmitterOptions options;
  options.kind = kind;
  DesignRays rays({{make_emitter(options), Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 10}), {}}},
                  Frame(), 3);
  rays.grow(1 << 18);
  return rays;
}

/// `share` of the flux, evenly within `half_deg` of the axis.
Eigen::VectorXd spot_in(const TentBins& bins, double half_deg, double share) {
  const std::vector<double> flux = bins.flux_of(
      [&](const Direction& d) { return degrees(angle_between(d, Direction())) < half_deg ? 1.0 : 0.0; });
  const Eigen::VectorXd f =
      Eigen::Map<const Eigen::VectorXd>(flux.data(), static_cast<Eigen::Index>(flux.size()));
  return f * (share / f.sum());
}

/// By default of a Lambertian disk of 1 mm: pi^2 mm^2 sr, of even luminance.
EtendueLimit reach_of(double half_deg, double share, TargetMode mode, double efficiency = 0.0,
                      EmitterKind kind = EmitterKind::disk) {
  const DesignShape shape = DesignShape::revolution(10, Aperture::circle(20), 4);
  const TentBins bins = TentBins::rings(Frame(), 1.5 * radians(half_deg), 48);
  const DesignRays rays = emitter_rays(kind);
  SourceEtendue etendue(rays);
  return etendue_limit(rays, etendue, shape, bins, spot_in(bins, half_deg, share), mode, efficiency);
}

TEST(EtendueLimit, BoundsTheShareByTheEtendue) {
  // The opening of radius 10 (and the source's cross section of 1) at sin(half): 101 pi^2 sin^2(half).
  for (const double half_deg : {2.0, 4.5}) {
    const EtendueLimit r = reach_of(half_deg, 0.5, TargetMode::absolute);
    const double expected = 101.0 * std::pow(std::sin(radians(half_deg)), 2);
    EXPECT_NEAR(r.max_share, expected, 0.12 * expected) << half_deg;
    EXPECT_NEAR(r.opening_mm2, 101.0 * std::numbers::pi, 0.05 * 101.0 * std::numbers::pi);
  }
  EXPECT_DOUBLE_EQ(reach_of(12.0, 0.9, TargetMode::absolute).max_share, 1.0);
}

TEST(EtendueLimit, SaysWhatForbidsATarget) {
  using testing::ElementsAre;
  using testing::HasSubstr;
  using testing::IsEmpty;
  EXPECT_THAT(reach_of(12.0, 0.8, TargetMode::absolute).statements, IsEmpty());
  EXPECT_THAT(reach_of(12.0, 1.3, TargetMode::absolute).statements, ElementsAre(HasSubstr("1300 lm")));
  EXPECT_THAT(reach_of(3.0, 0.8, TargetMode::absolute).statements, ElementsAre(HasSubstr("etendue: ")));
  EXPECT_THAT(reach_of(3.0, 0.1, TargetMode::absolute).statements, IsEmpty());  // dim enough
  EXPECT_THAT(reach_of(12.0, 1.0, TargetMode::shape).statements, IsEmpty());
  EXPECT_THAT(reach_of(3.0, 1.0, TargetMode::shape, 0.8).statements,
              ElementsAre(HasSubstr("etendue: "), HasSubstr("efficiency: 0.800")));
}

TEST(EtendueLimit, ACoilIsNotJudgedByItsFocusPlane) {
  // On its focus plane the light of a coil fills twice its étendue and would not fit (model_etendue_test).
  const EtendueLimit r = reach_of(8.0, 1.0, TargetMode::shape, 0.0, EmitterKind::filament);
  EXPECT_LT(r.needed_mm2sr, 0.7 * r.etendue_mm2sr);
  EXPECT_GT(r.max_share, 0.96);
  EXPECT_THAT(r.statements, testing::IsEmpty());
}

}  // namespace
}  // namespace lucerna
