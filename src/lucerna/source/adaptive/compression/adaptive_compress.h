// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "lucerna/progress.h"
#include "lucerna/rays.h"
#include "lucerna/source/adaptive/compression/ray_stream.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"

namespace lucerna {

struct AdaptiveOptions {
  /// The model file has at most so many bytes. Absent: as many as the rays justify.
  std::optional<std::uint64_t> max_bytes;
  std::uint64_t seed = 1;
  /// Total flux of the model, in the unit of the rays; absent: what the header states.
  std::optional<double> flux;
  /// For studies only; absent: what the rays say. Trees averaged in each chart, nats a split must gain, and
  /// whether a second support is looked for.
  std::optional<int> trees;
  std::optional<double> penalty_nats;
  bool overlap = true;
  /// All rays, where those given are only some of them: what is cut where then comes from the rays given, and
  /// how bright each piece is from all. Null: the rays given are all.
  RayStream all_rays = {};
};

/// Compresses a ray set by the adaptive method (docs/theory/source-model.md). The same rays, options and seed
/// give the same model for any number of threads. Throws InputError without rays, without flux, or if
/// `max_bytes` is too little for any model (1000 always do). Cost: about 1 us a ray; memory: 40 bytes a ray
/// beside the rays.
std::unique_ptr<AdaptiveModel> compress_adaptive(const RaySet& rays, const AdaptiveOptions& options,
                                                 Progress& progress = no_progress());

/// Where the rays of a compressed set start: the surface that holds 99.9 % of the starts (surface_guess.h),
/// else the smallest box about all of them; `none` if they are on one point or line.
BoundingSurface starting_surface(const RayBlock& rays);

}  // namespace lucerna
