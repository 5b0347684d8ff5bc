// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "lucerna/design/lens/lens_shape.h"
#include "lucerna/random.h"

namespace lucerna {

/// How rough a lens has become, as p^T R p of its parameters p: the integral of the squared third derivative
/// of how far a free face has moved along its normals, in units of its radius, by the share of the face's
/// corners that lie before; summed over faces. Faces of fewer than four corners have none.
Eigen::MatrixXd lens_roughness(const LensShape& shape);

/// How much the sides of free faces have turned, as p^T T p of the parameters p: the sum of the squared
/// differences between neighbouring corners of how far they have moved along the normals of the face to begin
/// with, in mm^2.
Eigen::MatrixXd lens_tilt(const LensShape& shape);

/// The lens with each free face moved along its normals by a sum of cosine waves of up to `size_mm` each, the
/// shorter the smaller; an invalid one is drawn again, smaller each
/// time, and `shape` is the last resort. Depends on the arguments alone.
LensShape perturbed_smoothly(const LensShape& shape, double size_mm, Rng rng);

}  // namespace lucerna
