// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lucerna/trace.h"

namespace lucerna {

/// Of `illuminance(result, index)`. O(cells).
PlaneExtremes illuminance_extremes(const TraceResult& result, std::size_t index, const PlaneImage& image);
/// Of `luminance(result, index)`.
PlaneExtremes luminance_extremes(const TraceResult& result, std::size_t index, const PlaneImage& image);

}  // namespace lucerna
