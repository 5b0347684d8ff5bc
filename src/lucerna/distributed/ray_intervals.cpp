// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/ray_intervals.h"

#include <algorithm>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// The first interval that ends beyond `number`.
auto ending_beyond(const std::vector<RayInterval>& intervals, std::uint64_t number) {
  return std::upper_bound(intervals.begin(), intervals.end(), number,
                          [](std::uint64_t n, const RayInterval& i) { return n < i.last; });
}

}  // namespace

std::uint64_t RayIntervals::count() const {
  std::uint64_t n = 0;
  for (const RayInterval& i : intervals_) n += i.last - i.first;
  return n;
}

bool RayIntervals::overlaps(const RayInterval& interval) const {
  const auto next = ending_beyond(intervals_, interval.first);
  return next != intervals_.end() && next->first < interval.last;
}

bool RayIntervals::overlaps(const RayIntervals& other) const {
  return std::any_of(other.intervals_.begin(), other.intervals_.end(),
                     [&](const RayInterval& i) { return overlaps(i); });
}

void RayIntervals::add(const RayInterval& interval) {
  LUCERNA_CHECK(interval.first < interval.last && !overlaps(interval), "rays {}:{}", interval.first,
                interval.last);
  const auto next = intervals_.begin() + (ending_beyond(intervals_, interval.first) - intervals_.begin());
  const auto at = intervals_.insert(next, interval);
  if (at + 1 != intervals_.end() && at->last == (at + 1)->first) {
    at->last = (at + 1)->last;
    intervals_.erase(at + 1);
  }
  if (at != intervals_.begin() && (at - 1)->last == at->first) {
    (at - 1)->last = at->last;
    intervals_.erase(at);
  }
}

void RayIntervals::add(const RayIntervals& other) {
  for (const RayInterval& i : other.intervals_) add(i);
}

std::vector<RayInterval> RayIntervals::missing(const RayInterval& whole, std::uint64_t chunk_rays) const {
  std::vector<RayInterval> chunks;
  const auto cut = [&](std::uint64_t first, std::uint64_t last) {
    while (first < last) {
      const std::uint64_t end = std::min(last, (first / chunk_rays + 1) * chunk_rays);
      chunks.push_back({first, end});
      first = end;
    }
  };
  std::uint64_t at = whole.first;
  for (const RayInterval& i : intervals_) {
    cut(at, std::min(i.first, whole.last));
    at = std::max(at, i.last);
  }
  cut(at, whole.last);
  return chunks;
}

}  // namespace lucerna
