// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/design/lens/lens_problem.h"

namespace lucerna {

/// What of the light of a lens, whose last face is a free form, does not go straight, in by the base and out
/// by that face: light that faces reflect on the way, that leaves by the wall, or that passes the lens.
/// Returns shares of the sources' flux in `bins`, blurred by a thirtieth of the target's rectangle: it is
/// weak, and smooth but for its noise. Nothing where the face cuts what is below it. Traces `rays` of the
/// sources, in whole blocks. The same bits for any number of threads.
Eigen::VectorXd other_light(const LensProblem& problem, const ShapedLens& lens, const TentBins& bins,
                            std::uint64_t rays, std::uint64_t seed);

}  // namespace lucerna
