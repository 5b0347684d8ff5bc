// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/mode_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/fit/approach.h"
#include "lucerna/design/initial/initial_guesses.h"
#include "lucerna/design/optimizers/global_search.h"

namespace lucerna {

namespace {

/// Modes need few rays in few bins: a third of the problem's along each side, somewhat wider.
constexpr std::uint64_t kModeRays = std::uint64_t{1} << 14;
constexpr int kEvaluations = 400;
constexpr double kWiden = 1.2;

/// A height over the radius, at u = x / radius, v = y / radius, and the range of its coefficient. Mirrors
/// that catch more light than the given one are deeper, and their vertex is farther from the source.
struct Mode {
  double (*height)(double u, double v);
  bool is_odd_in_x, is_odd_in_y;
  double centre, half;
};

constexpr std::array<Mode, 9> kModes{{
    {[](double, double) { return 1.0; }, false, false, -0.15, 0.3},
    {[](double u, double) { return u; }, true, false, 0.0, 0.4},
    {[](double, double v) { return v; }, false, true, 0.0, 0.4},
    {[](double u, double v) { return u * u + v * v; }, false, false, 0.15, 0.4},
    {[](double u, double v) { return u * u - v * v; }, false, false, 0.0, 0.3},
    {[](double u, double v) { return 2.0 * u * v; }, true, true, 0.0, 0.3},
    {[](double u, double v) { return u * (u * u + v * v); }, true, false, 0.0, 0.15},
    {[](double u, double v) { return v * (u * u + v * v); }, false, true, 0.0, 0.15},
    {[](double u, double v) { return std::pow(u * u + v * v, 2); }, false, false, 0.0, 0.15},
}};

bool allows(ShapeSymmetry symmetry, const Mode& mode) {
  const bool even_x = symmetry == ShapeSymmetry::mirror_x || symmetry == ShapeSymmetry::both;
  const bool even_y = symmetry == ShapeSymmetry::mirror_y || symmetry == ShapeSymmetry::both;
  return !(even_x && mode.is_odd_in_x) && !(even_y && mode.is_odd_in_y);
}

/// What a coefficient of 1 adds to the parameters of a shape: heights are linear in both.
Eigen::VectorXd parameters_of(const Mode& mode, const DesignShape& shape) {
  const double radius_mm = shape.radius_mm();
  const auto height = [&](double x, double y) { return shape.at(x, y).z_mm; };
  const auto with_mode = [&](double x, double y) {
    return height(x, y) + radius_mm * mode.height(x / radius_mm, y / radius_mm);
  };
  return shape.through(with_mode).parameters() - shape.through(height).parameters();
}

}  // namespace

FoundShape mode_search(const FitProblem& problem, const DesignShape& given, std::uint64_t seed) {
  LUCERNA_CHECK(!given.is_trough() && !given.is_revolution(), "modes of a mirror that is no free form");
  std::vector<Mode> modes;
  std::copy_if(kModes.begin(), kModes.end(), std::back_inserter(modes),
               [&](const Mode& m) { return allows(given.symmetry(), m); });
  const auto count = static_cast<Eigen::Index>(modes.size());
  Eigen::MatrixXd directions(given.parameters().size(), count);
  SearchBox box{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Mode& mode = modes[static_cast<std::size_t>(i)];
    directions.col(i) = parameters_of(mode, given);
    box.centre[i] = mode.centre;
    box.half[i] = mode.half;
  }
  const auto shape_of = [&](const Eigen::VectorXd& coefficients) {
    return given.with(given.parameters() + directions * coefficients);
  };
  problem.rays->grow(kModeRays);
  const TentBins bins = rebinned(problem.bins, kWiden, problem.bins.count() / 3);
  const Eigen::VectorXd target = problem.target(bins);
  const FitProblem coarse = with_fit_flux_weight(problem);
  const BatchCost cost = [&](const std::vector<Eigen::VectorXd>& points) {
    std::vector<double> costs;
    for (const Eigen::VectorXd& p : points)
      costs.push_back(fit_cost(coarse, shape_of(p), bins, target, kModeRays));
    return costs;
  };
  const GlobalSearchResult found = global_search(GlobalMethod::cma_es, box, {seed, kEvaluations}, cost);
  return {shape_of(found.best), found.evaluations, static_cast<std::uint64_t>(found.evaluations) * kModeRays};
}

}  // namespace lucerna
