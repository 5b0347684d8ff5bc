// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/mesh.h"

namespace lucerna {

/// The parts of a mesh that share no corner, by place. Corners that several triangles share are repeated. O(n
/// log n).
std::vector<Mesh> shells_of(const Mesh& mesh);

/// Six times the volume of a closed mesh; above 0 where its triangles are counter-clockwise seen from
/// outside. The mesh must have corners.
double signed_volume(const Mesh& mesh);

}  // namespace lucerna
