// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lucerna/core/flux_unit.h"

namespace lucerna {

/// Luminous (cd) or radiant (W/sr) intensity over the full sphere on a CIE Type C grid, in the luminaire frame of
/// docs/conventions.md: nadir (gamma 0) = -z, C0 = +x, C90 = +y. Always expanded: symmetry is found when writing.
struct IntensityDistribution {
  /// C planes, ascending, first 0, all < 360 (the plane at 360 is the first one again). One plane = rotational.
  std::vector<double> c_deg;
  /// gamma angles, ascending, within [0, 180].
  std::vector<double> gamma_deg;
  /// Intensity, plane after plane: `cd[c * gamma_deg.size() + g]`. W/sr when `unit` is watt.
  std::vector<double> cd;
  FluxUnit unit = FluxUnit::lumen;

  double& at(std::size_t c, std::size_t g) { return cd[c * gamma_deg.size() + g]; }
  double at(std::size_t c, std::size_t g) const { return cd[c * gamma_deg.size() + g]; }
};

}  // namespace lucerna
