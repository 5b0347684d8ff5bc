// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "lucerna/core/parallel/atomic_add.h"
#include "lucerna/detectors.h"
#include "lucerna/geometry.h"

namespace lucerna {

/// Into how many parts a detector's cells are cut while light is counted, so that a peak or an edge can be
/// found between the grid's angles. Odd: a cell of the grid is a whole number of counted ones.
struct FarFieldParts {
  std::size_t c = 1, gamma = 1;
};

/// The fewest odd parts that make counted cells of at most 1 degree in C and 0.34 in gamma. One for tents
/// (whose shares are not a cell's), in C for a grid of one plane, and where it would make more than 16 M
/// cells.
FarFieldParts counted_parts(const FarFieldDetector& detector);

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

  /// The cells that light is counted in: each of the grid's cut into `counted_parts`.
  static FarFieldGrid counted(const FarFieldDetector& detector);

  LUCERNA_HD bool tent() const { return tent_; }
  /// Deals `quanta` to the four grid angles about `d`, by tents in C and in gamma; their sum is exact.
  /// Additions are atomic_add's.
  LUCERNA_HD void add_tent(const Direction& d, std::int64_t quanta, std::int64_t* bins) const;

 private:
  std::size_t c_count_, gamma_count_;
  double per_c_rad_, per_gamma_rad_;
  bool tent_;
};

LUCERNA_HD inline void FarFieldGrid::add_tent(const Direction& d, std::int64_t quanta,
                                              std::int64_t* bins) const {
  const TypeCAngles a = type_c_angles(d);
  const double u = a.c_rad * per_c_rad_, v = a.gamma_rad * per_gamma_rad_;
  const std::size_t c = std::min(static_cast<std::size_t>(u), c_count_ - 1);
  const std::size_t g = std::min(static_cast<std::size_t>(v), gamma_count_ - 2);
  const auto share = [](std::int64_t whole, double part) {
    return static_cast<std::int64_t>(std::llround(static_cast<double>(whole) * std::clamp(part, 0.0, 1.0)));
  };
  const std::int64_t next = share(quanta, u - static_cast<double>(c));
  const std::size_t columns[2] = {c, (c + 1) % c_count_};
  const std::int64_t parts[2] = {quanta - next, next};
  for (std::size_t k = 0; k < 2; ++k) {
    const std::int64_t outer = share(parts[k], v - static_cast<double>(g));
    std::int64_t* const bin = bins + columns[k] * gamma_count_ + g;
    atomic_add(bin, parts[k] - outer);
    atomic_add(bin + 1, outer);
  }
}

}  // namespace lucerna
