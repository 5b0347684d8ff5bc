// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/shape/design_shape.h"

namespace lucerna {

/// The other mirror that throws nearly the same light. Near a paraboloid about the source, a mirror deflects
/// light by about the gradient of its departure s(x, y) from that paraboloid, so that it throws what the
/// gradients are spread over; -s(-x, -y) has the same gradients as s, each at the opposite place, and a
/// source lights opposite places nearly alike. So every solution has a conjugate in another basin, concave
/// where it is round, whose rays cross where those of the first do not, and only what this leaves out tells
/// which of the two is the better (measured on random mirrors: their light differs by 5 to 10 %). Its own
/// inverse; keeps symmetries and the vertex. `source_z_mm`: height of the source's middle over the frame;
/// where that is not above the vertex the family's own paraboloid serves.
DesignShape conjugate_solution(const DesignShape& shape, double source_z_mm);

}  // namespace lucerna
