// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/pareto.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/design/run/design.h"
#include "lucerna/design/run/search_mirror.h"
#include "lucerna/design/search/free_form_search.h"
#include "lucerna/design/validation/validation.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kFitRays = std::uint64_t{1} << 20, kValidationRays = std::uint64_t{1} << 22;
constexpr int kBins = 96, kMaxParetoSteps = 12, kMaxRefusedSteps = 3;
/// A step that gains less than this share of the error ends a fit.
constexpr double kMinGain = 0.01;
/// The stronger of the two light weights, over the problem's.
constexpr double kStronger = 10.0;
/// Vertex distances over the aperture's radius.
constexpr TransportChoice kChoices[] = {{-1.0, 0.15}, {-1.0, 0.21}, {-1.0, 0.27},
                                        {-1.0, 0.33}, {-1.0, 0.45}, {1.0, 0.75}};
constexpr int kIntervals = 48;

DesignShape fitted(const FitProblem& problem, const DesignShape& from, std::uint64_t rays,
                   Progress& progress) {
  FreeFormLevel level;
  level.bins = kBins;
  level.rays = rays;
  const FreeFormFit fit(problem, level, progress);
  FreeFormPoint point = fit.at(from);
  double lambda = 1e-2;
  int refused = 0;
  for (int step = 0; step < kMaxParetoSteps && refused < kMaxRefusedSteps; ++step) {
    if (progress.stop_requested()) throw Interrupted();
    const double before = std::sqrt(point.equations.cost);
    refused = fit.step(point, lambda) ? 0 : refused + 1;
    if (refused == 0 && std::sqrt(point.equations.cost) > (1.0 - kMinGain) * before) break;
  }
  return point.shape;
}

/// Leaves out what another point beats in error and light.
std::vector<ParetoPoint> front(const std::vector<ParetoPoint>& all) {
  std::vector<std::size_t> order(all.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return all[a].error.in_rectangle.mean > all[b].error.in_rectangle.mean;
  });
  std::vector<ParetoPoint> out;
  for (const std::size_t i : order) {
    if (out.empty() || all[i].error.c48.excess < out.back().error.c48.excess) out.push_back(all[i]);
  }
  return out;
}

/// Mirrors to begin with: the one that was found, and those of the choices.
std::vector<DesignShape> guesses(const FitProblem& fit, const DesignShape& found) {
  std::vector<DesignShape> out{found};
  const int n = std::max(kIntervals, std::max(found.intervals_x(), found.intervals_y()));
  const DesignShape family = found.refined(n, found.is_trough() ? found.intervals_y() : n);
  for (const TransportChoice& c : kChoices) {
    const auto start = free_form_guess(fit, family, {c.sign, c.vertex_distance_mm * found.radius_mm()});
    if (start) out.push_back(*start);
  }
  return out;
}

}  // namespace

void check_pareto(const DesignProblem& problem) {
  const DesignShape& start = problem.start;
  const std::string found = start.is_revolution() ? "family = \"revolution\""
                            : !uses_free_form_search(problem)
                                ? fmt::format("optimizer = \"{}\"", problem.optimizer.name)
                            : problem.target.mode != TargetMode::shape ? "mode = \"absolute\""
                            : problem.target.zones_only                ? "zones alone"
                                                                       : "";
  if (found.empty()) return;
  throw InputError(
      fmt::format("no trade between error and light: found {}, expected a free form or a trough, "
                  "optimizer = \"auto\" and a target with mode = \"shape\"",
                  found),
      ErrorCause::unsupported, "pareto");
}

std::vector<ParetoPoint> pareto_front(const DesignProblem& problem, const DesignShape& found,
                                      const DesignOptions& options, Progress& progress) {
  DesignRays rays = design_rays(problem, options, options.seed);
  FitProblem fit = fit_problem(problem, options, rays);
  const ErrorBoxes boxes(target_rectangle(problem.target));
  const std::vector<double> target = box_target(boxes, problem.target, rays.flux());
  const std::vector<DesignShape> from = guesses(fit, found);
  std::vector<ParetoPoint> points;
  for (const DesignShape& start : from) {
    DesignShape shape = start;
    for (const double factor : {1.0, kStronger}) {
      fit.flux_weight = factor * problem.light_weight;
      shape = fitted(fit, shape, std::min(options.max_rays, kFitRays), progress);
      Scene scene = problem.project.scene;
      scene.reflectors.front().reflector = shape.reflector();
      ValidationOptions o;
      o.seed = options.seed;
      o.min_rays = o.max_rays = std::min(options.validation_rays, kValidationRays);
      o.peers = options.peers;
      points.push_back({fit.flux_weight, shape.at(0.0, 0.0).z_mm - problem.start.at(0.0, 0.0).z_mm,
                        validate(scene, boxes, target, problem.target.mode, o).error});
      progress.update("pareto", points.size(), 2 * from.size());
    }
  }
  return front(points);
}

}  // namespace lucerna
