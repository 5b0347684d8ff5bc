// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lucerna/random.h"
#include "lucerna/source/adaptive/charts/support_batch.h"

namespace lucerna {

using BitColumn = std::array<std::uint32_t, kSupportBatch>;

/// The coordinates of Sequence::point<4> for kSupportBatch points from `first` on, as 32-bit fractions:
/// bits[d][i] is coordinate d of point first + i times 2^32. The same bits, several times faster.
void number_batch(const Sequence& sequence, std::uint64_t first, std::array<BitColumn, 4>& bits);

}  // namespace lucerna
