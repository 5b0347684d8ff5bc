// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/design/lens/lens_limits.h"
#include "lucerna/design/problem/target.h"
#include "lucerna/design/shape/design_shape.h"
#include "lucerna/project.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// The first face of a lens whose last one is a free form: as it is given; a cavity, if one is better; or a
/// free form too.
enum class EntryKind { given, cavity, bspline };

/// How the free face of a lens becomes a free form.
struct FreeFaceProblem {
  /// Knot intervals across: to begin with, and at most.
  int intervals = 24, max_intervals = 48;
  /// What may become of the face opposite to it.
  EntryKind entry = EntryKind::given;
  /// What light beside the target's rectangle counts; `fit_free_face` sets it (outside_weight.h).
  double outside_weight = 1.0;
};

/// A lens that is to be designed, checked.
struct LensProblem {
  Project project;
  DesignTarget target;
  LensLimits limits;
  /// The lens to begin with: the project's solid.
  LensShape start;
  MediumView medium;
  Frame world_from_lens;
  /// Without, the free faces stay those of a body of revolution.
  std::optional<FreeFaceProblem> free_face;
  /// What light costs that misses the target's rectangle, where only the shape counts.
  double light_weight = kLightWeight;
  double time_s = 60.0;
  int max_failed_restarts = 1'000'000;
};

/// Whether a project asks for a lens: [design] has `free_sides`.
bool is_lens_design(const Project& project);

/// Reads [target] and [design] of a project with one solid, given by its outline, and nothing else in the
/// light's way. Throws InputError with file, line, key, found and expected. The project gets the
/// detectors of every design (add_design_detectors).
LensProblem lens_problem(Project project, const std::filesystem::path& path);

/// Whether a project is the result of a design with a free-form face: it has a [target] for its one lens, and
/// no [design], for such a lens is none to begin with.
bool is_finished_lens(const Project& project);

/// The [target] of such a project. The project gets the target's file as an input. Throws InputError as
/// lens_problem does.
DesignTarget finished_lens_target(Project& project, const std::filesystem::path& path);

/// Share of the light of a target of directions that is at most so far from the lens's axis. Some
/// milliseconds.
double target_share_within(const LensProblem& problem, double gamma_rad);

/// The bins of the last stages: rings half as wide as the boxes of the error where the target turns about the
/// lens's axis, else 48 x 48. Rings end at a right angle to the axis, as boxes do, where the target has
/// little light behind.
TentBins lens_window(const LensProblem& problem);
/// The same light in 48 x 48 bins, whatever the target is: about its mean direction, as `target_bins` has it.
TentBins lens_boxes(const LensProblem& problem);

/// What a design makes of a lens: another outline, or the given one with free forms as its last face, and as
/// its first one (in a design's frame, face_of).
struct ShapedLens {
  LensShape outline;
  std::optional<DesignShape> face = std::nullopt, entry = std::nullopt;

  std::size_t parameter_count() const;
  /// Largest minus smallest height of the whole lens.
  double height_mm() const;
};

/// The project's solid in another shape.
Solid shaped_solid(const LensProblem& problem, const ShapedLens& lens);
/// The project with that solid: what `trace` takes.
Project with_lens(const LensProblem& problem, const ShapedLens& lens);

}  // namespace lucerna
