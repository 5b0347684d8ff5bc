// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/design/problem/target_zone.h"
#include "lucerna/geometry.h"

namespace lucerna {

/// One place of a zone where light is measured: a cell with hard edges.
struct MeasuringCell {
  std::size_t zone = 0;
  ZoneRange row, column;
  /// Solid angle in sr, or area in mm2.
  double measure = 0.0;
};

/// The zones of a target cut into measuring cells: strips of one coordinate, each cut along the other into
/// cells about as wide as high (C and h by the sine or cosine of the row). A point is one cell around it. The
/// mean intensity (or illuminance) over a cell is what its bounds are about, in the fit and in the
/// validation. Immutable and thread safe.
class ZoneCells {
 public:
  /// `axis`: what h and v are about. `world_from_plane`: the frame of a plane target.
  ZoneCells(std::vector<TargetZone> zones, const Direction& axis,
            const std::optional<Frame>& world_from_plane);

  const std::vector<TargetZone>& zones() const { return zones_; }
  const std::vector<MeasuringCell>& cells() const { return cells_; }
  std::size_t size() const { return cells_.size(); }
  /// Cells [first(zone), first(zone + 1)).
  std::size_t first(std::size_t zone) const { return first_[zone]; }
  bool on_plane() const { return plane_from_world_.has_value(); }
  /// What flux over a cell's measure is multiplied by: 1, or mm2 in a m2 for lx from lm/mm2.
  double unit() const { return on_plane() ? kMm2PerM2 : 1.0; }

  /// Adds `flux` to the sums of all cells that a ray of the luminaire frame falls into by its last leg.
  void add(const Vec3& origin_mm, const Vec3& direction, double flux, std::span<double> sums) const;

  /// A ray of the luminaire frame that falls onto a place of a cell: `row` and `column` from 0 to 1 across.
  Ray ray_into(const MeasuringCell& cell, double row, double column) const;
  /// The same of the middle.
  Ray ray_into(const MeasuringCell& cell) const { return ray_into(cell, 0.5, 0.5); }

  /// "h -10 deg, v 5 deg": the middle of a cell.
  std::string place_text(const MeasuringCell& cell) const;

 private:
  struct Strip {
    double low, high;
    std::size_t first, count;
  };
  struct ZoneGrid {
    ZoneRange row, column;  ///< of all cells
    std::vector<Strip> strips;
  };
  struct Place {
    double row = 0.0, column = 0.0;
    bool exists = true;
  };

  void add_zone(const TargetZone& zone);
  void add_strip(const TargetZone& zone, ZoneGrid& grid, double low, double high);
  double measure(const TargetZone& zone, const ZoneRange& row, const ZoneRange& column) const;
  Place place(ZoneCoordinates coordinates, const Vec3& origin_mm, const Vec3& direction) const;

  std::vector<TargetZone> zones_;
  std::vector<ZoneGrid> grids_;
  std::vector<std::size_t> first_;
  std::vector<MeasuringCell> cells_;
  Vec3 forward_, up_, right_;
  std::optional<Frame> plane_from_world_, world_from_plane_;
  bool uses_gamma_c_ = false, uses_h_v_ = false;
};

}  // namespace lucerna
