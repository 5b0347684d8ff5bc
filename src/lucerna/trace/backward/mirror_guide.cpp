// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/backward/mirror_guide.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

/// Patches a side of a mirror's rectangle.
constexpr std::size_t kSide = 48;
/// Share of the draws that are spread over the whole of all mirrors.
constexpr double kAnywhere = 0.1;
/// What a patch turns is taken from its neighbours, to first order: a little more for the rest.
constexpr double kMargin = 1.3;
/// Slope errors of this many standard deviations are followed.
constexpr double kSlopeErrors = 2.5;
/// A point on a mirror is this share of its distance from the mirror's origin in front of it.
constexpr double kOffSurface = 1e-10;

}  // namespace

std::optional<MirrorPoint> mirror_point(const BackwardScene& scene, const MirrorPlace& place) {
  const BackwardScene::Mirror& mirror = scene.mirrors()[place.mirror];
  const Reflector& reflector = mirror.placed->reflector;
  if (!reflector.aperture.contains(place.x_mm, place.y_mm)) return std::nullopt;
  const SurfacePoint s = reflector.surface->at(place.x_mm, place.y_mm);
  const Frame& world_from_mirror = mirror.placed->world_from_reflector;
  const double off = kOffSurface * (1.0 + std::hypot(place.x_mm, place.y_mm) + std::abs(s.z_mm));
  return MirrorPoint{&mirror, world_from_mirror.point({place.x_mm, place.y_mm, s.z_mm + off}),
                     world_from_mirror.vector({-s.dzdx, -s.dzdy, 1.0})};
}

MirrorPlace CellGuide::place(double u, double v) const {
  const auto after = std::upper_bound(entries_.begin(), entries_.end(), u,
                                      [](double x, const Entry& e) { return x < e.first; });
  const Entry& e = *(after - 1);
  const double t = std::clamp((u - e.first) / e.probability, 0.0, 1.0);
  const double width = e.patch.x1_mm - e.patch.x0_mm, height = e.patch.y1_mm - e.patch.y0_mm;
  return {e.mirror, e.patch.x0_mm + t * width, e.patch.y0_mm + v * height, e.probability / (width * height)};
}

MirrorGuide::MirrorGuide(const BackwardScene& scene, std::span<const LineDisks> sources)
    : sources_(sources.begin(), sources.end()) {
  for (const BackwardScene::Mirror& m : scene.mirrors()) {
    const Aperture& aperture = m.placed->reflector.aperture;
    const Frame& world_from_mirror = m.placed->world_from_reflector;
    const Rectangle all = aperture.bounds();
    const double dx = (all.x1_mm - all.x0_mm) / kSide, dy = (all.y1_mm - all.y0_mm) / kSide;
    turn_rad_.push_back(kSlopeErrors * 2.0 * m.slope_error_rad);
    auto& patches = mirrors_.emplace_back();
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
      const double x = all.x0_mm + dx * static_cast<double>(i % kSide);
      const double y = all.y0_mm + dy * static_cast<double>(i / kSide);
      const Rectangle region{x, x + dx, y, y + dy};
      const SurfacePoint s = m.placed->reflector.surface->at(x + 0.5 * dx, y + 0.5 * dy);
      const Vec3 normal{-s.dzdx, -s.dzdy, 1.0};
      patches.push_back({region, world_from_mirror.point({x + 0.5 * dx, y + 0.5 * dy, s.z_mm}),
                         world_from_mirror.vector(normal / length(normal)), length(normal),
                         !aperture.misses(region)});
    }
  }
}

/// By how far the light that each patch sends has missed the source's centre.
template <class AimOf>
std::vector<MirrorGuide::Offset> MirrorGuide::offsets(std::span<const Patch> patches, const LineDisks& source,
                                                      const AimOf& aim_of) {
  std::vector<Offset> to(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Patch& p = patches[i];
    const Aim aim = aim_of(p);
    const double cosine = dot(aim.out.vec(), p.normal);
    const Vec3 back = 2.0 * cosine * p.normal - aim.out.vec();
    const Vec3 centre = source.centre_mm() - p.centre_mm;
    const double along = dot(centre, back);
    to[i] = {centre - along * back, along, cosine * p.slope * aim.weight};
  }
  return to;
}

/// What a patch may send, by itself and its neighbours: how near it may pass the source, whether the source
/// may be in front of it, and how much it may show of itself.
MirrorGuide::Offset MirrorGuide::reach_of_patch(std::span<const Offset> off, std::size_t i) {
  Offset reach = off[i];
  double turn[2] = {0.0, 0.0};
  const auto look = [&](bool there, std::size_t axis, std::size_t k) {
    if (!there) return;
    turn[axis] = std::max(turn[axis], 0.5 * length(off[k].miss_mm - off[i].miss_mm));
    reach.along_mm = std::max(reach.along_mm, off[k].along_mm);
    reach.weight = std::max(reach.weight, off[k].weight);
  };
  const std::size_t x = i % kSide, y = i / kSide;
  look(x > 0, 0, i - 1);
  look(x + 1 < kSide, 0, i + 1);
  look(y > 0, 1, i - kSide);
  look(y + 1 < kSide, 1, i + kSide);
  const double miss = length(off[i].miss_mm) - kMargin * (turn[0] + turn[1]);
  reach.miss_mm = {std::max(0.0, miss), 0.0, 0.0};
  return reach;
}

CellGuide MirrorGuide::for_directions(const Direction& centre, double radius_rad) const {
  const Aim aim{centre, radius_rad};
  return guide([&](const Patch&) { return aim; });
}

CellGuide MirrorGuide::for_point(const Vec3& point_mm, double radius_mm) const {
  return guide([&](const Patch& p) {
    const Vec3 to = point_mm - p.centre_mm;
    const double r = length(to);
    return Aim{Direction::from(to), radius_mm / r, 1.0 / (r * r)};
  });
}

template <class AimOf>
CellGuide MirrorGuide::guide(const AimOf& aim_of) const {
  CellGuide guide;
  double bright = 0.0, area = 0.0;
  std::vector<double> weights;
  for (std::size_t m = 0; m < mirrors_.size(); ++m) {
    const std::vector<Patch>& patches = mirrors_[m];
    std::vector<double> weight(patches.size(), 0.0);
    for (const LineDisks& source : sources_) {
      const std::vector<Offset> off = offsets(patches, source, aim_of);
      for (std::size_t i = 0; i < patches.size(); ++i) {
        if (!patches[i].on_mirror) continue;
        const Offset reach = reach_of_patch(off, i);
        if (!(reach.weight > 0.0 && reach.along_mm > -source.guide_radius_mm())) continue;
        const double spread_mm = (aim_of(patches[i]).spread_rad + turn_rad_[m]) * std::abs(off[i].along_mm);
        weight[i] = std::max(weight[i], reach.weight * source.brightness(reach.miss_mm.x - spread_mm));
      }
    }
    for (std::size_t i = 0; i < patches.size(); ++i) {
      if (!patches[i].on_mirror) continue;
      const Rectangle& r = patches[i].region;
      const double plane = (r.x1_mm - r.x0_mm) * (r.y1_mm - r.y0_mm);
      guide.entries_.push_back({m, r, 0.0, plane});
      weights.push_back(weight[i] * plane);
      area += plane;
      bright += weights.back();
    }
  }
  const double anywhere = bright > 0.0 ? kAnywhere : 1.0;
  double first = 0.0;
  for (std::size_t k = 0; k < guide.entries_.size(); ++k) {
    CellGuide::Entry& e = guide.entries_[k];
    e.probability =
        anywhere * e.probability / area + (bright > 0.0 ? (1.0 - kAnywhere) * weights[k] / bright : 0.0);
    e.first = first;
    first += e.probability;
  }
  return guide;
}

}  // namespace lucerna
