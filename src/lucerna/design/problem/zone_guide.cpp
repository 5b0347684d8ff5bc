// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/zone_guide.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

namespace {

/// How far above a minimum, and below a maximum, the guide lies.
constexpr double kAbove = 1.15, kBelow = 0.85;
/// Places that stand for a zone, about.
constexpr double kGuidePlaces = 200.0;
/// Around a place the guide is level as far as its cell's corners, then falls off over so many cells, or over
/// this share of the way to the next place.
constexpr double kFlat = 0.75, kFadeCells = 1.5, kFadeShare = 0.6;
/// Longest way that is bridged between places, in degrees, and of a plane over its longer side.
constexpr double kMaxGap_deg = 15.0, kMaxGapShare = 0.25;
constexpr int kMapCells = 96;

double absolute_level(const TargetZone& zone) {
  const ZoneBound* min = zone.bound(true, ZoneReference::absolute);
  const ZoneBound* max = zone.bound(false, ZoneReference::absolute);
  if (min == nullptr) return 0.0;
  const double level = kAbove * min->value;
  return max == nullptr ? level : std::min(level, 0.5 * (min->value + max->value));
}

/// What each zone suggests; 0 where it has no minimum.
std::vector<double> levels_of(const std::vector<TargetZone>& zones) {
  std::vector<double> level;
  double sum = 0.0, count = 0.0;
  for (const TargetZone& zone : zones) {
    level.push_back(absolute_level(zone));
    sum += level.back();
    count += level.back() > 0.0 ? 1.0 : 0.0;
  }
  const double typical = count > 0.0 ? sum / count : 1.0;
  for (std::size_t z = 0; z < zones.size(); ++z) {
    if (level[z] > 0.0 || !zones[z].asks_for_light()) continue;
    const ZoneBound* share = zones[z].bound(true, ZoneReference::mean);
    const bool other = share != nullptr && share->mean_of != z;
    level[z] = other ? kAbove * share->value * std::max(level[share->mean_of], typical) : typical;
  }
  return level;
}

/// The guide as a function of a place: of a unit vector, or of a point of the plane.
class Guide {
 public:
  Guide(const ZoneCells& zones, double max_gap) : zones_(zones), hit_(zones.size(), 0.0) {
    const std::vector<double> level = levels_of(zones.zones());
    for (std::size_t z = 0; z < level.size(); ++z) {
      if (!(level[z] > 0.0)) continue;
      add_places(zones, z, level[z]);
    }
    for (Source& s : sources_) {
      double gap = max_gap;
      for (const Source& o : sources_) {
        if (const double d = distance(s.at, o.at); d > 1e-9) gap = std::min(gap, d);
      }
      s.flat = kFlat * s.cell;
      s.fade = std::max(kFadeCells * s.cell, kFadeShare * gap);
    }
  }

  double at(const Vec3& place, const Vec3& origin_mm, const Vec3& direction) {
    double value = 0.0;
    for (const Source& s : sources_) {
      const double off = std::max(0.0, distance(s.at, place) - s.flat) / s.fade;
      if (off < 3.0) value = std::max(value, s.level * std::exp(-off * off));
    }
    if (!(value > 0.0)) return 0.0;
    std::fill(hit_.begin(), hit_.end(), 0.0);
    zones_.add(origin_mm, direction, 1.0, hit_);
    for (std::size_t c = 0; c < hit_.size(); ++c) {
      if (hit_[c] == 0.0) continue;
      const TargetZone& zone = zones_.zones()[zones_.cells()[c].zone];
      if (const ZoneBound* max = zone.bound(false, ZoneReference::absolute)) {
        value = std::min(value, kBelow * max->value);
      }
    }
    return value;
  }

 private:
  struct Source {
    Vec3 at;
    double level, cell, flat = 0.0, fade = 1.0;
  };

  /// Degrees or mm.
  double distance(const Vec3& a, const Vec3& b) const {
    if (zones_.on_plane()) return length(a - b);
    return degrees(2.0 * std::asin(std::min(1.0, 0.5 * length(a - b))));
  }

  void add_places(const ZoneCells& zones, std::size_t z, double level) {
    const std::size_t first = zones.first(z), end = zones.first(z + 1);
    const auto every =
        static_cast<std::size_t>(std::max(1.0, std::ceil(static_cast<double>(end - first) / kGuidePlaces)));
    const double side = zones.zones()[z].cell * std::sqrt(static_cast<double>(every));
    for (std::size_t c = first; c < end; c += every) {
      const Ray ray = zones.ray_into(zones.cells()[c]);
      sources_.push_back({zones.on_plane() ? ray.at(1.0) : ray.direction.vec(), level, side});
    }
  }

  const ZoneCells& zones_;
  std::vector<Source> sources_;
  std::vector<double> hit_;
};

}  // namespace

IntensityDistribution guide_distribution(const ZoneCells& zones, FluxUnit unit) {
  IntensityDistribution out = uniform_distribution(1.0, 0.5, unit);
  Guide guide(zones, kMaxGap_deg);
  for (std::size_t c = 0; c < out.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < out.gamma_deg.size(); ++g) {
      const Vec3 d = direction_from_type_c({radians(out.c_deg[c]), radians(out.gamma_deg[g])}).vec();
      out.at(c, g) = guide.at(d, {}, d);
    }
  }
  return out;
}

IlluminanceMap guide_map(const ZoneCells& zones, double size_x_mm, double size_y_mm) {
  IlluminanceMap map{kMapCells, kMapCells, {}};
  Guide guide(zones, kMaxGapShare * std::max(size_x_mm, size_y_mm));
  const MeasuringCell all{
      0, {-0.5 * size_y_mm, 0.5 * size_y_mm}, {-0.5 * size_x_mm, 0.5 * size_x_mm}, size_x_mm * size_y_mm};
  for (int j = 0; j < kMapCells; ++j) {
    for (int i = 0; i < kMapCells; ++i) {
      const Ray ray = zones.ray_into(all, (j + 0.5) / kMapCells, (i + 0.5) / kMapCells);
      map.value.push_back(guide.at(ray.at(1.0), ray.origin_mm, ray.direction));
    }
  }
  return map;
}

}  // namespace lucerna
