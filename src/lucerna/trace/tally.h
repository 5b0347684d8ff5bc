// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/trace/units.h"

namespace lucerna {

/// Why light ended on a mirror.
enum class MirrorLoss { face, back };
/// Why the tracer gave a ray up.
enum class LostCause {
  bounce_limit,  ///< still inside after TraceOptions::max_bounces reflections
  not_finite,    ///< a coordinate became infinite or not a number
};
inline constexpr std::size_t kMirrorLosses = 2;
inline constexpr std::size_t kLostCauses = 2;

/// The sums of the rays of one replicate, in units.
struct Tally {
  std::uint64_t rays = 0;
  std::uint64_t reflections = 0;
  std::int64_t emitted = 0;
  /// What left without and after being reflected (a cover glass that lets light through does not count).
  std::int64_t out_direct = 0, out_reflected = 0;
  /// By cause: kMirrorLosses, then one per body, then one per cover glass.
  std::vector<std::int64_t> absorbed;
  /// By cause: kLostCauses; and how many rays that were.
  std::vector<std::int64_t> lost;
  std::vector<std::uint64_t> lost_rays;
  /// One array of bins per detector: far fields, planes, luminances.
  std::vector<std::vector<std::int64_t>> bins;

  /// Adds another tally of the same scene.
  Tally& operator+=(const Tally& other);
  friend bool operator==(const Tally&, const Tally&) = default;
};

}  // namespace lucerna
