// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/target_zone.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace lucerna {

namespace {

/// Side of a measuring cell where the project says nothing, and the share of a plane zone's shorter side.
constexpr double kCell_deg = 1.0;
constexpr int kCellsAcross = 10;
/// Cells of one zone at most.
constexpr double kMaxCells = 20000;

ZoneRange read_range(TomlReader& zone, const char* key) {
  const auto values = zone.number_or_numbers(key);
  if (!values) zone.fail(key, "is missing: a number or [low, high]");
  if (values->empty() || values->size() > 2) {
    zone.fail(key, fmt::format("found {} numbers, expected one or two", values->size()));
  }
  const ZoneRange range{values->front(), values->back()};
  if (values->size() == 2 && !(range.high > range.low)) {
    zone.fail(key, fmt::format("found [{}, {}], an empty range; expected the second above the first",
                               range.low, range.high));
  }
  return range;
}

void read_region(TomlReader& zone, bool plane, TargetZone& out) {
  const bool h_v = zone.has("h_deg") || zone.has("v_deg");
  const bool gamma_c = zone.has("gamma_deg") || zone.has("c_deg");
  const bool mm = zone.has("x_mm") || zone.has("y_mm");
  if (plane && (h_v || gamma_c)) zone.fail(h_v ? "h_deg" : "gamma_deg", "belongs to a target of directions");
  if (!plane && mm) zone.fail("x_mm", "belongs to a target with kind = \"plane\"");
  if (h_v && gamma_c)
    zone.fail("gamma_deg", "is given together with h_deg or v_deg; expected one kind of angles");
  if (plane) {
    out.coordinates = ZoneCoordinates::plane;
    out.column = read_range(zone, "x_mm");
    out.row = read_range(zone, "y_mm");
  } else if (h_v) {
    out.coordinates = ZoneCoordinates::h_v;
    out.column = read_range(zone, "h_deg");
    out.row = read_range(zone, "v_deg");
  } else {
    out.row = read_range(zone, "gamma_deg");
    out.column = read_range(zone, "c_deg");
    if (out.column.width() > 360.0) {
      zone.fail("c_deg",
                fmt::format("found a range of {} degrees, expected at most 360", out.column.width()));
    }
  }
}

void read_cell(TomlReader& zone, TargetZone& out) {
  const bool plane = out.coordinates == ZoneCoordinates::plane;
  const char *key = plane ? "cell_mm" : "cell_deg", *other = plane ? "cell_deg" : "cell_mm";
  if (zone.has(other)) zone.fail(other, fmt::format("expected {}", key));
  const auto given = zone.number(key);
  double side = kCell_deg;
  if (plane) {
    const double shorter = std::min(out.row.width(), out.column.width());
    const double longer = std::max(out.row.width(), out.column.width());
    side = (shorter > 0.0 ? shorter : longer) / kCellsAcross;
    if (!given && !(side > 0.0)) zone.fail(key, "is missing: a point needs the side of its measuring cell");
  }
  out.cell = given.value_or(side);
  const double cells =
      std::max(1.0, out.row.width() / out.cell) * std::max(1.0, out.column.width() / out.cell);
  if (cells > kMaxCells) {
    zone.fail(key, fmt::format("= {} makes {:.0f} measuring cells of this zone, expected at most {:.0f}",
                               out.cell, cells, kMaxCells));
  }
}

void read_absolute(TomlReader& zone, double source_flux, TargetZone& out) {
  struct Key {
    const char *min, *max;
    bool plane;
    double unit;
  };
  const bool plane = out.coordinates == ZoneCoordinates::plane;
  const std::array<Key, 3> keys{{{"min_cd", "max_cd", false, 1.0},
                                 {"min_cd_per_klm", "max_cd_per_klm", false, 1e-3 * source_flux},
                                 {"min_lx", "max_lx", true, 1.0}}};
  for (const Key& k : keys) {
    for (const char* key : {k.min, k.max}) {
      const bool is_min = key == k.min;
      const auto value = zone.number(key);
      if (!value) continue;
      if (k.plane != plane) {
        zone.fail(key, plane ? "belongs to directions; a plane's zones have min_lx and max_lx"
                             : "belongs to a plane; zones of directions have min_cd and max_cd");
      }
      for (const ZoneBound& b : out.bounds) {
        if (b.is_min == is_min)
          zone.fail(key, fmt::format("is given together with {}; expected one of them", b.key));
      }
      out.bounds.push_back({key, is_min, *value * k.unit});
    }
  }
}

/// A bound that is a multiple of some mean, or of the brightest cell.
void read_relative(TomlReader& zone, std::size_t number, TargetZone& out) {
  const bool plane = out.coordinates == ZoneCoordinates::plane;
  for (const char* key : {"min_uo", "min_ul"}) {
    const auto value = zone.number(key);
    if (!value) continue;
    if (!plane) zone.fail(key, "is a uniformity of illuminance; expected a target with kind = \"plane\"");
    const bool along_line = std::string_view(key) == "min_ul";
    if (along_line && out.row.width() > 0.0 && out.column.width() > 0.0) {
      zone.fail(key, "is a uniformity along a line; expected one number for x_mm or for y_mm");
    }
    out.bounds.push_back(
        {key, true, *value, along_line ? ZoneReference::brightest : ZoneReference::mean, number});
  }
  for (const char* key : {"min_of_mean", "max_of_mean"}) {
    const auto value = zone.number(key);
    if (!value) continue;
    const bool is_min = std::string_view(key) == "min_of_mean";
    out.bounds.push_back({key, is_min, *value, ZoneReference::mean, number});
  }
}

void check_band(const TomlReader& reader, const TargetZone& zone) {
  if (zone.bounds.empty()) {
    reader.fail("name", fmt::format("zone '{}' has no bounds: expected min_{}, max_{} or another bound",
                                    zone.name, zone.coordinates == ZoneCoordinates::plane ? "lx" : "cd",
                                    zone.coordinates == ZoneCoordinates::plane ? "lx" : "cd"));
  }
  for (const ZoneReference reference : {ZoneReference::absolute, ZoneReference::mean}) {
    const ZoneBound *min = zone.bound(true, reference), *max = zone.bound(false, reference);
    if (min != nullptr && max != nullptr && !(min->value < max->value)) {
      reader.fail(min->key, fmt::format("{} is not below {}: found {:g} and {:g}", min->key, max->key,
                                        min->value, max->value));
    }
  }
}

/// The zones that `mean_of` names.
void join_means(std::vector<TomlReader>& readers, std::vector<TargetZone>& zones) {
  for (std::size_t i = 0; i < zones.size(); ++i) {
    const auto name = readers[i].text("mean_of");
    bool used = false;
    for (ZoneBound& b : zones[i].bounds) {
      if (b.key != "min_of_mean" && b.key != "max_of_mean") continue;
      if (!name) readers[i].fail(b.key, "needs mean_of, the name of the zone that the mean is of");
      const auto found =
          std::find_if(zones.begin(), zones.end(), [&](const TargetZone& z) { return z.name == *name; });
      if (found == zones.end()) {
        readers[i].fail("mean_of", fmt::format("found '{}', expected the name of a zone", *name));
      }
      b.mean_of = static_cast<std::size_t>(found - zones.begin());
      used = true;
    }
    if (name && !used) readers[i].fail("mean_of", "belongs to min_of_mean or max_of_mean");
    readers[i].finish();
  }
}

}  // namespace

const ZoneBound* TargetZone::bound(bool is_min, ZoneReference reference) const {
  for (const ZoneBound& b : bounds) {
    if (b.is_min == is_min && b.reference == reference) return &b;
  }
  return nullptr;
}

bool TargetZone::asks_for_light() const {
  return std::any_of(bounds.begin(), bounds.end(), [](const ZoneBound& b) { return b.is_min; });
}

std::vector<TargetZone> read_zones(TomlReader& target, bool plane, double source_flux) {
  std::vector<TomlReader> readers = target.tables("zone");
  std::vector<TargetZone> zones;
  for (TomlReader& reader : readers) {
    TargetZone zone;
    zone.name = reader.text("name").value_or(fmt::format("zone {}", zones.size() + 1));
    for (const TargetZone& z : zones) {
      if (z.name == zone.name) reader.fail("name", fmt::format("'{}' is the name of another zone", z.name));
    }
    read_region(reader, plane, zone);
    read_cell(reader, zone);
    read_absolute(reader, source_flux, zone);
    read_relative(reader, zones.size(), zone);
    zones.push_back(std::move(zone));
  }
  join_means(readers, zones);
  for (std::size_t i = 0; i < zones.size(); ++i) check_band(readers[i], zones[i]);
  return zones;
}

}  // namespace lucerna
