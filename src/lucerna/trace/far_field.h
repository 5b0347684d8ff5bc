// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "lucerna/core/direction.h"

namespace lucerna {

/// A far-field detector: all light that leaves, by direction, on a CIE Type C grid in the luminaire frame.
struct FarFieldDetector {
  std::string name = "far-field";
  /// Must divide 360 and 180 evenly.
  double c_step_deg = 5.0;
  double gamma_step_deg = 1.0;
  /// A ray counts for its four neighbours in proportion to nearness, not for the nearest alone: smooth curves
  /// from few rays, edges a step wider.
  bool tent = false;
  friend bool operator==(const FarFieldDetector&, const FarFieldDetector&) = default;
};

/// The bins of a FarFieldDetector: cells centred on the grid's angles. Cell (c, g) spans c_step about c *
/// c_step and gamma_step about g * gamma_step; the cells of the first and last g are half as high, and each C
/// has its own. Numbered plane after plane: c * gamma_count + g.
class FarFieldGrid {
 public:
  /// Throws InputError if the steps do not divide 360 and 180 degrees to 1e-9, or make more than 16 M cells.
  explicit FarFieldGrid(const FarFieldDetector& detector);

  std::size_t c_count() const { return c_count_; }
  std::size_t gamma_count() const { return gamma_count_; }
  std::size_t size() const { return c_count_ * gamma_count_; }

  std::size_t cell(const Direction& d) const {
    const TypeCAngles a = type_c_angles(d);
    std::size_t c = static_cast<std::size_t>(a.c_rad * per_c_rad_ + 0.5);
    if (c >= c_count_) c = 0;
    std::size_t g = static_cast<std::size_t>(a.gamma_rad * per_gamma_rad_ + 0.5);
    if (g >= gamma_count_) g = gamma_count_ - 1;
    return c * gamma_count_ + g;
  }

  bool tent() const { return tent_; }
  /// Deals `units` to the four grid angles about `d`, by tents in C and in gamma; their sum is exact.
  void add_tent(const Direction& d, std::int64_t units, std::int64_t* bins) const;

 private:
  std::size_t c_count_, gamma_count_;
  double per_c_rad_, per_gamma_rad_;
  bool tent_;
};

}  // namespace lucerna
