// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/constraints/source_side.h"

#include <gtest/gtest.h>

#include "lucerna/design/shape/perturbed.h"
#include "lucerna/random.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

/// A cylinder of 16 mm across the axis, 15 mm above the vertex of the mirrors below.
DesignRays rod() {
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  options.radius_mm = 0.5;
  options.length_mm = 16.0;
  DesignRays rays({{make_emitter(options), Frame({0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 15}), {}}}, Frame(),
                  3);
  rays.grow(std::uint64_t{1} << 14);
  return rays;
}

DesignShape given() { return DesignShape::bspline(15, Aperture::circle(60, 4), 12, 12); }

DesignShape higher_by(const DesignShape& shape, double mm) {
  return shape.with(shape.parameters() + Eigen::VectorXd::Constant(shape.parameters().size(), mm));
}

TEST(SourceSide, ShareBehindIsWhatStartsBelowTheSurface) {
  const DesignRays rays = rod();
  EXPECT_EQ(share_behind(given(), rays), 0.0);
  EXPECT_NEAR(share_behind(higher_by(given(), 20.0), rays), 0.75, 0.02) << "a quarter is over the hole";
  // A paraboloid rises by a millimetre along half of the rod, so that its ends are passed first.
  const double some = share_behind(higher_by(given(), 14.0), rays);
  EXPECT_GT(some, 0.1);
  EXPECT_LT(some, 0.9);
}

TEST(SourceSide, TheGivenMirrorCostsNothing) {
  const DesignRays rays = rod();
  // Far below, nearer than a cell of the source is wide, and with the rod's ends behind it.
  for (const double mm : {0.0, 13.2, 14.0}) {
    const DesignShape shape = higher_by(given(), mm);
    const SourceSide side(shape, rays);
    EXPECT_EQ(side.cost(shape, nullptr), 0.0) << mm;
    const auto within = side.within(shape);
    ASSERT_TRUE(within) << mm;
    EXPECT_EQ(within->parameters(), shape.parameters()) << mm;
  }
}

// Also where the first look alone says so.
TEST(SourceSide, WhatCostsNothingLeavesTheSourceInFront) {
  const DesignRays rays = rod();
  const SourceSide side(given(), rays);
  Rng rng(5, 0);
  int held = 0, broken = 0;
  for (std::uint64_t k = 0; k < 300; ++k) {
    const DesignShape shape =
        perturbed(higher_by(given(), 15.0 * rng.uniform()), 1.5 * rng.uniform(), Rng(k, 1));
    const double cost = side.cost(shape, nullptr);
    if (cost == 0.0) {
      ++held;
      EXPECT_LE(share_behind(shape, rays), kMaxBehind) << k;
    } else {
      ++broken;
      ResidualRows rows;
      EXPECT_EQ(side.cost(shape, &rows), cost) << k;
    }
  }
  EXPECT_GT(held, 50);
  EXPECT_GT(broken, 20);
}

TEST(SourceSide, AMirrorThatHasPassedComesBack) {
  const DesignRays rays = rod();
  const SourceSide side(given(), rays);
  // The ends of the rod: some starts are passed, not a fiftieth of them.
  double mm = 13.0;
  while (share_behind(higher_by(given(), mm), rays) < 2.0 * kMaxBehind) mm += 0.01;
  const DesignShape through = higher_by(given(), mm);
  ASSERT_LT(share_behind(through, rays), 0.02);
  EXPECT_GT(side.cost(through, nullptr), 1.0);
  const auto back = side.within(through);
  ASSERT_TRUE(back);
  EXPECT_LE(share_behind(*back, rays), kMaxBehind);
  EXPECT_LT(side.cost(*back, nullptr), 10.0) << "0.04 mm are between a wall and where costs begin";
  EXPECT_NEAR(back->at(25.0, 20.0).z_mm, through.at(25.0, 20.0).z_mm, 0.5) << "far from the source it stays";
  EXPECT_FALSE(side.within(higher_by(given(), 18.0))) << "through the middle of the rod";
}

TEST(SourceSide, ASourceBesideTheMirrorHasNoBounds) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  DesignRays rays({{make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {100, 0, 0}), {}}}, Frame(),
                  3);
  rays.grow(std::uint64_t{1} << 14);
  const SourceSide side(given(), rays);
  EXPECT_TRUE(side.bounds().empty());
  EXPECT_EQ(side.cost(higher_by(given(), 20.0), nullptr), 0.0);
  EXPECT_EQ(share_behind(given(), rays), 0.0);
}

}  // namespace
}  // namespace lucerna
