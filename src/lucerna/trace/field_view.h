// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/core/frame.h"
#include "lucerna/reflector/height_field.h"
#include "lucerna/trace/kernel.h"

namespace lucerna {

/// `field` as kernels read it; points into it.
FieldView view_of(const HeightField& field);

/// `frame` (outer from inner) as kernels read it.
FrameView view_of(const Frame& frame);

}  // namespace lucerna
