// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/initial/zero_etendue.h"

namespace lucerna {

/// The two envelopes of `zero_etendue_shapes` for free-form families. Cost: about 1000 directions of the
/// source by as many as are wanted, a hundred times: half a second for 256.
std::vector<DesignShape> supporting_paraboloids(const DesignShape& family, const PointSource& source,
                                                std::span<const DirectedFlux> target_flux, double blur_rad);

}  // namespace lucerna
