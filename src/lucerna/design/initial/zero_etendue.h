// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lucerna/design/evaluation/point_source.h"
#include "lucerna/design/shape/design_shape.h"

namespace lucerna {

/// Mirrors that a point source would need to throw exactly the light `target_flux` (in the mirror's frame;
/// its sum does not matter): where a design starts, since blurring by the source's size moves the optimum
/// little where the mirror is large beside the source. Each holds the family's vertex and fills its aperture.
/// Solutions that fold over or leave the aperture's reach are left out; there may be none.
///
/// Revolution: flux balance. The ray that leaves the source at the angle theta from the vertex goes out at
/// gamma(theta), where the flux between vertex and theta is the share of the prescribed flux inside (or
/// outside) |gamma|, and the profile's polar radius follows from d ln rho / d theta = tan((theta + gamma) /
/// 2). Four solutions: from the middle outward or from the edge inward, the rays crossing the axis or not. A
/// trough's profile follows in the same way from the light seen along it; two solutions, from side to side.
///
/// Free form: the envelope of paraboloids about the prescribed directions, with the flux that each
/// catches prescribed (supporting paraboloids; Oliker 1987), solved as the optimal transport that it is (Wang
/// 2004: cost -log(1 - d . o), or its negative for the other envelope) with an entropy that falls step by
/// step and leaves the envelope as smooth as `blur_rad` (Sinkhorn's iteration). Two solutions.
std::vector<DesignShape> zero_etendue_shapes(const DesignShape& family, const PointSource& source,
                                             std::span<const DirectedFlux> target_flux, double blur_rad);

/// The trough's solution with its vertex so far (> 0) from the source. `same_order`: light of one side goes
/// out to that side, else the rays cross. Nothing where it folds over or does not fill the aperture.
std::optional<DesignShape> trough_balance(const DesignShape& family, const PointSource& source,
                                          std::span<const DirectedFlux> target_flux, double distance_mm,
                                          bool same_order);

}  // namespace lucerna
