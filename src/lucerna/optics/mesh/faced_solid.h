// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lucerna/mesh.h"
#include "lucerna/optics/shapes/outline.h"
#include "lucerna/reflector.h"

namespace lucerna {

/// The body of an open outline and its faces, as check_faced_outline takes them: a closed mesh,
/// counter-clockwise seen from outside, within `tolerance` of the body's size. Circles have at most 4096
/// segments, a face at most 512 rings.
Mesh faced_solid(std::span<const OutlinePoint> corners_mm, const BodyFaces& faces, double smooth_below_deg,
                 double tolerance);

}  // namespace lucerna
