// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/rays.h"
#include "lucerna/source/adaptive/search/support_fit.h"

namespace lucerna {

/// How the flux of some light is spread over wavelength: the inverse of its distribution function, linear
/// between points. Lines are steps: two points of the same wavelength.
struct WavelengthTable {
  /// Both ascend (not strictly); shares from 0 to 1.
  std::vector<float> share, nm;

  /// Wavelength below which the share 0 <= u < 1 of the flux lies; O(log points).
  float at(double u) const;
  friend bool operator==(const WavelengthTable&, const WavelengthTable&) = default;
};

/// The table of `nm` with their weights: every value if there are few, else 64 equal parts of the flux.
/// Needs a weight > 0.
WavelengthTable wavelength_table(std::span<const float> nm, std::span<const float> weight);

/// The light of a ray set in parts by wavelength, if colour and place or direction of its rays hang together.
struct ColourBands {
  /// Upper ends of all bands but the last, nm; empty: one band, the same spectrum for every ray.
  std::vector<float> cuts_nm;
  /// One for each band.
  std::vector<WavelengthTable> tables;

  std::size_t band(float nm) const;
};

/// Bands of equal flux, at most six, or one for each line of a line spectrum. They are kept apart only if,
/// for rays that nothing was made from, line and support foretell the band better than the bands' shares do,
/// by four standard errors. Depends on rays and seed alone. Cost: 0.3 s.
ColourBands colour_bands(const RayBlock& rays, std::span<const float> nm, const BoundedSupport& on,
                         double tolerance_mm, std::uint64_t seed);

}  // namespace lucerna
