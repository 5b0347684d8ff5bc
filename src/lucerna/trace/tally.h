// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

namespace lucerna {

/// All sums of a trace are whole numbers of one unit, so that they do not depend on the order of adding: one
/// unit is 2^-26 of the mean ray's flux. Rounding is at most 2^-27 of a mean ray per deposit, far below
/// counting noise. No sum can overflow: a run has at most kMostRays = 2^34 rays and they sum to at most about
/// 2^60 units, of 2^63.
inline constexpr double kUnitsPerRay = 0x1p26;
inline constexpr std::uint64_t kMostRays = std::uint64_t{1} << 34;

/// A ray's flux, in mean rays, as whole units.
inline std::int64_t to_units(double rays) { return std::llround(rays * kUnitsPerRay); }

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
  /// What left without and after meeting a mirror.
  std::int64_t out_direct = 0, out_reflected = 0;
  /// By cause: kMirrorLosses, then one per body.
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
