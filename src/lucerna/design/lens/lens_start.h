// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/design/evaluation/point_source.h"
#include "lucerna/design/lens/lens_shape.h"
#include "lucerna/design/lens/prescribed_angle.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// Lenses that a point source would need to throw exactly the prescribed light: where a design of one free
/// face begins, if it is the last that light meets; and one of two, where the other is the entry, which
/// begins on the axis. That is then flat or domed, to several heights. In the half plane, light that leaves
/// the source at the angle theta from +z goes out at gamma(theta), where the flux within theta (less what the
/// other faces reflect) is the share of the prescribed flux within gamma. Snell's law gives the face's normal
/// there, and its distance follows from the ordinary differential equation that the face is across it. Four
/// solutions: held at the axis or at the edge, the rays crossing the axis or not; those without a valid shape
/// are left out. All in the lens's frame.
std::vector<LensShape> zero_etendue_lenses(const LensShape& start, const MediumView& medium,
                                           const PointSource& source, const PrescribedAngle& angle);

}  // namespace lucerna
