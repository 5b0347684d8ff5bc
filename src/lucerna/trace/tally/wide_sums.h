// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "lucerna/core/math/int128.h"
#include "lucerna/trace.h"

namespace lucerna {

/// The sums of a tally as numbers, whether they are of one lane or of two (Tally::high).
Int128 emitted_of(const Tally& tally);
Int128 out_direct_of(const Tally& tally);
Int128 out_reflected_of(const Tally& tally);
Int128 absorbed_of(const Tally& tally, std::size_t cause);
Int128 lost_of(const Tally& tally, std::size_t cause);
/// Of all bins of a detector together.
Int128 all_bins_of(const Tally& tally, std::size_t detector);

/// Number of sums of flux: what Tally::high has where it is not empty.
std::size_t sum_count(const Tally& tally);

namespace detail {
/// Where the bins of a detector begin in Tally::high.
std::size_t first_high_bin(const Tally& tally, std::size_t detector);
}  // namespace detail

/// Of one bin. Inline: figures look at millions of them.
inline Int128 bin_of(const Tally& tally, std::size_t detector, std::size_t bin) {
  const Int128 low = tally.bins[detector][bin];
  if (tally.high.empty()) return low;
  return static_cast<Int128>(tally.high[detail::first_high_bin(tally, detector) + bin]) * (Int128{1} << 32) +
         low;
}

/// Calls `visit(sums, n)` for each array of sums of flux, in the order of Tally::high.
template <class TallyType, class Visit>
void for_each_sum(TallyType& tally, const Visit& visit) {
  visit(&tally.emitted, std::size_t{1});
  visit(&tally.out_direct, std::size_t{1});
  visit(&tally.out_reflected, std::size_t{1});
  visit(tally.absorbed.data(), tally.absorbed.size());
  visit(tally.lost.data(), tally.lost.size());
  for (auto& bins : tally.bins) visit(bins.data(), bins.size());
}

/// May these sums stay in one lane, so that two such tallies add without overflow?
bool fits_one_lane(const Tally& tally);

/// Makes two lanes of each sum; lanes of many tallies can then be added one by one, in any order, up to 2^31
/// of them. `settle_lanes` is to follow.
void split_lanes(Tally& tally);

/// After lanes were added: carries, and goes back to one lane where that holds all. The outcome depends on
/// the values of the sums alone, so that equal sums are equal bytes.
void settle_lanes(Tally& tally);

}  // namespace lucerna
