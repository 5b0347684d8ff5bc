// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/bsdf.h"
#include "lucerna/optics/materials/bsdf_words.h"

namespace lucerna {

/// A `.bsdf` file of LightTools: azimuths and radial angles about the surface's normal, where the light comes
/// from azimuth 90, so that a mirror sends it to 270; a block for each incidence. Taken are the blocks of the
/// front that are BRDFs, of tristimulus values those of Y, of several wavelengths the nearest one. Throws
/// InputError as `parse_bsdf` does.
BsdfTable read_lighttools_bsdf(BsdfWords& words, double wavelength_nm);

}  // namespace lucerna
