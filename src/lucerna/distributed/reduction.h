// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/distributed/ranks.h"
#include "lucerna/trace.h"

namespace lucerna {

/// Adds the sums of all ranks at the first; elsewhere they are lost. `rays` is the number of all rays, which
/// says whether sums need two lanes on the way. Collective.
void add_sums_to_first(Ranks& ranks, TraceResult& sums, std::uint64_t rays);

/// Joins the kept rays of all ranks at the first, in the order of one run; elsewhere they are left. Where two
/// ranks have rays of one block, those of the lower rank come first. Collective. Memory at the first: the
/// rays twice.
void add_rays_to_first(Ranks& ranks, TraceResult& sums);

}  // namespace lucerna
