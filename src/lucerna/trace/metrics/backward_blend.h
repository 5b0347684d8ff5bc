// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/trace/backward/backward_image.h"
#include "lucerna/trace/metrics/stop_check.h"
#include "lucerna/trace/result/image_blend.h"

namespace lucerna {

/// What light that is followed backward adds to a counted image: detectors that few rays find (small planes,
/// luminance images) are known better by it for the same time. Weighted by the variances of both; no weight
/// where counted light is better, where a plane is too near, or where the two do not agree within their
/// errors (light by many reflections is found by chance): few counted rays see large differences only. It
/// takes a sixteenth of the trace's rays, 2^18 to 2^21. The result depends on counts only, never on the
/// clock. Throws Interrupted where `stop` does.
ImageBlend backward_illuminance(const BackwardImage& backward, const TraceResult& result, std::size_t index,
                                const PlaneImage& counted, const StopCheck& stop);
/// The same of TraceResult::luminances[index].
ImageBlend backward_luminance(const BackwardImage& backward, const TraceResult& result, std::size_t index,
                              const PlaneImage& counted, const StopCheck& stop);

}  // namespace lucerna
