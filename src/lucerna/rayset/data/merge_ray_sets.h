// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/rays.h"

namespace lucerna {

/// Adds the rays of `other` to `all`, so that both keep their fluxes: white LEDs come as a blue and a yellow
/// file. The first call (into a set without rays) moves `other` in; from the second on weights carry the
/// fluxes' own unit and extra columns and spectra that the two do not share are dropped (thinned_ray_set
/// gives both wavelengths before). Throws InputError when one has no stated flux or when lm and W would be
/// mixed; `name` is for messages.
void merge_ray_sets(RaySet& all, RaySet other, const std::string& name);

}  // namespace lucerna
