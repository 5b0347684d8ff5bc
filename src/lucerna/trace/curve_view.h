// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/reflector.h"
#include "lucerna/reflector/swept_curve.h"
#include "lucerna/trace/curve_kernel.h"

namespace lucerna {

/// `curve` within `aperture` as kernels read it; points into the curve.
CurveView view_of(const SweptCurve& curve, const Aperture& aperture);

}  // namespace lucerna
