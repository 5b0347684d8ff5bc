// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "lucerna/rays.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// The point that all rays pass nearest to: it minimises the flux-weighted sum of squared distances to their
/// lines.
struct VirtualFocus {
  /// Where it is.
  Vec3 point_mm;
  /// False if all rays with flux are parallel to 10 microradian (RMS): then no point along the beam is better
  /// than another and `point_mm` is the one beside the flux-weighted mean start.
  bool determined = true;
};

/// What RayStatistics has found out. Shares and means are weighted by flux; those that need flux are absent
/// when the weights sum to zero, as without rays.
struct RaySummary {
  /// Number of rays.
  std::uint64_t count = 0;
  /// Sum of the raw weights.
  double weight_sum = 0.0;
  /// Range of the raw weights; 0 without rays.
  float weight_min = 0.0F, weight_max = 0.0F;
  /// Corners of the smallest axis-parallel box that holds every start; absent without rays.
  std::optional<Vec3> extent_min_mm, extent_max_mm;
  /// Mean start, mean direction vector (length 1 = collimated, 0 = balanced), virtual focus.
  std::optional<Vec3> mean_start_mm, mean_direction;
  /// Where the rays' lines meet, as well as they do.
  std::optional<VirtualFocus> virtual_focus;
  /// Share of the flux with kz < 0.
  std::optional<double> backwards_share;
  /// True if all weights agree to 1e-6 (float32 rounding of one value).
  bool equal_weights = true;
  /// (sum w)^2 / sum w^2: so many rays of equal weight would have the same noise. 0 when all weights are
  /// zero.
  double effective_rays = 0.0;
};

/// Gathers a RaySummary in one pass over the blocks of a file. Memory: some hundred bytes. The result depends
/// on the rays, their order and where the blocks end, never on the number of threads. Not thread safe (works
/// on all threads itself).
class RayStatistics {
 public:
  /// Adds the rays of a block.
  void add(const RayBlock& block);
  /// The summary of all blocks added so far.
  [[nodiscard]] RaySummary result() const;

 private:
  /// Plain sums; starts are taken relative to the first ray's so that far-off sources lose no digits.
  struct Sums {
    double w = 0, w2 = 0, back = 0;
    Vec3 x, k;          // sum w x, sum w k
    double kk[6] = {};  // sum w k k^T: xx xy xz yy yz zz
    Vec3 kkx;           // sum w k (k . x)
    float low[3], high[3], w_low, w_high;
    Sums();
    void add(const Sums& other);
  };
  static Sums sums_of(const RayBlock& block, std::size_t first, std::size_t last, const Vec3& about);

  std::uint64_t count_ = 0;
  Vec3 about_;
  Sums sums_;
};

/// The summary of rays in memory.
[[nodiscard]] RaySummary summarize(const RayBlock& rays);

/// Added in double, in order.
double sum_of_weights(const RayBlock& rays);

}  // namespace lucerna
#pragma GCC visibility pop
