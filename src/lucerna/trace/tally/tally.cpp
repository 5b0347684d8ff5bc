// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/error.h"
#include "lucerna/trace.h"
#include "lucerna/trace/tally/wide_sums.h"

namespace lucerna {

namespace {

constexpr int kLowBits = 32;
constexpr std::int64_t kLowMask = (std::int64_t{1} << kLowBits) - 1;
/// Sums in [-2^62, 2^62) stay in one lane: two of them add within 63 bits.
constexpr std::uint64_t kOneLane = std::uint64_t{1} << 62;

void check_sizes(std::size_t a, std::size_t b) { LUCERNA_CHECK(a == b, "{} and {} sums", a, b); }

void check_same_sums(const Tally& a, const Tally& b) {
  check_sizes(a.absorbed.size(), b.absorbed.size());
  check_sizes(a.lost.size(), b.lost.size());
  check_sizes(a.lost_rays.size(), b.lost_rays.size());
  LUCERNA_CHECK(a.bins.size() == b.bins.size(), "{} and {} detectors", a.bins.size(), b.bins.size());
  for (std::size_t d = 0; d < a.bins.size(); ++d) check_sizes(a.bins[d].size(), b.bins[d].size());
}

/// Adds and says whether all sums fit one lane: no branch, so that the loop is vectorised.
bool add(std::int64_t* to, const std::int64_t* from, std::size_t n) {
  std::uint64_t beyond = 0;
  for (std::size_t i = 0; i < n; ++i) {
    to[i] += from[i];
    beyond |= static_cast<std::uint64_t>(to[i]) + kOneLane;
  }
  return beyond >> 63 == 0;
}

bool fits(const std::int64_t* sums, std::size_t n) {
  std::uint64_t beyond = 0;
  for (std::size_t i = 0; i < n; ++i) beyond |= static_cast<std::uint64_t>(sums[i]) + kOneLane;
  return beyond >> 63 == 0;
}

Int128 joined(std::int64_t high, std::int64_t low) {
  return static_cast<Int128>(high) * (Int128{1} << kLowBits) + low;
}

/// Sum number `at` in the order of Tally::high, whose low lane is `low`.
Int128 sum_of(const Tally& t, std::size_t at, std::int64_t low) {
  return t.high.empty() ? low : joined(t.high[at], low);
}

/// Adds the sums of `from` to those of `to`; false if one may not stay in its lane.
bool add_lanes(Tally& to, const Tally& from) {
  bool good = add(&to.emitted, &from.emitted, 1);
  good = add(&to.out_direct, &from.out_direct, 1) && good;
  good = add(&to.out_reflected, &from.out_reflected, 1) && good;
  good = add(to.absorbed.data(), from.absorbed.data(), from.absorbed.size()) && good;
  good = add(to.lost.data(), from.lost.data(), from.lost.size()) && good;
  for (std::size_t d = 0; d < to.bins.size(); ++d)
    good = add(to.bins[d].data(), from.bins[d].data(), from.bins[d].size()) && good;
  return good;
}

}  // namespace

Int128 emitted_of(const Tally& t) { return sum_of(t, 0, t.emitted); }
Int128 out_direct_of(const Tally& t) { return sum_of(t, 1, t.out_direct); }
Int128 out_reflected_of(const Tally& t) { return sum_of(t, 2, t.out_reflected); }
Int128 absorbed_of(const Tally& t, std::size_t cause) { return sum_of(t, 3 + cause, t.absorbed[cause]); }
Int128 lost_of(const Tally& t, std::size_t cause) {
  return sum_of(t, 3 + t.absorbed.size() + cause, t.lost[cause]);
}

Int128 all_bins_of(const Tally& t, std::size_t detector) {
  Int128 sum = 0;
  for (const std::int64_t low : t.bins[detector]) sum += low;
  if (t.high.empty()) return sum;
  const std::size_t first = detail::first_high_bin(t, detector);
  for (std::size_t k = 0; k < t.bins[detector].size(); ++k) sum += joined(t.high[first + k], 0);
  return sum;
}

std::size_t sum_count(const Tally& t) {
  std::size_t n = 0;
  for_each_sum(t, [&](const std::int64_t*, std::size_t sums) { n += sums; });
  return n;
}

std::size_t detail::first_high_bin(const Tally& t, std::size_t detector) {
  std::size_t first = 3 + t.absorbed.size() + t.lost.size();
  for (std::size_t d = 0; d < detector; ++d) first += t.bins[d].size();
  return first;
}

bool fits_one_lane(const Tally& tally) {
  bool good = tally.high.empty();
  for_each_sum(tally, [&](const std::int64_t* sums, std::size_t n) { good = fits(sums, n) && good; });
  return good;
}

void split_lanes(Tally& tally) {
  if (!tally.high.empty()) return;
  tally.high.reserve(sum_count(tally));
  for_each_sum(tally, [&](std::int64_t* sums, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      tally.high.push_back(sums[i] >> kLowBits);
      sums[i] &= kLowMask;
    }
  });
}

void settle_lanes(Tally& tally) {
  if (tally.high.empty()) return;
  std::uint64_t beyond = 0;
  std::size_t at = 0;
  for_each_sum(tally, [&](std::int64_t* sums, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      std::int64_t& high = tally.high[at++];
      high += sums[i] >> kLowBits;
      sums[i] &= kLowMask;
      // One lane holds it if its high part is that of a number in [-2^62, 2^62).
      beyond |= static_cast<std::uint64_t>(high) + (kOneLane >> kLowBits);
    }
  });
  if (beyond >= kOneLane >> (kLowBits - 1)) return;
  at = 0;
  for_each_sum(tally, [&](std::int64_t* sums, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) sums[i] += tally.high[at++] * (kLowMask + 1);
  });
  tally.high = {};
}

Tally& Tally::operator+=(const Tally& other) {
  check_same_sums(*this, other);
  rays += other.rays;
  reflections += other.reflections;
  for (std::size_t i = 0; i < lost_rays.size(); ++i) lost_rays[i] += other.lost_rays[i];
  const bool one_lane = high.empty() && other.high.empty();
  if (!one_lane) split_lanes(*this);
  const bool good = add_lanes(*this, other);
  if (one_lane && good) return *this;
  if (one_lane) split_lanes(*this);
  for (std::size_t i = 0; i < other.high.size(); ++i) high[i] += other.high[i];
  settle_lanes(*this);
  return *this;
}

}  // namespace lucerna
