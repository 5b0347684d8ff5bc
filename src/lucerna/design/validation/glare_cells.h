// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "lucerna/design/validation/box_error.h"
#include "lucerna/geometry.h"

namespace lucerna {

/// Cells with hard edges of about 5 degrees from a mirror's axis by 30 about it, fewer and wider ones near
/// the pole so that none is narrower than high; from an angle on to the opposite pole: where glare is looked
/// for. Immutable, thread safe.
class GlareCells {
 public:
  /// `beyond_deg`: above 0, at most 170.
  GlareCells(const Frame& world_from_mirror, double beyond_deg);

  std::size_t size() const { return rings_.back().first + rings_.back().sectors; }
  /// Adds light in a direction of the world to the cell that it is in, if it is in one.
  void add(const Vec3& direction, double flux, std::span<double> sums) const;
  /// The largest mean intensity over a cell, per unit of the emitted flux, in the light of at least two
  /// replicates (BoxSums::glare, or glare_direct), with that cell's error.
  Estimate brightest(std::span<const BoxSums> replicates,
                     std::vector<double> BoxSums::*light = &BoxSums::glare) const;

 private:
  struct Ring {
    std::size_t first, sectors;
    /// Of a cell.
    double measure_sr;
  };

  Frame mirror_from_world_;
  double beyond_deg_;
  std::vector<Ring> rings_;
};

}  // namespace lucerna
