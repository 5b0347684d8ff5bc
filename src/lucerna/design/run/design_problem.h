// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lucerna/design/problem/design_limits.h"
#include "lucerna/design/problem/target.h"
#include "lucerna/design/search/optimizer.h"
#include "lucerna/design/validation/tolerances.h"
#include "lucerna/project.h"

namespace lucerna {

/// What is to be designed, checked: read from a project by `design_problem`.
struct DesignProblem {
  Project project;
  DesignTarget target;
  DesignLimits limits;
  /// The mirror to shape, where it begins: the project's first reflector.
  DesignShape start;
  Reflectance reflectance{1.0};
  Frame world_from_mirror;
  double time_s = 60.0;
  Optimizer optimizer;
  /// After how many restarts in a row that gain nothing (of a search among candidates: after how many
  /// neighbours of the best) a design ends above the noise before its time: `restarts` of [design].
  int max_failed_restarts = 1'000'000;
  /// Of the continuation schedule: how often the knots may be doubled beyond those of `start`.
  int knot_doublings = 0;
  /// The project says how many knots there are to be. A search among candidates keeps to them while they
  /// bring the mirror near the target.
  bool fixed_knots = false;
  /// What light beside the target's rectangle costs a free form in shape mode.
  double light_weight = kLightWeight;
  /// What to try around the result; nothing: no [design.tolerances].
  std::optional<ToleranceRanges> tolerances;
};

/// Reads [target] and [design] of a project and its [[reflector]] (of several the one that `reflector` of
/// [design] numbers, which becomes the first) as a shape with free parameters: a
/// paraboloid, a profile of revolution or of a trough (fitted by the family's spline) or a B-spline. Throws
/// InputError with file, line, key, found and expected; also for limits that contradict each other or the
/// mirror, naming the pair. The project gets a
/// far field "far" if it has none, and a plane detector on a plane target.
DesignProblem design_problem(Project project, const std::filesystem::path& path);

/// The nearest shape to `start` that holds the limits on its form, as far in front of the sources as `start`
/// is; `start` itself where it holds them.
DesignShape start_within(const DesignLimits& limits, const DesignShape& start,
                         const std::vector<PlacedSource>& sources, const Frame& world_from_mirror);

/// Knots along a side of a free form where neither project nor mirror say how many, at least.
inline constexpr int kFreeFormIntervals = 8;

/// The bins in which the problem's result is evaluated.
TentBins target_window(const DesignProblem& problem);

/// The project with the mirror replaced: what `trace` takes.
Project with_shape(const DesignProblem& problem, const DesignShape& shape);

/// The [[reflector]] table of a shape, placed and coated as in the problem, as a TOML file of its own.
std::string reflector_toml(const DesignProblem& problem, const DesignShape& shape);

}  // namespace lucerna
