// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/mode_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lucerna/design/evaluation/window.h"
#include "lucerna/random.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

constexpr std::uint64_t kRays = std::uint64_t{1} << 16;

DesignShape paraboloid(ShapeSymmetry symmetry = ShapeSymmetry::none) {
  return DesignShape::bspline(20, Aperture::circle(120, 8), 8, 8, symmetry);
}

DesignShape with_heights(const DesignShape& shape, const std::function<double(double, double)>& add_mm) {
  return shape.through([&](double x, double y) { return shape.at(x, y).z_mm + add_mm(x, y); });
}

DesignRays rays_of_cylinder(std::uint64_t seed) {
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  const Frame at({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 20});
  return DesignRays({{make_emitter(options), at, {}}}, Frame(), seed);
}

/// Its target is the light of a mirror, by rays that no search sees.
class FarMirror {
 public:
  explicit FarMirror(const DesignShape& truth)
      : truth_(truth),
        known_(rays_of_cylinder(1000)),
        rays_(rays_of_cylinder(5)),
        problem_{&rays_, Reflectance(0.9), {}, TentBins::square(Frame(), 0.6, 48), TargetMode::shape} {
    known_.grow(kRays);
    problem_.flux_reference = light(truth_, problem_.bins).sum();
    problem_.flux_weight = 0.2;
    problem_.target = [this](const TentBins& b) { return light(truth_, b); };
  }
  FarMirror(const FarMirror&) = delete;
  FarMirror& operator=(const FarMirror&) = delete;
  FitProblem& problem() { return problem_; }

  /// Relative RMS error in coarse bins, by the rays that made the target.
  double error_of(const DesignShape& shape) const {
    const TentBins b = rebinned(problem_.bins, 1.0, 12);
    const Eigen::VectorXd target = light(truth_, b), found = light(shape, b);
    return (found * (target.sum() / found.sum()) - target).norm() / target.norm();
  }

 private:
  Eigen::VectorXd light(const DesignShape& shape, const TentBins& bins) const {
    EvaluationOptions options;
    options.rays = kRays;
    options.derivatives = false;
    return evaluate(shape, Reflectance(0.9), known_, bins, options).flux;
  }

  DesignShape truth_;
  DesignRays known_, rays_;
  FitProblem problem_;
};

TEST(ModeSearch, FindsADeepTiltedMirrorFromAParaboloid) {
  const DesignShape given = paraboloid();
  FarMirror far(with_heights(given, [](double x, double y) {
    return -10.0 + 0.25 * x + 0.004 * (x * x + y * y) + 0.002 * (x * x - y * y);
  }));
  const double before = far.error_of(given);
  ASSERT_GT(before, 1.0) << "the given mirror is far off, or the test says nothing";
  const FoundShape found = mode_search(far.problem(), given, 1);
  EXPECT_LT(far.error_of(found.shape), 0.35 * before);
  EXPECT_EQ(found.shape.intervals_x(), given.intervals_x());
  EXPECT_EQ(found.shape.intervals_y(), given.intervals_y());
  EXPECT_GT(found.evaluations, 100);
  EXPECT_EQ(found.rays % static_cast<std::uint64_t>(found.evaluations), 0u);
}

TEST(ModeSearch, DependsOnItsArgumentsAlone) {
  const DesignShape given = paraboloid();
  const DesignShape truth = with_heights(given, [](double x, double y) { return 0.002 * (x * x + y * y); });
  FarMirror one(truth), other(truth);
  other.problem().rays->grow(4 * kRays);  // rays beyond those that are asked for change nothing
  const FoundShape a = mode_search(one.problem(), given, 3), b = mode_search(other.problem(), given, 3);
  EXPECT_EQ(a.shape.parameters(), b.shape.parameters());
  EXPECT_NE(a.shape.parameters(), mode_search(one.problem(), given, 4).shape.parameters());
}

// The target has a tilt, which a symmetric mirror may not follow.
TEST(ModeSearch, KeepsASymmetry) {
  const DesignShape free = paraboloid();
  FarMirror far(with_heights(free, [](double x, double y) { return 0.2 * x + 0.1 * y; }));
  for (const ShapeSymmetry symmetry :
       {ShapeSymmetry::mirror_x, ShapeSymmetry::mirror_y, ShapeSymmetry::both}) {
    const DesignShape found = mode_search(far.problem(), paraboloid(symmetry), 1).shape;
    EXPECT_EQ(found.symmetry(), symmetry);
    for (const double x : {11.0, 37.0}) {
      const double y = 23.0, z = found.at(x, y).z_mm;
      if (symmetry != ShapeSymmetry::mirror_y) {
        EXPECT_NEAR(found.at(-x, y).z_mm, z, 1e-9);
      }
      if (symmetry != ShapeSymmetry::mirror_x) {
        EXPECT_NEAR(found.at(x, -y).z_mm, z, 1e-9);
      }
    }
  }
}

// What limits cost counts: here all that is below the given vertex costs much.
TEST(ModeSearch, StaysWithinLimits) {
  const DesignShape given = paraboloid();
  FarMirror far(with_heights(given, [](double, double) { return -12.0; }));
  ASSERT_LT(mode_search(far.problem(), given, 1).shape.at(0.0, 0.0).z_mm, -3.0);
  far.problem().limits = [](const DesignShape& shape, std::uint64_t, ResidualRows*) {
    return 1e3 * std::pow(std::max(0.0, -shape.at(0.0, 0.0).z_mm), 2);
  };
  EXPECT_GT(mode_search(far.problem(), given, 1).shape.at(0.0, 0.0).z_mm, -0.5);
}

}  // namespace
}  // namespace lucerna
