// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/core/parallel/atomic_add.h"

namespace lucerna {

/// Adds `n` sums of every thread of a block to `to`: within warps by shuffles, then one atomic addition a
/// warp and sum that is not zero. All threads of the block must call it.
__device__ inline void add_block_sums(const std::int64_t* sums, int n, std::int64_t* to) {
  for (int i = 0; i < n; ++i) {
    long long sum = sums[i];
    for (int step = 16; step > 0; step /= 2) sum += __shfl_down_sync(0xffffffffu, sum, step);
    if (threadIdx.x % 32 == 0 && sum != 0) atomic_add(to + i, sum);
  }
}

}  // namespace lucerna
