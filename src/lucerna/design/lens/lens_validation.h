// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "lucerna/design/lens/lens_blocks.h"
#include "lucerna/design/validation/box_error.h"
#include "lucerna/progress.h"
#include "lucerna/scene.h"

namespace lucerna {

/// What a lens does with light, found by code that shares nothing with its fit but Fresnel's formulas; of
/// exact surfaces the tree of an outline's sides (revolved_tree.h); and of a free face the way of light that
/// does not go straight (other_light.h).
struct LensValidation {
  DesignError error;
  /// Shares of the sources' flux: what leaves, what the medium keeps, rays that were given up.
  Estimate efficiency, absorbed, lost;
  /// Whether any ray met the lens.
  bool has_light = false;
  std::uint64_t rays = 0;
  double seconds = 0.0;
};

/// What is made small, from the error as it is printed: the root of its square and of what light costs that
/// misses the target's rectangle, `light_weight` times the squared share. A lens that spreads its light
/// evenly everywhere has a small error, and lights nothing.
double error_with_light(const DesignError& error, double light_weight);

/// Traces the scene's sources through its solids (LensBlocks), with all reflections at all boundaries by
/// chance, into the cells of the boxes: 16 replicates of independent Owen-scrambled Sobol sequences. Rays are
/// doubled from 2^18 to `max_rays`, or until the floor is half of the excess; `max_s` stops them earlier.
/// `target`: flux per cell (box_target). The same bits for any number of threads where time does not stop it.
/// Progress phase "validate".
LensValidation validate_lens(const Scene& scene, LensSurface surface, const ErrorBoxes& boxes,
                             std::span<const double> target, TargetMode mode, std::uint64_t seed,
                             std::uint64_t max_rays, double max_s = std::numeric_limits<double>::infinity(),
                             Progress& progress = no_progress());

}  // namespace lucerna
