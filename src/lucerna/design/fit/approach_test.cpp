// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/approach.h"

#include <gtest/gtest.h>

#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/shape/perturbed.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {
namespace {

constexpr std::uint64_t kFitRays = std::uint64_t{1} << 16;

DesignShape square(int intervals) {
  return DesignShape::bspline(15, Aperture::rectangle(100, 100), intervals, intervals);
}

Eigen::VectorXd light_of(const DesignShape& shape, const DesignRays& rays, const TentBins& bins) {
  EvaluationOptions options;
  options.rays = rays.size();
  options.derivatives = false;
  return evaluate(shape, Reflectance(1.0), rays, bins, options).flux;
}

/// A cylinder that shines into a mirror whose light, of rays that no fit sees, is the target.
class Hidden {
 public:
  explicit Hidden(const DesignShape& truth)
      : truth_(truth),
        known_(rays(1000)),
        rays_(rays(5)),
        problem_{&rays_, Reflectance(1.0), {}, bins(), TargetMode::absolute} {
    known_.grow(std::uint64_t{1} << 18);
    problem_.target = [this](const TentBins& b) { return light_of(truth_, known_, b); };
  }
  Hidden(const Hidden&) = delete;
  Hidden& operator=(const Hidden&) = delete;
  FitProblem& problem() { return problem_; }
  double error_of(const DesignShape& shape) const {
    const TentBins b = rebinned(bins(), 1.0, 20);
    const Eigen::VectorXd target = light_of(truth_, known_, b);
    return (light_of(shape, known_, b) - target).norm() / target.norm();
  }

 private:
  static TentBins bins() { return TentBins::square(Frame(), 0.2, 32); }
  static DesignRays rays(std::uint64_t seed) {
    EmitterOptions options;
    options.kind = EmitterKind::cylinder;
    const Frame at({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 15});
    return DesignRays({{make_emitter(options), at, {}}}, Frame(), seed);
  }

  DesignShape truth_;
  DesignRays known_, rays_;
  FitProblem problem_;
};

TEST(Approach, BringsAFewKnotMirrorNearAHiddenOneAtItsOwnKnots) {
  Hidden hidden(perturbed(square(3), 4.0, Rng(4, 0)));
  const DesignShape given = square(3);
  ASSERT_GT(hidden.error_of(given), 0.3) << "the start is far off, or the test says nothing";
  const FoundShape result = approach(hidden.problem(), {given}, kFitRays);
  EXPECT_LT(hidden.error_of(result.shape), 0.06);
  EXPECT_EQ(result.shape.intervals_x(), 3);
  EXPECT_EQ(result.shape.intervals_y(), 3);
  EXPECT_GT(result.evaluations, 5);
  EXPECT_GT(result.rays, kFitRays);
}

TEST(Approach, DependsOnItsArgumentsAlone) {
  const DesignShape truth = perturbed(square(2), 1.5, Rng(4, 0));
  Hidden one(truth), other(truth);
  other.problem().rays->grow(4 * kFitRays);  // rays beyond those that are asked for change nothing
  const FoundShape a = approach(one.problem(), {square(2)}, kFitRays / 4);
  const FoundShape b = approach(other.problem(), {square(2)}, kFitRays / 4);
  EXPECT_EQ(a.shape.parameters(), b.shape.parameters());
  EXPECT_EQ(a.rays, b.rays);
}

// With the fewest rays, which end the fit soonest.
TEST(Approach, HasTheGivenKnots) {
  Hidden hidden(perturbed(square(2), 1.5, Rng(4, 0)));
  const DesignShape given = DesignShape::bspline(15, Aperture::rectangle(100, 100), 20, 14);
  const FoundShape result = approach(hidden.problem(), {given}, kDesignTasks * kBlockRays);
  EXPECT_EQ(result.shape.intervals_x(), given.intervals_x());
  EXPECT_EQ(result.shape.intervals_y(), given.intervals_y());
}

}  // namespace
}  // namespace lucerna
