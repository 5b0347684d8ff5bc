// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

/// Independent streams that a design's rays are dealt to: the fewest whose difference shows the noise. Fewer
/// and longer Owen-scrambled nets are better: on a bench mirror 4 M rays of one stream have half the noise of
/// 16 streams of a sixteenth.
inline constexpr std::size_t kDesignStreams = 2;
/// kBlockRays rays of a design, in the mirror's frame, on the CPU or copied to a GPU.
struct DesignRayBlock {
  std::array<float, kBlockRays> x_mm, y_mm, z_mm, kx, ky, kz;
  /// Flux in mean rays.
  std::array<float, kBlockRays> weight;
};

}  // namespace lucerna
