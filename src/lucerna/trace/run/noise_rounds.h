// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/trace.h"

/// How a trace that goes by its noise grows: what one process and many have to decide alike.
namespace lucerna {

/// Rays of the first round; the others have 1.5, 2, 3, 4, 6, ... times as many in all.
inline constexpr std::uint64_t kFirstRound = std::uint64_t{1} << 20;

/// The smallest total of the rounds that is above `rays`.
std::uint64_t next_round(std::uint64_t rays);

/// Is it such a total? Only there the noise is looked at.
inline bool is_round(std::uint64_t rays) { return rays > 0 && next_round(rays - 1) == rays; }

/// Is there a noise to go by: a far field, no rays to keep, no source whose rays come to an end?
bool goes_by_noise(const Scene& scene);
/// If there is none: why.
NoiseEnd end_without_noise(const Scene& scene);

/// Is `node_noise`, that of the result, at most `goal`, and the peak's half of that? The peak's is asked for
/// last: it takes longer to find, and most rounds end before.
bool good_enough(const TraceResult& result, double node_noise, double goal);

}  // namespace lucerna
