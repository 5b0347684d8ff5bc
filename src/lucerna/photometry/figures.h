// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lucerna/photometry/beam.h"
#include "lucerna/photometry/photometric_file.h"

namespace lucerna {

/// The figures of a data sheet, with the definition of each. Fluxes in lm (or W), angles in degrees.
struct PhotometricFigures {
  BeamFigures beam;
  std::optional<double> light_output_ratio;  ///< flux over lamp flux; none for absolute photometry
  std::array<double, 18> zonal{};            ///< flux in zones of 10 degrees from nadir
  double flux_0_30 = 0.0, flux_0_40 = 0.0, flux_0_60 = 0.0, flux_60_90 = 0.0, flux_0_90 = 0.0,
         flux_90_180 = 0.0;
  /// CIE flux code N1..N5 in percent (CIE 52): flux below 41.4, 60 and 75.5 degrees over that below 90 (cones
  /// of pi/2, pi and 3 pi/2 sr), downward flux over all flux, and light output ratio (100 for absolute
  /// photometry).
  std::array<double, 5> cie_flux_code{};
  /// Smallest gamma beyond which no intensity reaches 2.5 % of the peak, about the beam's axis.
  double cut_off_deg = 0.0;
  /// NEMA type by field angle (10 % of maximum) in the planes C90 (horizontal) and C0 (vertical), as
  /// floodlights are read here (H = type B, C90-C270): 1 10-18, 2 -29, 3 -46, 4 -70, 5 -100, 6 -130, 7 above;
  /// 0 below 10 degrees or no field.
  int nema_horizontal = 0, nema_vertical = 0;
};

/// Computes all of them. Throws InputError if the grid breaks its rules. Thread safe; O(values).
PhotometricFigures photometric_figures(const PhotometricFile& file);

/// NEMA type of a field angle: 0 to 7.
int nema_type(std::optional<double> field_angle_deg);

}  // namespace lucerna
