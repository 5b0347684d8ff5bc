// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/source/adaptive/search/support_fit.h"

namespace lucerna {

/// The nats that a split must gain so that the average of `trees` trees on support `on` is most probable on
/// rays that it was not made from: four fifths of at most 250,000 of `rays` make trees, one fifth judges.
/// Deterministic. Cost: about 1 s for 16 trees.
double choose_penalty(const RayBlock& rays, const BoundedSupport& on, double tolerance_mm, int trees,
                      std::uint64_t seed);

/// Candidates, ascending; trees are grown with the first. Below it splits are noise (the best of 60 cuts of
/// even light gains about 4 nats) and only make files large.
inline constexpr std::array<double, 6> kPenalties{2.8, 4.0, 5.6, 8.0, 11.0, 16.0};

}  // namespace lucerna
