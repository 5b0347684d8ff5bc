// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/trace/backward/backward_scene.h"
#include "lucerna/trace/backward/source_lines.h"

namespace lucerna {

/// A place on a mirror that was drawn.
struct MirrorPlace {
  std::size_t mirror = 0;
  /// In the mirror's frame.
  double x_mm = 0.0, y_mm = 0.0;
  /// Density of the draw, 1/mm^2 of the aperture's plane.
  double pdf_plane = 0.0;
};

/// A place on a mirror's surface, in the luminaire frame.
struct MirrorPoint {
  const BackwardScene::Mirror* mirror = nullptr;
  /// A hair in front of the surface.
  Vec3 point_mm;
  /// Towards the front, longer than 1 by the surface's area over that of the aperture's plane.
  Vec3 area;
};

/// Nothing where the place is outside the aperture.
std::optional<MirrorPoint> mirror_point(const BackwardScene& scene, const MirrorPlace& place);

/// Chooses places on mirrors for light that leaves towards a cell of directions: nine tenths of them on the
/// patches that are seen to reflect a source there, by how bright it is there, with a margin for what they
/// turn within a patch and the cell, and a tenth anywhere, so that light by several reflections is found too.
class CellGuide {
 public:
  /// The place of (u, v) in the unit square. Neighbours in u are neighbours on the mirror.
  MirrorPlace place(double u, double v) const;
  /// No mirror sends light there.
  bool empty() const { return entries_.empty(); }

 private:
  friend class MirrorGuide;
  struct Entry {
    std::size_t mirror;
    Rectangle patch;
    double first = 0.0, probability = 0.0;
  };
  std::vector<Entry> entries_;
};

/// The mirrors of a scene cut into patches. Immutable and thread safe.
class MirrorGuide {
 public:
  MirrorGuide(const BackwardScene& scene, std::span<const LineDisks> sources);
  /// For light in directions within `radius_rad` of `centre`. About 2300 patches a mirror, some 20 ns each.
  CellGuide for_directions(const Direction& centre, double radius_rad) const;
  /// Whether all patches are further away than so many times their size; distance(centre) in mm.
  template <class Distance>
  bool further_than(double sizes, const Distance& distance_mm) const {
    for (const std::vector<Patch>& patches : mirrors_) {
      for (const Patch& p : patches) {
        const double size = std::max(p.region.x1_mm - p.region.x0_mm, p.region.y1_mm - p.region.y0_mm);
        if (p.on_mirror && !(distance_mm(p.centre_mm) > sizes * size * p.slope)) return false;
      }
    }
    return true;
  }
  /// For light towards places within `radius_mm` of a point instead.
  CellGuide for_point(const Vec3& point_mm, double radius_mm) const;

 private:
  struct Patch {
    Rectangle region;
    Vec3 centre_mm, normal;
    /// Area of the surface over that of the plane.
    double slope = 1.0;
    bool on_mirror = false;
  };
  struct Offset {
    Vec3 miss_mm;
    double along_mm = 0.0, weight = 0.0;
  };
  /// Where the light of a patch goes, by how much the directions differ, and a factor of its weight.
  struct Aim {
    Direction out;
    double spread_rad = 0.0, weight = 1.0;
  };
  template <class AimOf>
  CellGuide guide(const AimOf& aim_of) const;
  template <class AimOf>
  static std::vector<Offset> offsets(std::span<const Patch> patches, const LineDisks& source,
                                     const AimOf& aim_of);

  static Offset reach_of_patch(std::span<const Offset> off, std::size_t i);

  std::vector<std::vector<Patch>> mirrors_;
  /// Of each mirror: what its slope errors turn light by.
  std::vector<double> turn_rad_;
  std::vector<LineDisks> sources_;
};

}  // namespace lucerna
