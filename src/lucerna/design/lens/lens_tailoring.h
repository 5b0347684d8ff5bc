// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/design/evaluation/point_source.h"
#include "lucerna/design/lens/lens_limits.h"
#include "lucerna/design/lens/lens_shape.h"
#include "lucerna/design/lens/prescribed_angle.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// Lenses of several free faces, tailored to a point source: where a design begins whose light goes different
/// ways, as in a TIR collimator, where some of it is refracted twice and some totally reflected in between.
/// Each way's light is to fill the whole prescribed distribution, rays in the order of their angle from the
/// axis; or the same crossed over to the other side of the axis; or it is to be collimated, which suits
/// narrow beams of wide sources. All combinations of these for the two ways with the most light are tried,
/// each from the given lens and from it with the face over the source raised or lowered by several heights.
/// Levenberg-Marquardt on where some hundred rays of the point go, from the given shape: what the rays say
/// nothing of stays, and `limits` count. None where no way has a fiftieth of the light. Shapes are
/// valid where the given one is, and in no order. Half a second. Depends on the arguments alone.
std::vector<LensShape> tailored_lenses(const LensShape& start, const MediumView& medium,
                                       const PointSource& source, const PrescribedAngle& angle,
                                       const LensLimits& limits);

}  // namespace lucerna
