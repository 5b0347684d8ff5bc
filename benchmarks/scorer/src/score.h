// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "box_error.h"
#include "submission.h"
#include "tally.h"

namespace bench {

/// All figures of a submission. Shares are of the source's flux. Errors, NMAE and boxes are empty where the
/// target is a road.
struct Score {
  BoxError n12, n24, n48;
  AbsoluteError nmae;
  /// Where the target is uniform.
  std::optional<Unevenness> rsd;
  std::optional<RoadScore> road;
  std::vector<LimitCheck> road_limits;
  Estimate efficiency, efficiency_lossless;
  Estimate in_rectangle, outside, outside_direct;
  Estimate mirror, mirror_back, absorber, bulk, interface, source, wrong_side, too_many_hits;
  std::uint64_t rays = 0;
  CellLight boxes;
};

/// Throws std::runtime_error where a replicate has no light.
Score score_of(const Tally& tally, const Target& target, std::uint64_t rays);

/// Why a score does not count; empty where it does: limits that are not held, more than 1e-4 of the light at
/// the wrong side of an interface, beyond the number of hits or of near misses; a road that is lit worse than
/// it must be.
std::vector<std::string> faults(const Score& score, const Submission& submission);

}  // namespace bench
