// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/rays.h"

namespace lucerna {

/// V(lambda), the spectral luminous efficiency of photopic vision (CIE 1924, ISO/CIE 23539), linear between
/// its values each 5 nm; 0 outside of 380 to 780 nm.
double luminous_efficiency(double wavelength_nm);

/// Wavelengths that a spectrum may have, nm.
inline constexpr double kShortest_nm = 100.0, kLongest_nm = 20'000.0;

/// Throws InputError unless there are equally many wavelengths and powers, wavelengths ascend within the
/// range above, and powers are finite, nowhere below 0 and somewhere above. An empty table passes. `what`
/// begins the message: "source 1: spectrum".
void check_spectrum(const SpectralTable& spectrum, const std::string& what);

/// The spectrum of the lumens of light whose watts have the spectrum `power`: times V(lambda), at its points
/// and at those of V's table between them. A table of one point stays as it is, and so does one without
/// visible light.
SpectralTable luminous_spectrum(const SpectralTable& power);

}  // namespace lucerna
