// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/design/design.h"

namespace lucerna {

namespace {

constexpr double kWider = 1.1, kHigher = 1.1, kNarrowerHole = 0.5;
/// Knots along a side that are not doubled any more.
constexpr int kManyIntervals = 30;
/// Knots along a side of a free form that takes the place of another family.
constexpr int kFreeFormIntervals = 8;
/// Standard errors that an error has to be less by, and light that may be lost for it.
constexpr double kClearErrors = 3.0, kEqualLight = 0.005;

/// The problem with another mirror to begin with: the paraboloid, which is all that is known beyond the given
/// one's rim.
AdviceChange changed(const DesignProblem& problem, std::string text, DesignShape start) {
  DesignProblem other = problem;
  other.project.scene.reflectors.front().reflector = start.reflector();
  other.start = std::move(start);
  return {std::move(text), std::move(other)};
}

Aperture scaled(const Aperture& a, double outline, double hole) {
  const double hole_mm = 2.0 * hole * a.hole_radius_mm();
  return a.shape() == ApertureShape::circle
             ? Aperture::circle(2.0 * outline * a.half_x_mm(), hole_mm)
             : Aperture::rectangle(2.0 * outline * a.half_x_mm(), 2.0 * outline * a.half_y_mm(), hole_mm);
}

/// The family's paraboloid on another aperture.
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

bool helps(const DesignError& with, const DesignError& without) {
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
    out.push_back(changed(problem, fmt::format("a tenth higher, {:.4g} mm", height_mm), start));
    out.back().problem.limits.max_height_mm = height_mm;
  }
  const bool free_form = !start.is_revolution() && !start.is_trough();
  if (problem.fixed_knots && free_form &&
      std::max(start.intervals_x(), start.intervals_y()) <= kManyIntervals) {
    const int x = 2 * start.intervals_x(), y = 2 * start.intervals_y();
    out.push_back(
        changed(problem, fmt::format("twice the knots, {} x {} intervals", x, y), start.refined(x, y)));
  }
  if (!free_form) {
    out.push_back(
        changed(problem, "a free form",
                DesignShape::bspline(start.focal_mm(), aperture, kFreeFormIntervals, kFreeFormIntervals)));
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
    if (result.end == DesignEnd::interrupted) break;
    trials.push_back({change.text, result.shape, result.error, helps(result.error, found)});
  }
  return trials;
}

}  // namespace lucerna
