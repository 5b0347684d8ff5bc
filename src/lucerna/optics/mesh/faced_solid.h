// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/mesh.h"
#include "lucerna/optics/shapes/outline.h"
#include "lucerna/reflector.h"

namespace lucerna {

/// A closed body of triangles, counter-clockwise seen from outside, and the unit normals, outward, of the
/// surface that they stand for, three a triangle. Edges of the surface are edges of the normals too.
struct FacedSolid {
  Mesh mesh;
  std::vector<Vec3> corner_normals;
};

/// The body of an open outline and the face at its top, as check_faced_outline takes them, within `tolerance`
/// of its size. The normals that are blended between the corners of a triangle of the face are within 10
/// `tolerance` rad of its own. Circles have at most 4096 segments, the face at most 512 rings.
FacedSolid faced_solid(std::span<const OutlinePoint> corners_mm, const HeightSurface& face,
                       double smooth_below_deg, double tolerance);

}  // namespace lucerna
