// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/evaluation/window.h"

namespace lucerna {

/// A source shrunk to a point, in the mirror's frame: the point that its rays pass nearest to, and the
/// directions that they leave in.
struct PointSource {
  Vec3 at_mm;
  std::vector<DirectedFlux> light;
};

/// Of the first `rays` rays (rounded to whole blocks). Flux in shares of the source's.
PointSource point_source(const DesignRays& rays, std::uint64_t count);

}  // namespace lucerna
