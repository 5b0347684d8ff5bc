// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/trace.h"

namespace lucerna {

/// Throws InputError if two traces are not of one scene, seed and tracer, whatever their rays.
void check_addable(const TraceResult& a, const TraceResult& b);

/// The kept rays of two traces in the order of one run. Where both have rays of one block and source, those
/// of `first` come first. `sum` may be neither. O(rays).
void join_rays(const TraceResult& first, const TraceResult& second, TraceResult& sum);

}  // namespace lucerna
