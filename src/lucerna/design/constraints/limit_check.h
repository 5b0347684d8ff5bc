// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lucerna/design.h"
#include "lucerna/design/problem/design_limits.h"

namespace lucerna {

/// Whether a mirror as exported (a mesh in the mirror's frame, as `cad_mesh` and an STL file have it) holds
/// the limits on its form: from its triangles alone, knowing nothing of splines. `tolerance` is what the mesh
/// was made with: within it a limit counts as held, a radius within a hundredth (`max_curvature_per_mm`).
/// Lengths are found to the tolerance; the distance to a keep-out zone only where it is less than the
/// clearance and 1 mm (else the entry says that sum), and 0 where the mirror cuts it.
std::vector<LimitCheck> check_limits(const Mesh& mirror, const DesignLimits& limits, double chord_mm,
                                     double slope_deg);

/// What of the limits keeps a design from more, in one sentence with the keys and figures: those within a
/// twentieth of what is allowed (a zone: within 0.2 mm). Limits of the aperture are not among them, it is
/// given. Empty if none binds.
std::string binding_limits(const std::vector<LimitCheck>& checks);

/// A sentence for each limit that is not held.
std::vector<std::string> broken_limits(const std::vector<LimitCheck>& checks);

}  // namespace lucerna
