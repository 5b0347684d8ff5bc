// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/far_field.h"

#include <cmath>

#include "lucerna/core/error.h"

namespace lucerna {

namespace {

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

FarFieldGrid::FarFieldGrid(const FarFieldDetector& detector)
    : c_count_(steps(detector.name, "c_step_deg", detector.c_step_deg, 360.0)),
      gamma_count_(steps(detector.name, "gamma_step_deg", detector.gamma_step_deg, 180.0) + 1),
      per_c_rad_(static_cast<double>(c_count_) / (2.0 * std::numbers::pi)),
      per_gamma_rad_(static_cast<double>(gamma_count_ - 1) / std::numbers::pi),
      tent_(detector.tent) {
  constexpr std::size_t kMostCells = std::size_t{1} << 24;
  if (size() > kMostCells) {
    throw InputError(
        fmt::format("detector '{}': {} cells, expected at most {}", detector.name, size(), kMostCells));
  }
}

}  // namespace lucerna
