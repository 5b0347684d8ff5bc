// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/mesh.h"

namespace lucerna {

/// The largest principal curvature, 1/mm, of the smooth surface that the corners of a mesh lie on: a cubic
/// through the corners about each, by least squares (Cazals and Pouget 2005). Narrow triangles do no harm,
/// which they do where one takes the angle at an edge over the distance across it. Of a mesh with more than
/// 2^16 corners about as many are looked at, spread evenly over their order. Corners whose neighbours do not
/// tell, as at the tip of an outline, are passed over; 0 if all are. Edges between faces have no meaning
/// here. O(n log n); a second or less.
double max_curvature_per_mm(const Mesh& mesh);

}  // namespace lucerna
