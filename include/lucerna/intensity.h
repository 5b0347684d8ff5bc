// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lucerna/flux_unit.h"
#include "lucerna/geometry.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Luminous (cd) or radiant (W/sr) intensity over the full sphere on a CIE Type C grid, in the luminaire
/// frame of docs/concepts/frames-and-units.md: nadir (gamma 0) = -z, C0 = +x, C90 = +y. Always expanded:
/// symmetry is found when writing. Between grid angles the intensity is bilinear in (C, gamma); beyond the
/// first and last gamma it is zero.
struct IntensityDistribution {
  /// C planes, ascending, first 0, all < 360 (the plane at 360 is the first one again). One plane =
  /// rotational.
  std::vector<double> c_deg;
  /// gamma angles, ascending, within [0, 180], at least two.
  std::vector<double> gamma_deg;
  /// Intensity, plane after plane: `cd[c * gamma_deg.size() + g]`, never negative. W/sr when `unit` is watt.
  std::vector<double> cd;
  /// Lumen: values are cd; watt: W/sr.
  FluxUnit unit = FluxUnit::lumen;

  /// Value of plane `c` and angle `gamma_deg[g]`; indices are not checked.
  double& at(std::size_t c, std::size_t g) { return cd[c * gamma_deg.size() + g]; }
  /// The same, to read.
  double at(std::size_t c, std::size_t g) const { return cd[c * gamma_deg.size() + g]; }
};

/// What breaks the rules written at the fields above, as one sentence; empty if nothing does. O(values).
[[nodiscard]] std::string grid_fault(const IntensityDistribution& distribution);

/// A distribution of zeros on the given angles. Throws InputError naming the fault if the angles break the
/// rules.
[[nodiscard]] IntensityDistribution zero_distribution(std::vector<double> c_deg,
                                                      std::vector<double> gamma_deg,
                                                      FluxUnit unit = FluxUnit::lumen);

/// Equally spaced planes 0, step, ... < 360 and gammas 0, step, ..., 180. A step must divide 360 (or 180)
/// within 1e-9; otherwise InputError. c_step 0 or 360 gives one plane (rotational).
[[nodiscard]] IntensityDistribution uniform_distribution(double c_step_deg, double gamma_step_deg,
                                                         FluxUnit unit = FluxUnit::lumen);

/// Intensity at any C (any real number of degrees) and gamma in [0, 180]: bilinear, periodic in C, 0 beyond
/// the first and last gamma. O(log planes + log gammas), no allocation.
double intensity_at(const IntensityDistribution& distribution, double c_deg, double gamma_deg);

/// Intensity in a direction of the luminaire frame.
double intensity_in(const IntensityDistribution& distribution, const Direction& direction);

/// All values multiplied by `factor` (>= 0).
void scale(IntensityDistribution& distribution, double factor);

}  // namespace lucerna
#pragma GCC visibility pop
