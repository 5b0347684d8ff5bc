// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace lucerna {

/// One line of a design's history.
struct FitRecord {
  int stage = 0, step = 0;
  std::uint64_t rays = 0;  ///< of this evaluation
  std::uint64_t total_rays = 0;
  int evaluations = 0;
  double error = 0.0, floor = 0.0;  ///< in the stage's bins
  double lambda = 0.0;
  bool accepted = true;
  double efficiency = 0.0;
  /// Of a search with several, the candidate; and the light in the target's rectangle.
  int candidate = 0;
  double in_rectangle = 0.0;
};

}  // namespace lucerna
