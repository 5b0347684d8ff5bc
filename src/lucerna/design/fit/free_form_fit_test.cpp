// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/free_form_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lucerna/source.h"

namespace lucerna {
namespace {

/// Even light on a rectangle from a disk before a mirror; its light spills over.
FitProblem spilling_problem(DesignRays& rays, double outside_weight) {
  FitProblem p{&rays, Reflectance(0.9), {}, TentBins::square(Frame(), 0.6, 24), TargetMode::absolute};
  p.target = [](const TentBins& bins) {
    const std::vector<double> flux = bins.flux_of([](const Direction& d) {
      return d.z() > 0.0 && std::abs(d.x()) < 0.2 && std::abs(d.y()) < 0.1 ? 5.0 : 0.0;
    });
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(flux.data(), static_cast<Eigen::Index>(flux.size())));
  };
  p.rectangle = {Frame(), false, -0.3, 0.3, -0.2, 0.2};
  p.outside_weight = outside_weight;
  return p;
}

DesignRays spilling_rays() {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 3.0;
  DesignRays rays({{make_emitter(options), Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 26}), {}}},
                  Frame(), 3);
  return rays;
}

FreeFormLevel coarse_level() {
  FreeFormLevel level;
  level.bins = 16;
  level.rays = kBlockRays * kDesignTasks;
  return level;
}

DesignShape bowl() { return DesignShape::bspline(15, Aperture::circle(60), 4, 4); }

// In absolute mode the squared error is that within the rectangle and so much of that beside it.
TEST(FreeFormFit, LightBesideTheRectangleCountsByItsWeight) {
  DesignRays rays = spilling_rays();
  const auto squared = [&](double weight) {
    const FitProblem problem = spilling_problem(rays, weight);
    const FreeFormFit fit(problem, coarse_level());
    const FreeFormPoint point = fit.at(bowl(), false);
    const double error = fit.error(point).relative_rms;
    EXPECT_NEAR(point.equations.cost, error * error, 1e-12 * error * error);
    return error * error;
  };
  const double all = squared(1.0), within = squared(0.0);
  EXPECT_GT(within, 0.0);
  EXPECT_GT(all, 1.1 * within) << "light falls beside it";
  EXPECT_NEAR(squared(0.25), 0.75 * within + 0.25 * all, 1e-9 * all);
}

// Light of other ways is all there is of it within the rectangle. Beside it no shape makes it less, and it
// takes the place of light that is wanted there, and of no more.
TEST(FreeFormFit, OtherLightBesideTheRectangleIsNoMoreThanIsWanted) {
  DesignRays rays = spilling_rays();
  FitProblem problem = spilling_problem(rays, 1.0);
  problem.rectangle = {Frame(), false, -0.1, 0.1, -0.05, 0.05};
  FreeFormLevel level = coarse_level();
  level.widen = 3.0;
  FreeFormFit fit(problem, level);
  const Eigen::VectorXd wanted = problem.target(fit.bins());
  const Eigen::VectorXd all =
      2.0 * wanted + Eigen::VectorXd::Constant(wanted.size(), 0.1 * wanted.maxCoeff());
  const Eigen::VectorXd inside = in_rectangle(fit.bins(), problem.rectangle);
  const Eigen::VectorXd without = fit.at(bowl(), false).light.flux;
  problem.other_light = [&](const DesignShape&, const TentBins&, std::uint64_t) -> Eigen::VectorXd {
    return 1.0 * all;
  };
  fit.keep_other_light_of(bowl());
  const Eigen::VectorXd other = fit.at(bowl(), false).light.flux - without;
  int within = 0, lit_beside = 0, dark_beside = 0;
  for (Eigen::Index b = 0; b < other.size(); ++b) {
    if (inside[b] > 0.0 && inside[b] < 1.0) continue;
    EXPECT_NEAR(other[b], inside[b] > 0.0 ? all[b] : wanted[b], 1e-12) << b;
    ++(inside[b] > 0.0 ? within : wanted[b] > 0.0 ? lit_beside : dark_beside);
  }
  EXPECT_GT(std::min({within, lit_beside, dark_beside}), 3);
}

// Cost and gradient have the same weights: along the gradient both agree.
TEST(FreeFormFit, ItsGradientHasTheSameWeights) {
  DesignRays rays = spilling_rays();
  const FitProblem problem = spilling_problem(rays, 0.25);
  const FreeFormFit fit(problem, coarse_level());
  const FreeFormPoint point = fit.at(bowl());
  const Eigen::VectorXd along = point.equations.gradient / point.equations.gradient.cwiseAbs().maxCoeff();
  constexpr double kStep_mm = 1e-4;
  const auto cost = [&](double step_mm) {
    return fit.at(point.shape.with(point.shape.parameters() + step_mm * along), false).equations.cost;
  };
  const double slope = (cost(kStep_mm) - cost(-kStep_mm)) / (2.0 * kStep_mm);
  EXPECT_NEAR(slope, 2.0 * point.equations.gradient.dot(along), 0.05 * std::abs(slope));
}

}  // namespace
}  // namespace lucerna
