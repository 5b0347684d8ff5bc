// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace lucerna {

/// Ray numbers [first, last).
struct RayInterval {
  std::uint64_t first = 0, last = 0;
  friend bool operator==(const RayInterval&, const RayInterval&) = default;
};

/// A set of ray numbers: intervals that ascend and neither touch nor overlap, whatever they were made of.
class RayIntervals {
 public:
  const std::vector<RayInterval>& all() const { return intervals_; }
  bool empty() const { return intervals_.empty(); }
  /// How many numbers there are in it.
  std::uint64_t count() const;
  /// Is any number of the interval in it? O(log intervals).
  bool overlaps(const RayInterval& interval) const;
  bool overlaps(const RayIntervals& other) const;
  bool operator==(const RayIntervals&) const = default;

  /// Adds an interval that it does not overlap, which is an internal error. O(intervals).
  void add(const RayInterval& interval);
  void add(const RayIntervals& other);

  /// What `whole` has beside it, cut at the multiples of `chunk_rays`: the work that is left, ascending.
  std::vector<RayInterval> missing(const RayInterval& whole, std::uint64_t chunk_rays) const;

 private:
  std::vector<RayInterval> intervals_;
};

}  // namespace lucerna
