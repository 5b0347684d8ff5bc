// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/scene.h"
#include "lucerna/trace/result/image_blend.h"

namespace lucerna {

/// What light that is followed backward adds to a counted image: detectors that few rays find (small planes,
/// luminance images) are known better by it for the same time. Weighted by the variances of both; no weight
/// where it cannot be done, where counted light is better, or where the two do not agree (light by many
/// reflections is found by chance). It takes about as many rays as the trace had time for, 2^18 at least. The
/// result depends on counts only, never on the clock.
ImageBlend backward_illuminance(const Scene& scene, const TraceResult& result, std::size_t index,
                                const PlaneImage& counted);
/// The same of TraceResult::luminances[index].
ImageBlend backward_luminance(const Scene& scene, const TraceResult& result, std::size_t index,
                              const PlaneImage& counted);

}  // namespace lucerna
