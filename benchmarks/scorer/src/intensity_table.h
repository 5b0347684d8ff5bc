// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "json_node.h"

namespace bench {

/// Intensities by C planes and gamma, bilinear between the nodes; 0 beyond the last gamma. Immutable; thread
/// safe.
class IntensityTable {
 public:
  /// Keys `c_step_deg`, `gamma_step_deg` and `rows`: a row a plane, from C0 on, its values from gamma 0 on.
  /// Throws InputError.
  explicit IntensityTable(const JsonNode& target);
  /// By direction cosines across the axis: u along C0, v along C270.
  double at(double u, double v) const;

 private:
  double c_step_deg_, gamma_step_deg_;
  std::vector<std::vector<double>> rows_;
};

}  // namespace bench
