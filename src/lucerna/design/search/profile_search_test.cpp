// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/profile_search.h"

#include <gtest/gtest.h>

#include <numbers>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/initial/zone_table.h"
#include "lucerna/design/shape/perturbed.h"
#include "lucerna/random.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

constexpr std::uint64_t kProfileRays = std::uint64_t{1} << 15, kMany = std::uint64_t{1} << 18;

/// A Lambertian cylinder in a mirror of revolution, 100 mm wide; light that passes the mirror left out.
struct Lamp {
  Lamp()
      : rays({{make_emitter(emitter()), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 15}), {}}}, Frame(),
             3) {
    rays.grow(kProfileRays);
  }
  static EmitterOptions emitter() {
    EmitterOptions options;
    options.kind = EmitterKind::cylinder;
    return options;
  }
  static DesignShape perturbed_by(double size_mm, std::uint64_t seed) {
    return perturbed(DesignShape::revolution(15, Aperture::circle(100), 6), size_mm, Rng(seed, 0));
  }
  Evaluation traced(const DesignShape& shape, std::uint64_t count = kProfileRays) const {
    EvaluationOptions options;
    options.rays = count;
    options.direct_light = false;
    options.derivatives = false;
    return evaluate(shape, mirror, rays, bins, options);
  }

  DesignRays rays;
  Reflectance mirror{0.9};
  TentBins bins = TentBins::rings(Frame(), 0.35, 48);
};

ZoneTable table_of(const Lamp& lamp, std::uint64_t count = kProfileRays) {
  return {Lamp::perturbed_by(0.0, 1), lamp.mirror, lamp.rays, count, lamp.bins, 4.0,
          Eigen::VectorXd::Zero(48)};
}

// What is left is the noise of 2^18 rays, 0.5-0.8 % for table and trace each: the table hits them elsewhere.
TEST(ZoneTable, ThrowsTheLightOfTheTrace) {
  for (const double side : {1.0, -1.0}) {  // gamma about z, or from behind
    Lamp lamp;
    lamp.rays.grow(kMany);
    if (side < 0.0) {
      lamp.bins = TentBins::rings(Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), std::numbers::pi, 48);
    }
    const ZoneTable table = table_of(lamp, kMany);
    const Evaluation plain = lamp.traced(Lamp::perturbed_by(0.0, 1), kMany);
    for (const std::uint64_t seed : {1, 2, 3}) {
      const DesignShape shape = Lamp::perturbed_by(1.0, seed);
      const Evaluation truth = lamp.traced(shape, kMany);
      const auto off = [&](const Evaluation& e) {
        return bin_error(e, truth.flux, lamp.bins, TargetMode::absolute).relative_rms;
      };
      EXPECT_LT(off(table.evaluate(shape)), 0.015) << seed << ' ' << side;
      EXPECT_GT(off(plain), 0.1) << seed;  // what shaking by 1 mm changes
    }
  }
}

TEST(ZoneTable, DerivativesAreThoseOfItsOwnLight) {
  Lamp lamp;
  lamp.rays.grow(kMany);
  const ZoneTable table = table_of(lamp, kMany);
  const DesignShape shape = Lamp::perturbed_by(0.3, 5);
  const Evaluation e = table.evaluate(shape);
  constexpr double kStep_mm = 1e-4;
  for (Eigen::Index i = 0; i < shape.parameters().size(); ++i) {
    const Eigen::VectorXd along = kStep_mm * Eigen::VectorXd::Unit(shape.parameters().size(), i);
    const Eigen::VectorXd difference = (table.evaluate(shape.with(shape.parameters() + along)).flux -
                                        table.evaluate(shape.with(shape.parameters() - along)).flux) /
                                       (2.0 * kStep_mm);
    // The table is linear between its entries: a zone or two may pass one within the step.
    EXPECT_LT((difference - e.jacobian.col(i)).norm(), 0.1 * difference.norm()) << i;
  }
}

TEST(ProfileSearch, FindsAHiddenMirrorsLightForAnyNumberOfThreads) {
  Lamp lamp;
  const DesignShape plain = Lamp::perturbed_by(0.0, 1);
  const Evaluation truth = lamp.traced(Lamp::perturbed_by(1.0, 11));
  FitProblem problem{&lamp.rays, lamp.mirror, {}, lamp.bins, TargetMode::absolute, false};
  problem.target = [&](const TentBins&) { return truth.flux; };
  ASSERT_TRUE(can_search_profiles(problem, plain));
  const double start =
      bin_error(lamp.traced(plain), truth.flux, lamp.bins, TargetMode::absolute).relative_rms;
  EXPECT_GT(start, 0.15);
  const auto searched = [&](int batches, bool& whole) {
    int batch = 0;
    return profile_search(
        problem, plain, kProfileRays, [&](const ProfileProgress&) { return ++batch < batches; }, whole);
  };
  bool whole = false;
  std::vector<InitialGuess> two, one;
  two = searched(3, whole);
  EXPECT_FALSE(whole);  // ended by its caller
  EXPECT_LT(std::sqrt(two.front().cost), 0.03);
  {
    const ThreadLimit serial(1);
    one = searched(3, whole);
  }
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].cost, two[i].cost);
    EXPECT_EQ(one[i].shape.parameters(), two[i].shape.parameters());
  }
}

TEST(ProfileSearch, IsForMirrorsAndTargetsOfRevolution) {
  Lamp lamp;
  FitProblem problem{&lamp.rays, lamp.mirror, {}, lamp.bins, TargetMode::absolute, false};
  EXPECT_FALSE(can_search_profiles(problem, DesignShape::bspline(15, Aperture::circle(100), 4, 4)));
  problem.limits = [](const DesignShape&, std::uint64_t, ResidualRows*) { return 0.0; };
  EXPECT_FALSE(can_search_profiles(problem, Lamp::perturbed_by(0.0, 1)));
  problem.limits = {};
  EXPECT_TRUE(can_search_profiles(problem, Lamp::perturbed_by(0.0, 1)));
  problem.bins = TentBins::square(Frame(), 0.3, 12);
  EXPECT_FALSE(can_search_profiles(problem, Lamp::perturbed_by(0.0, 1)));
}

}  // namespace
}  // namespace lucerna
