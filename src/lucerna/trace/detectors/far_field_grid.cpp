// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/detectors/far_field_grid.h"

#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr std::size_t kMaxFarFieldCells = std::size_t{1} << 24;
/// A local fit over a beam of 3 degrees spans nine such gammas. Finer cells in C, 1 degree wide at the
/// horizon, would cost memory and time that narrow beams so far from the axis are not worth.
constexpr double kCountedC_deg = 1.0, kCountedGamma_deg = 0.34;

std::size_t odd_parts(double step_deg, double widest_deg) {
  const auto n = static_cast<std::size_t>(std::ceil(step_deg / widest_deg - 1e-9));
  return n | std::size_t{1};
}

std::size_t steps(const std::string& name, const char* key, double step_deg, double whole_deg) {
  const double n = std::round(whole_deg / step_deg);
  if (!(step_deg > 0.0 && step_deg <= whole_deg && n <= 1e6 &&
        std::abs(n * step_deg - whole_deg) < 1e-9 * whole_deg)) {
    throw InputError(fmt::format("detector '{}': {} = {}, expected a number that divides {} degrees evenly",
                                 name, key, step_deg, whole_deg));
  }
  return static_cast<std::size_t>(n);
}

}  // namespace

FarFieldParts counted_parts(const FarFieldDetector& detector) {
  const FarFieldGrid grid(detector);
  if (detector.tent) return {};
  const FarFieldParts parts{grid.c_count() == 1 ? 1 : odd_parts(detector.c_step_deg, kCountedC_deg),
                            odd_parts(detector.gamma_step_deg, kCountedGamma_deg)};
  const std::size_t cells = grid.c_count() * parts.c * ((grid.gamma_count() - 1) * parts.gamma + 1);
  return cells > kMaxFarFieldCells ? FarFieldParts{} : parts;
}

FarFieldGrid FarFieldGrid::counted(const FarFieldDetector& detector) {
  const FarFieldParts parts = counted_parts(detector);
  FarFieldDetector fine = detector;
  fine.c_step_deg /= static_cast<double>(parts.c);
  fine.gamma_step_deg /= static_cast<double>(parts.gamma);
  return FarFieldGrid(fine);
}

FarFieldGrid::FarFieldGrid(const FarFieldDetector& detector)
    : c_count_(steps(detector.name, "c_step_deg", detector.c_step_deg, 360.0)),
      gamma_count_(steps(detector.name, "gamma_step_deg", detector.gamma_step_deg, 180.0) + 1),
      per_c_rad_(static_cast<double>(c_count_) / (2.0 * std::numbers::pi)),
      per_gamma_rad_(static_cast<double>(gamma_count_ - 1) / std::numbers::pi),
      tent_(detector.tent) {
  if (size() > kMaxFarFieldCells) {
    throw InputError(fmt::format("detector '{}': {} cells, expected at most {}", detector.name, size(),
                                 kMaxFarFieldCells));
  }
}

}  // namespace lucerna
