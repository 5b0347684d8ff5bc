// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/source/emitters/luminance_source.h"

namespace lucerna {

/// Lines past a source, drawn through disks about its focus: radii that hold half, 90 % and 99 % of the lines
/// of its rays, and one that holds all, take equal shares.
class LineDisks {
 public:
  struct Place {
    Vec3 point_mm;
    /// Density of the draw over the plane of the disks, 1/mm^2.
    double pdf_area = 0.0;
  };
  LineDisks(const PlacedSource& placed, const LuminanceSource& light);

  /// The place of (u, v) in the unit square on the disks across `line`. The largest is wider by `widest`:
  /// seen from near by, a ball covers more than a disk.
  Place place(double u, double v, const Direction& line, double widest = 1.0) const;
  /// In the luminaire frame.
  const Vec3& centre_mm() const { return centre_mm_; }
  /// Of a ball about the centre that all light leaves.
  double radius_mm() const { return radii_mm_.back(); }
  /// All but one in some thousand lines pass the centre within this.
  double guide_radius_mm() const { return rings_.back().radius_mm; }
  /// How bright lines that pass the centre at this distance or further are at most, as the square root of
  /// their mean over the brightest ring's: a part of a ring may be as bright as the middle. 0 beyond
  /// `guide_radius_mm`.
  double brightness(double miss_mm) const;

 private:
  /// Lines that pass the centre within a radius, and further away than the ring before.
  struct Ring {
    double radius_mm, brightness;
  };
  Vec3 centre_mm_;
  std::vector<double> radii_mm_;
  std::vector<Ring> rings_;
};

/// Of `samples` by mirrors, each source has so many directly.
std::uint64_t direct_samples(std::uint64_t samples);
/// The stream of a source's own samples under `seed`; the mirrors' has the seed itself.
std::uint64_t source_stream(std::uint64_t seed, std::size_t source);

}  // namespace lucerna
