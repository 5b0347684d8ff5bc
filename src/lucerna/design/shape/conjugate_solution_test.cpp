// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/shape/conjugate_solution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/fit/fit.h"
#include "lucerna/design/shape/perturbed.h"
#include "lucerna/design/solver/least_squares.h"
#include "lucerna/random.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

constexpr double kSourceZ = 15.0;

PlacedSource cylinder() {
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  return {make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, kSourceZ}), {}};
}

DesignShape square(ShapeSymmetry symmetry = ShapeSymmetry::none) {
  return DesignShape::bspline(15, Aperture::rectangle(100, 100), 4, 4, symmetry);
}

TEST(ConjugateSolution, IsItsOwnInverseInEveryFamily) {
  for (const DesignShape& family : {square(), square(ShapeSymmetry::mirror_x), square(ShapeSymmetry::both),
                                    DesignShape::trough(15, Aperture::rectangle(100, 100), 6),
                                    DesignShape::trough(15, Aperture::rectangle(100, 100), 6, true),
                                    DesignShape::revolution(15, Aperture::circle(100), 8)}) {
    const DesignShape shape = perturbed(family, 1.0, Rng(3, 0)), other = conjugate_solution(shape, kSourceZ);
    EXPECT_GT((other.parameters() - shape.parameters()).norm(), 0.5);
    EXPECT_LT((conjugate_solution(other, kSourceZ).parameters() - shape.parameters()).norm(), 1e-6);
  }
}

TEST(ConjugateSolution, AParaboloidAboutTheSourceIsItsOwn) {
  const DesignShape shape = square();
  EXPECT_LT((conjugate_solution(shape, kSourceZ).parameters() - shape.parameters()).norm(), 1e-9);
  EXPECT_GT((conjugate_solution(shape, kSourceZ + 1.0).parameters() - shape.parameters()).norm(), 0.5);
}

/// Light of a shape in 24 x 24 bins.
Evaluation light(const DesignShape& shape, const DesignRays& rays, const TentBins& bins) {
  EvaluationOptions options;
  options.rays = rays.size();
  options.derivatives = false;
  options.direct_light = false;
  return evaluate(shape, Reflectance(1.0), rays, bins, options);
}

TEST(ConjugateSolution, ThrowsNearlyTheSameLight) {
  DesignRays rays({cylinder()}, Frame(), 1);
  rays.grow(1 << 15);
  const TentBins bins = TentBins::square(Frame(), 0.15, 24);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const DesignShape shape = perturbed(square(), 2.0, Rng(seed, 0));
    const Eigen::VectorXd own = light(shape, rays, bins).flux;
    const auto off = [&](const DesignShape& s) {
      return bin_error(light(s, rays, bins), own, bins, TargetMode::absolute).relative_rms;
    };
    // Neither half of it alone does: turned by half a turn, or concave for round.
    const double turned = off(shape.with(shape.parameters().reverse()));
    const double hollow = off(shape.with(-shape.parameters()));
    EXPECT_LT(off(conjugate_solution(shape, kSourceZ)), 0.6 * std::min(turned, hollow)) << seed;
  }
}

/// A fit that begins in the basin of the hidden mirror's conjugate finds out.
TEST(ConjugateSolutionSlow, IsWhereAFitLooksForABetterBasin) {
  const DesignShape truth = perturbed(square(), 2.0, Rng(9, 0));
  const TentBins bins = TentBins::square(Frame(), 0.143, 48), coarse = rebinned(bins, 1.0, 24);
  DesignRays known({cylinder()}, Frame(), 1000), rays({cylinder()}, Frame(), 5);
  known.grow(1 << 19);
  FitProblem problem{&rays, Reflectance(1.0), {}, bins, TargetMode::absolute, false};
  problem.target = [&](const TentBins& b) { return light(truth, known, b).flux; };
  problem.guesses = {{conjugate_solution(truth, kSourceZ), InitialKnots::own_knots}};
  const auto end = [&](int restarts) {
    problem.max_failed_restarts = restarts;
    Fit fit(problem, continuation_schedule(square(), bins, {1 << 17, 0}), square());
    while (!fit.done() && fit.state().restart.searches < 2) fit.step();
    const Evaluation e = light(fit.best(), known, coarse);
    return bin_error(e, problem.target(coarse), coarse, TargetMode::absolute).relative_rms;
  };
  EXPECT_LT(end(1), 0.7 * end(0));
}

}  // namespace
}  // namespace lucerna
