// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/lens/lens_shape.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// What one evaluation of a lens traces.
struct LensEvaluationOptions {
  std::uint64_t rays = 1 << 16;
  /// Also the derivatives.
  bool derivatives = true;
  /// Follow light that one boundary has reflected, too, for one block of rays in so many, and what two have
  /// for one in the square of it; 0: none.
  int ghost_every = 4;
  /// Ways of more hits than these have no derivatives: light that goes to and fro within is chaotic. It
  /// counts where it falls.
  int smooth_hits = 6;
  /// Derivatives include the light that crosses edges between faces as the surface moves, estimated from the
  /// hits in a strip of this width along them. 0 leaves it out: then the derivatives are exactly those of the
  /// given rays' sums.
  double edge_mm = 0.0;
};

/// A good LensEvaluationOptions::edge_mm, over the lens's radius.
inline constexpr double kEdgeShare = 0.02;

/// Traces the first `options.rays` rays (in the lens's frame) through the lens into the bins, on the main way
/// of each (`LensTracer`) with Fresnel's weight, and on the ways with one and two partial reflections; light
/// of more, less than a thousandth, is left out. Exact pathwise derivatives: hit point, normal,
/// Snell's step, the weights and all later hits. Of the result, `reflected` is what leaves through the lens,
/// `absorbed` what the medium keeps; `direct` light met no lens. The same bits for any number of threads.
/// Thread safe.
Evaluation evaluate_lens(const LensShape& shape, const MediumView& medium, const DesignRays& rays,
                         const TentBins& bins, const LensEvaluationOptions& options);

/// Share of the first `count` rays that begin within the lens.
double share_within(const LensShape& shape, const DesignRays& rays, std::uint64_t count);

}  // namespace lucerna
