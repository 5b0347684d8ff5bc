// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/geometry.h"
#include "lucerna/optics/height_field/height_field.h"
#include "lucerna/trace/kernels/kernel.h"

namespace lucerna {

/// `field` as kernels read it; points into it. `away_mm`: how far the mirror's frame is from the origin of
/// the frame that rays are handed over in; what that rounds off a start counts as tolerance.
FieldView view_of(const HeightField& field, double away_mm = 0.0);

/// `frame` (outer from inner) as kernels read it.
FrameView view_of(const Frame& frame);

}  // namespace lucerna
