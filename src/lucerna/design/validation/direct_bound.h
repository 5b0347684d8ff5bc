// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lucerna/design/validation/box_error.h"

namespace lucerna {

/// What error at n = 48 the light that passes the mirror leaves at least, whatever the mirror adds to it: in
/// no box can there be less than that. By shape the mirror's own light is such that as much light is in the
/// rectangle as `replicates` have there, spread as well as it could be; the scale is the best one. The direct
/// light counts with two standard errors less in each box, so that its noise does not pass for light. It
/// holds for mirrors with the same rim: another rim lets other light pass. Target as for box_error, at least
/// two replicates. Cost: some 10 ms.
double direct_light_bound(const ErrorBoxes& boxes, std::span<const double> target, TargetMode mode,
                          std::span<const BoxSums> replicates);

}  // namespace lucerna
