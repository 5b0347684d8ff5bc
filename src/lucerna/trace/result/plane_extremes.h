// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lucerna/trace.h"
#include "lucerna/trace/result/image_blend.h"

namespace lucerna {

/// Of `illuminance(result, index)` and what it is averaged with. O(cells).
PlaneExtremes illuminance_extremes(const TraceResult& result, std::size_t index, const ImageParts& image);
/// Of `luminance(result, index)`.
PlaneExtremes luminance_extremes(const TraceResult& result, std::size_t index, const ImageParts& image);

}  // namespace lucerna
