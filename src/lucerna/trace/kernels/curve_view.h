// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/optics/shapes/swept_curve.h"
#include "lucerna/reflector.h"
#include "lucerna/trace/kernels/curve_kernel.h"

namespace lucerna {

/// `curve` within `aperture` as kernels read it; points into the curve.
CurveView view_of(const SweptCurve& curve, const Aperture& aperture);

}  // namespace lucerna
