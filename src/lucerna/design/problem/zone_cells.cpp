// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/zone_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lucerna {

namespace {

/// How much wider an interval of columns is at a row than as an angle seen from the source: 1 / this.
double shrink(ZoneCoordinates coordinates, double row) {
  if (coordinates == ZoneCoordinates::gamma_c) return std::sin(radians(row));
  if (coordinates == ZoneCoordinates::h_v) return std::cos(radians(row));
  return 1.0;
}

int pieces(double width, double cell) {
  return std::max(1, static_cast<int>(std::ceil(width / cell - 1e-9)));
}

/// Rows end where the sphere does.
ZoneRange row_range(const TargetZone& zone) {
  const double half = zone.row.width() > 0.0 ? 0.0 : 0.5 * zone.cell;
  ZoneRange rows{zone.row.low - half, zone.row.high + half};
  if (zone.coordinates == ZoneCoordinates::gamma_c) {
    rows = {std::max(rows.low, 0.0), std::min(rows.high, 180.0)};
  } else if (zone.coordinates == ZoneCoordinates::h_v) {
    rows = {std::max(rows.low, -90.0), std::min(rows.high, 90.0)};
  }
  return rows;
}

}  // namespace

ZoneCells::ZoneCells(std::vector<TargetZone> zones, const Direction& axis,
                     const std::optional<Frame>& world_from_plane)
    : zones_(std::move(zones)), forward_(axis.vec()), world_from_plane_(world_from_plane) {
  if (world_from_plane) plane_from_world_ = world_from_plane->inverse();
  const Vec3 vertical = std::abs(forward_.z) < 1.0 - 1e-9 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
  right_ = Direction::from(cross(forward_, vertical)).vec();
  up_ = cross(right_, forward_);
  for (const TargetZone& zone : zones_) {
    uses_gamma_c_ = uses_gamma_c_ || zone.coordinates == ZoneCoordinates::gamma_c;
    uses_h_v_ = uses_h_v_ || zone.coordinates == ZoneCoordinates::h_v;
    first_.push_back(cells_.size());
    add_zone(zone);
  }
  first_.push_back(cells_.size());
}

void ZoneCells::add_zone(const TargetZone& zone) {
  ZoneGrid grid;
  grid.row = row_range(zone);
  grid.column = {1e300, -1e300};
  const int n = pieces(grid.row.width(), zone.cell);
  for (int i = 0; i < n; ++i) {
    add_strip(zone, grid, grid.row.low + grid.row.width() * i / n,
              grid.row.low + grid.row.width() * (i + 1) / n);
  }
  grids_.push_back(std::move(grid));
}

void ZoneCells::add_strip(const TargetZone& zone, ZoneGrid& grid, double low, double high) {
  const double factor = std::max(shrink(zone.coordinates, 0.5 * (low + high)), 1e-6);
  ZoneRange columns = zone.column;
  if (!(columns.width() > 0.0)) {
    const bool pole = zone.coordinates == ZoneCoordinates::gamma_c && (low <= 0.0 || high >= 180.0);
    const double half = pole ? 180.0 : std::min(180.0, 0.5 * zone.cell / factor);
    columns = zone.coordinates == ZoneCoordinates::plane
                  ? ZoneRange{columns.low - 0.5 * zone.cell, columns.high + 0.5 * zone.cell}
                  : ZoneRange{columns.low - half, columns.high + half};
  }
  const bool point = !(zone.column.width() > 0.0);
  const int n = point ? 1 : pieces(columns.width() * factor, zone.cell);
  grid.strips.push_back({low, high, cells_.size(), static_cast<std::size_t>(n)});
  grid.column = {std::min(grid.column.low, columns.low), std::max(grid.column.high, columns.high)};
  for (int i = 0; i < n; ++i) {
    const ZoneRange row{low, high},
        column{columns.low + columns.width() * i / n, columns.low + columns.width() * (i + 1) / n};
    cells_.push_back({first_.size() - 1, row, column, measure(zone, row, column)});
  }
}

double ZoneCells::measure(const TargetZone& zone, const ZoneRange& row, const ZoneRange& column) const {
  switch (zone.coordinates) {
    case ZoneCoordinates::gamma_c:
      return radians(column.width()) * (std::cos(radians(row.low)) - std::cos(radians(row.high)));
    case ZoneCoordinates::h_v:
      return radians(column.width()) * (std::sin(radians(row.high)) - std::sin(radians(row.low)));
    case ZoneCoordinates::plane:
      return row.width() * column.width();
  }
  return 0.0;
}

ZoneCells::Place ZoneCells::place(ZoneCoordinates coordinates, const Vec3& origin_mm,
                                  const Vec3& direction) const {
  if (coordinates == ZoneCoordinates::plane) {
    const Vec3 d = plane_from_world_->vector(direction), o = plane_from_world_->point(origin_mm);
    if (!(d.z < 0.0 && o.z >= 0.0)) return {0.0, 0.0, false};
    const double t = -o.z / d.z;
    return {o.y + t * d.y, o.x + t * d.x};
  }
  if (coordinates == ZoneCoordinates::h_v) {
    const double v = std::clamp(dot(direction, up_), -1.0, 1.0);
    return {degrees(std::asin(v)), degrees(std::atan2(dot(direction, right_), dot(direction, forward_)))};
  }
  const TypeCAngles a = type_c_angles(Direction::from_unit(direction));
  return {degrees(a.gamma_rad), degrees(a.c_rad)};
}

void ZoneCells::add(const Vec3& origin_mm, const Vec3& direction, double flux, std::span<double> sums) const {
  Place by_gamma_c, by_h_v;
  if (uses_gamma_c_) by_gamma_c = place(ZoneCoordinates::gamma_c, origin_mm, direction);
  if (uses_h_v_) by_h_v = place(ZoneCoordinates::h_v, origin_mm, direction);
  if (on_plane()) by_gamma_c = place(ZoneCoordinates::plane, origin_mm, direction);
  for (std::size_t z = 0; z < zones_.size(); ++z) {
    const bool h_v = zones_[z].coordinates == ZoneCoordinates::h_v;
    Place p = h_v ? by_h_v : by_gamma_c;
    const ZoneGrid& grid = grids_[z];
    if (!p.exists || !(p.row >= grid.row.low && p.row < grid.row.high)) continue;
    if (!on_plane()) {  // the turn that columns are counted in
      while (p.column >= grid.column.low + 360.0) p.column -= 360.0;
      while (p.column < grid.column.low) p.column += 360.0;
    }
    const double rows = static_cast<double>(grid.strips.size()) / grid.row.width();
    const auto i = std::min(static_cast<std::size_t>((p.row - grid.row.low) * rows), grid.strips.size() - 1);
    const Strip& strip = grid.strips[i];
    const ZoneRange all{cells_[strip.first].column.low, cells_[strip.first + strip.count - 1].column.high};
    if (!(p.column >= all.low && p.column < all.high)) continue;
    const double columns = static_cast<double>(strip.count) / all.width();
    const auto k = std::min(static_cast<std::size_t>((p.column - all.low) * columns), strip.count - 1);
    sums[strip.first + k] += flux;
  }
}

Ray ZoneCells::ray_into(const MeasuringCell& cell, double row, double column) const {
  const double r = cell.row.low + row * cell.row.width(), c = cell.column.low + column * cell.column.width();
  switch (zones_[cell.zone].coordinates) {
    case ZoneCoordinates::gamma_c:
      return {{}, direction_from_type_c({radians(c), radians(r)})};
    case ZoneCoordinates::h_v: {
      const double h = radians(c), v = radians(r);
      const Vec3 level = std::cos(h) * forward_ + std::sin(h) * right_;
      return {{}, Direction::from(std::cos(v) * level + std::sin(v) * up_)};
    }
    case ZoneCoordinates::plane:
      break;
  }
  return {world_from_plane_->point({c, r, 1.0}), -Direction::from(world_from_plane_->ez())};
}

std::string ZoneCells::place_text(const MeasuringCell& cell) const {
  const double r = 0.5 * (cell.row.low + cell.row.high), c = 0.5 * (cell.column.low + cell.column.high);
  switch (zones_[cell.zone].coordinates) {
    case ZoneCoordinates::gamma_c:
      return fmt::format("C {:.4g}, gamma {:.4g} deg", std::fmod(c + 360.0, 360.0), r);
    case ZoneCoordinates::h_v:
      return fmt::format("h {:.4g}, v {:.4g} deg", c, r);
    case ZoneCoordinates::plane:
      return fmt::format("x {:.5g}, y {:.5g} mm", c, r);
  }
  return {};
}

}  // namespace lucerna
