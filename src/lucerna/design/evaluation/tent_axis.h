// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "lucerna/host_device.h"

namespace lucerna {

/// Cells along one coordinate of a window: `inner` equal ones over [low, low + inner * cell], and on either
/// side `outer` more that grow with their distance, so that few of them reach as far as light can go. The
/// cells' index is a continuous, increasing function of the coordinate; 0 is the outermost edge.
struct TentAxis {
  /// Beyond an edge of the window: k cells reach first * k + growth * k^2.
  struct Beyond {
    double first = 0.0, growth = 0.0;
  };

  double low = -1.0, cell = 1.0;
  int inner = 2, outer = 0;
  Beyond below, above;

  LUCERNA_HD int count() const { return inner + 2 * outer; }

  /// Index (a real number) of coordinate u, and its slope.
  LUCERNA_HD double index(double u, double& slope) const {
    const double s = (u - low) / cell;
    slope = 1.0 / cell;
    if (outer == 0 || (s >= 0.0 && s <= inner)) return s + outer;
    if (s < 0.0) return outer - cells_beyond(below, low - u, slope);
    return outer + inner + cells_beyond(above, u - (low + inner * cell), slope);
  }

  /// The same where tents have their centres in the middle of cells: the outermost two of grown cells are
  /// flat from their centres outwards, so that no light is lost at the end.
  LUCERNA_HD double tent_index(double u, double& slope) const {
    const double i = index(u, slope);
    if (outer == 0 || (i > 0.5 && i < count() - 0.5)) return i;
    slope = 0.0;
    return i <= 0.5 ? 0.5 : count() - 0.5;
  }

  /// The coordinate of an index, and its slope.
  LUCERNA_HD double coordinate(double index, double& slope) const {
    const double s = index - outer;
    slope = cell;
    if (outer == 0 || (s >= 0.0 && s <= inner)) return low + s * cell;
    const double k = s < 0.0 ? -s : s - inner;
    const Beyond& b = s < 0.0 ? below : above;
    slope = b.first + 2.0 * b.growth * k;
    const double distance = k * (b.first + b.growth * k);
    return s < 0.0 ? low - distance : low + inner * cell + distance;
  }

 private:
  LUCERNA_HD static double cells_beyond(const Beyond& b, double distance, double& slope) {
    const double root = std::sqrt(b.first * b.first + 4.0 * b.growth * distance);
    slope = 1.0 / root;
    return 2.0 * distance / (b.first + root);
  }
};

/// `inner` cells over [low, high] and `outer` on either side that reach to `far_low` and `far_high`. Where
/// what is beyond is narrower than that many cells, they are equal and narrower; growth is never negative.
TentAxis tent_axis(double low, double high, int inner, int outer, double far_low, double far_high);

}  // namespace lucerna
