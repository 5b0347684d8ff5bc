// SPDX-License-Identifier: Apache-2.0
#include "lucerna/objective.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lucerna/random.h"

namespace lucerna {
namespace {

/// A disk in a free-form mirror, and a spot as the target.
Project lamp(const std::string& design) {
  auto spot = std::make_shared<IntensityDistribution>(uniform_distribution(360.0, 1.0));
  for (std::size_t g = 0; g < spot->gamma_deg.size(); ++g) {
    const double gamma = spot->gamma_deg[g] / 15.0;
    spot->at(0, g) = gamma < 4.0 ? 1000.0 * std::exp2(-gamma * gamma) : 0.0;
  }
  ProjectMemory memory;
  memory.targets["spot"] = spot;
  return parse_project(
      "[[source]]\nkind = 'disk'\n[[reflector]]\nfamily = 'bspline'\nfocal_mm = 8\ndiameter_mm = 60\n"
      "position_mm = [0, 0, 8]\naxis = '-z'\n[target]\nfile = 'spot'\n[design]\nintervals = 3\n" +
          design,
      "lamp", memory);
}

double squares(const std::vector<double>& r) {
  double sum = 0.0;
  for (const double x : r) sum += x * x;
  return sum;
}

/// Worst difference between the Jacobian and central differences along random directions, over the latter.
double worst_difference(const Objective& f, const std::vector<double>& x) {
  const ObjectiveValue at = f.at(x);
  const std::size_t n = f.parameter_count();
  double worst = 0.0;
  for (std::uint64_t trial = 0; trial < 3; ++trial) {
    Rng rng(7, trial);
    std::vector<double> way(n), ahead = x, behind = x;
    constexpr double kStep = 1e-7;
    for (std::size_t i = 0; i < n; ++i) {
      way[i] = rng.uniform() - 0.5;
      ahead[i] += kStep * way[i];
      behind[i] -= kStep * way[i];
    }
    const auto high = f.at(ahead, false).residuals, low = f.at(behind, false).residuals;
    double error = 0.0, size = 0.0;
    for (std::size_t row = 0; row < high.size(); ++row) {
      double slope = 0.0;
      for (std::size_t i = 0; i < n; ++i) slope += at.jacobian[row * n + i] * way[i];
      const double found = (high[row] - low[row]) / (2.0 * kStep);
      error += (found - slope) * (found - slope);
      size += found * found;
    }
    worst = std::max(worst, std::sqrt(error / size));
  }
  return worst;
}

TEST(Objective, HasTheExactJacobianOfItsResiduals) {
  const Objective f(lamp(""), "lamp", {.rays = 1 << 14, .rim_mm = 0.0});
  EXPECT_EQ(f.parameter_count(), 36u);
  EXPECT_EQ(f.residual_count(), 48u * 48u + 1u);
  EXPECT_LT(worst_difference(f, f.start()), 1e-5);
}

TEST(Objective, SquaresOfTheBinsAreTheRelativeError) {
  const Objective f(lamp(""), "lamp", {.rays = 1 << 14});
  ObjectiveValue at = f.at(f.start(), false);
  EXPECT_TRUE(at.jacobian.empty());
  at.residuals.pop_back();
  EXPECT_NEAR(std::sqrt(squares(at.residuals)), at.relative_rms, 1e-12);
  EXPECT_GT(at.relative_rms, at.floor);
  EXPECT_NEAR(at.efficiency, 1.0, 1e-9);
  EXPECT_EQ(f.at(f.start()).residuals, f.at(f.start(), false).residuals);
}

TEST(Objective, LimitsAreOneResidualWithItsDerivative) {
  const Objective f(lamp("[design.limits]\nmax_height_mm = 20\n"), "lamp", {.rays = 1 << 14, .rim_mm = 0.0});
  EXPECT_EQ(f.residual_count(), 48u * 48u + 2u);
  EXPECT_EQ(f.at(f.start()).residuals.back(), 0.0);
  std::vector<double> high(f.parameter_count());  // about the paraboloid, 28 mm high, without its ties
  Rng rng(1, 0);
  for (double& p : high) p = 0.3 * rng.uniform();
  const ObjectiveValue broken = f.at(high);
  EXPECT_GT(broken.residuals.back(), 0.0);
  EXPECT_LT(worst_difference(f, high), 5e-3);
}

TEST(Objective, ItsGradientLeadsToTheTarget) {
  const Objective f(lamp(""), "lamp", {.rays = 1 << 15});
  std::vector<double> x = f.start();
  double cost = squares(f.at(x, false).residuals);
  const double first = cost;
  double step = 1.0;
  for (int i = 0; i < 40; ++i) {  // steepest descent with a step that adapts
    const ObjectiveValue at = f.at(x);
    std::vector<double> gradient(x.size(), 0.0), next = x;
    for (std::size_t row = 0; row < at.residuals.size(); ++row) {
      for (std::size_t k = 0; k < x.size(); ++k)
        gradient[k] += at.residuals[row] * at.jacobian[row * x.size() + k];
    }
    for (std::size_t k = 0; k < x.size(); ++k) next[k] -= step * gradient[k];
    const double there = squares(f.at(next, false).residuals);
    step *= there < cost ? 1.5 : 0.3;
    if (there < cost) x = next, cost = there;
  }
  EXPECT_LT(cost, 0.5 * first);
  EXPECT_NE(f.project_text(x), f.project_text(f.start()));
  EXPECT_NEAR(f.reflector(x).surface->at(10.0, 5.0).z_mm,
              parse_project(f.project_text(x), "found",
                            {.models = {}, .rays = {}, .targets = lamp("").memory.targets})
                  .scene.reflectors.front()
                  .reflector.surface->at(10.0, 5.0)
                  .z_mm,
              1e-9);
}

TEST(Objective, RefusesWhatIsNoParameter) {
  const Objective f(lamp(""), "lamp", {.rays = 1 << 14});
  EXPECT_THROW(f.at(std::vector<double>(35, 0.0)), InputError);
  EXPECT_THROW(f.at(std::vector<double>(36, std::numeric_limits<double>::quiet_NaN())), InputError);
  EXPECT_THROW(Objective(lamp(""), "lamp", {.rays = 0}), InputError);
  EXPECT_THROW(Objective(lamp(""), "lamp", {.rim_mm = -1.0}), InputError);
}

}  // namespace
}  // namespace lucerna
