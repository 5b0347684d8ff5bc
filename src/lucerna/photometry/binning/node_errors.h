// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/intensity.h"

namespace lucerna {

/// Steadier standard errors of a counted distribution. An error from 16 replicates is itself uncertain by
/// 18 %, and zero where no ray came. But the variance of a count is its mean times what one ray carries
/// (times less for Sobol points), and that factor varies slowly over the sphere. So it is taken from the sums
/// of variances and of flux over each value's neighbours (two gammas to either side; the next plane to either
/// side, or all that the value was pooled from): with flux n w in the solid angle behind a value, the
/// variance is (n + 1) w^2, the 1 for what a count of n does not exclude. Where nothing shines near by, w is
/// that of the whole sphere: one ray.
///
/// `variance`: of each value of `d.cd`; `solid_angle_sr`: behind each value; `pooled_planes`: for each gamma,
/// how many planes to either side a value was pooled from. All of the layout of `d`. O(values * neighbours).
std::vector<double> pooled_errors(const IntensityDistribution& d, std::span<const double> variance,
                                  std::span<const double> solid_angle_sr,
                                  std::span<const std::size_t> pooled_planes);

}  // namespace lucerna
