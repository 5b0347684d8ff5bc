// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/intensity.h"

namespace lucerna {

/// Intensities on a Type A or B grid, as IES LM-63 lists them: for each H all V. Angles ascending within
/// [-90, 90].
struct TypeAbGrid {
  char type = 'B';  ///< 'A' or 'B'
  std::vector<double> h_deg, v_deg;
  std::vector<double> cd;  ///< `cd[h * v_deg.size() + v]`
  /// True if the data say H >= 0 only and hold for -H as well.
  bool mirrored_h = false;
};

/// Flux by the product trapezoid rule in the type's own measure: B: d(sin H) dV, A: dH d(sin V) (lm or W).
double type_ab_flux(const TypeAbGrid& grid);

/// Intensity at H, V (degrees), bilinear; 0 outside the grid.
double type_ab_intensity(const TypeAbGrid& grid, double h_deg, double v_deg);

/// The grid on Type C angles with the beam (H0, V0) on nadir, V+90 on C0 and H+90 on C270, 1 degree in gamma
/// to 90 and 2.5 in C, scaled to the flux of `type_ab_flux`. `scale_used` receives that factor.
IntensityDistribution type_c_from_ab(const TypeAbGrid& grid, double& scale_used);

}  // namespace lucerna
