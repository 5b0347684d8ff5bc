// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/fit/free_form_fit.h"

namespace lucerna {

/// How finely a level of FreeFormSearch fits, numbered from 0; knots, smoothing and zones are the search's.
FreeFormLevel free_form_level(int number);

/// The level with so many bins, of which a wide source has fewer, and less smoothing then.
FreeFormLevel with_bins(FreeFormLevel level, int bins);

/// The level for derivatives of which so much is noise, over the rest, were they those of all its rays in all
/// its bins: with fewer bins where that is much, and with derivatives of fewer rays where it is little.
FreeFormLevel for_noise(FreeFormLevel level, double noise);

}  // namespace lucerna
