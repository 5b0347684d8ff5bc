// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/source/adaptive/search/support_fit.h"

namespace lucerna {

/// What a support is worth, judged on rays that its density was not made from.
struct SupportScore {
  BoundedSupport on;
  /// Mean log density per ray, nats (1/(mm^2 sr)); comparable between supports.
  double nats = 0.0;
  /// Share of the flux that it carries.
  double carried = 0.0;
  /// Log density of each held-out ray with flux, and the rays' weights: what differences are evaluated by.
  std::vector<float> log_density;
};

struct SearchResult {
  SupportScore best;
  /// What it was chosen from, best first; their `nats` compare with `coarse_nats`, the best support's before
  /// it was refined on more rays.
  std::vector<SupportScore> runners_up;
  double coarse_nats = 0.0;
  /// Where a polish goes on: steps at which the search stopped, the virtual focus, the rays' rounding.
  double step_mm = 0.0, step_rad = 0.0;
  Vec3 focus_mm;
  double tolerance_mm = 0.0;
  /// Set when the rays have no étendue: then `best` is the support on which they have fewest dimensions.
  bool degenerate = false;
};

/// Finds the support that makes the density of `rays` simplest: places and sizes of every kind are proposed
/// from the rays' virtual focus, mean direction, principal axes and `surface`, each is evaluated by held-out
/// likelihood on some ten thousand rays, and the best few race: they are moved, turned and scaled.
/// Depends on rays and seed alone. Cost: about 1 s of one core, whatever the number of rays.
SearchResult search_support(const RayBlock& rays, const BoundingSurface& surface, std::uint64_t seed,
                            Progress& progress);

/// The last, exact steps of a search among the same rays with the same seed: on more rays until nothing
/// gains, then support_polish.h. Nothing where the rays have no étendue. Cost: 1 to 3 s of one core.
void polish(SearchResult& found, const RayBlock& rays, std::uint64_t seed, Progress& progress);

/// Length below which a distance is rounding of the ray file, mm.
double rounding_mm(const RayBlock& rays, const Vec3& about_mm);

/// At most `n` of the rays, one from each of as many equal stretches, chosen by `seed`.
RayBlock stratified_choice(const RayBlock& rays, std::size_t n, std::uint64_t seed);

}  // namespace lucerna
