// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/design/run/design.h"

namespace lucerna {

namespace {

constexpr double kWider = 1.1, kHigher = 1.1, kNarrowerHole = 0.5;
/// Knots along a side that are not doubled any more.
constexpr int kManyIntervals = 30;
/// Standard errors that an error has to be less by, and light that may be lost for it.
constexpr double kClearErrors = 3.0, kEqualLight = 0.005;

/// The problem with another mirror to begin with.
AdviceChange changed(DesignProblem problem, std::string text, const DesignShape& start) {
  Scene& scene = problem.project.scene;
  problem.start = start_within(problem.limits, start, scene.sources, problem.world_from_mirror);
  scene.reflectors.front().reflector = problem.start.reflector();
  return {std::move(text), std::move(problem)};
}

Aperture scaled(const Aperture& a, double outline, double hole) {
  const double hole_mm = 2.0 * hole * a.hole_radius_mm();
  return a.shape() == ApertureShape::circle
             ? Aperture::circle(2.0 * outline * a.half_x_mm(), hole_mm)
             : Aperture::rectangle(2.0 * outline * a.half_x_mm(), 2.0 * outline * a.half_y_mm(), hole_mm);
}

/// The family's paraboloid on another aperture: beyond the given rim nothing else is known.
DesignShape on(const DesignShape& family, const Aperture& aperture) {
  if (family.is_revolution()) {
    return DesignShape::revolution(family.focal_mm(), aperture, family.intervals_x());
  }
  if (family.is_trough()) {
    return DesignShape::trough(family.focal_mm(), aperture, family.intervals_x(),
                               family.symmetry() == ShapeSymmetry::trough_mirror_x);
  }
  return DesignShape::bspline(family.focal_mm(), aperture, family.intervals_x(), family.intervals_y(),
                              family.symmetry());
}

std::string size_text(const Aperture& a) {
  if (a.shape() == ApertureShape::circle) return fmt::format("{:.4g} mm", 2.0 * a.half_x_mm());
  return fmt::format("{:.4g} x {:.4g} mm", 2.0 * a.half_x_mm(), 2.0 * a.half_y_mm());
}

bool helps(const DesignResult& result, const DesignError& without) {
  const DesignError& with = result.error;
  if (!std::all_of(result.limits.begin(), result.limits.end(), [](const LimitCheck& c) { return c.held; })) {
    return false;
  }
  const double less = without.c48.excess - with.c48.excess;
  return less > kClearErrors * std::hypot(with.c48.standard_error, without.c48.standard_error) &&
         with.in_rectangle.mean > without.in_rectangle.mean - kEqualLight;
}

}  // namespace

std::vector<AdviceChange> advice_changes(const DesignProblem& problem) {
  const DesignShape& start = problem.start;
  const Aperture &aperture = start.aperture(), wide = scaled(aperture, kWider, 1.0);
  const DesignLimits& limits = problem.limits;
  std::vector<AdviceChange> out;
  if (!limits.max_diameter_mm || 2.0 * wide.outer_radius_mm() <= *limits.max_diameter_mm) {
    out.push_back(changed(problem, fmt::format("a tenth wider, {}", size_text(wide)), on(start, wide)));
  }
  const double hole_mm = 2.0 * kNarrowerHole * aperture.hole_radius_mm();
  if (hole_mm > 0.0 && hole_mm >= limits.min_hole_diameter_mm.value_or(0.0)) {
    out.push_back(changed(problem, fmt::format("half the hole, {:.4g} mm", hole_mm),
                          on(start, scaled(aperture, 1.0, kNarrowerHole))));
  }
  if (limits.max_height_mm) {
    const double height_mm = kHigher * *limits.max_height_mm;
    DesignProblem higher = problem;
    higher.limits.max_height_mm = height_mm;
    out.push_back(changed(std::move(higher), fmt::format("a tenth higher, {:.4g} mm", height_mm), start));
  }
  const bool free_form = !start.is_revolution() && !start.is_trough();
  if (problem.fixed_knots && free_form &&
      std::max(start.intervals_x(), start.intervals_y()) <= kManyIntervals) {
    const int x = 2 * start.intervals_x(), y = 2 * start.intervals_y();
    out.push_back(
        changed(problem, fmt::format("twice the knots, {} x {} intervals", x, y), start.refined(x, y)));
  }
  if (!free_form) {
    out.push_back(changed(problem, "a free form",
                          DesignShape::bspline(start.focal_mm(), aperture, kFreeFormIntervals,
                                               kFreeFormIntervals, limits.symmetry)));
    out.back().problem.fixed_knots = false;
  }
  return out;
}

std::vector<AdviceTrial> advise(const DesignProblem& problem, const DesignError& found,
                                const DesignOptions& options, Progress& progress) {
  std::vector<AdviceTrial> trials;
  if (problem.target.zones_only) return trials;
  DesignOptions again = options;
  again.advise = again.pareto = false;
  again.checkpoint.clear();
  for (const AdviceChange& change : advice_changes(problem)) {
    const DesignResult result = design(change.problem, again, progress);
    if (result.end == DesignTermination::interrupted) break;
    trials.push_back({change.text, result.error, helps(result, found)});
  }
  return trials;
}

}  // namespace lucerna
