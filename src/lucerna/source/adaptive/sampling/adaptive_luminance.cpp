// SPDX-License-Identifier: Apache-2.0
// AdaptiveModel as a LuminanceSource.
#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"

namespace lucerna {

namespace {

double farthest(const TreeBox& box, std::size_t d) {
  return std::max(std::abs(box.low[d]), std::abs(box.high[d]));
}

/// Distance from the support's origin (with a dome: from its centre) within which every line of the box
/// passes.
double reach_mm(const Support& s, const TreeBox& box) {
  if (s.dome.exists()) return s.dome.radius_mm;
  const bool squared =
      s.kind == SupportKind::disk || (s.kind == SupportKind::focal && s.map == PolarMap::polar);
  if (squared) return std::sqrt(2.0 * farthest(box, 0));
  switch (s.kind) {
    case SupportKind::sphere:
      return s.radius_mm;
    case SupportKind::cylinder:
      return std::hypot(s.radius_mm, s.half_size_mm.z);
    case SupportKind::box:
      return length(s.half_size_mm);
    default:
      return std::hypot(farthest(box, 0), farthest(box, 1));
  }
}

Vec3 centre_of(const Support& s) {
  return s.dome.exists() ? s.dome.centre_mm : s.world_from_support.origin_mm();
}

/// Where start_on puts the ray's start, as a distance along it.
double start_on_surface(const BoundingSurface& surface, const Ray& ray) {
  if (const auto t = surface.exit_distance_mm(ray)) return *t;
  return dot(surface.world_from_surface.origin_mm() - ray.origin_mm, ray.direction.vec());
}

}  // namespace

void AdaptiveModel::add_light_on(const Ray& ray, std::vector<LineLight>& to) const {
  LUCERNA_CHECK(has_etendue_, "luminance of a model without etendue, {} layers", data_.layers.size());
  if (data_.surface.kind != SurfaceKind::none) {
    const double pdf = density(ray);
    if (pdf > 0.0) to.push_back({start_on_surface(data_.surface, ray), pdf});
    return;
  }
  for (const Place& place : places_) {
    const auto p = place.support->to_chart(ray);
    if (!p || p->chart != place.chart) continue;
    const double share = place.share / place.support->etendue_ratio();
    double pdf = 0.0;
    for (const TreeLookup& tree : place.trees) pdf += share * tree.density(p->c);
    const Vec3 start = place.support->from_chart(*p).origin_mm;
    if (pdf > 0.0) to.push_back({dot(start - ray.origin_mm, ray.direction.vec()), pdf});
  }
}

LightBound AdaptiveModel::light_bound() const {
  LightBound all{centre_of(data_.layers.front().support), 0.0};
  for (const AdaptiveLayer& layer : data_.layers) {
    const double off = length(centre_of(layer.support) - all.centre_mm);
    for (const AdaptiveChart& chart : layer.charts)
      all.radius_mm = std::max(all.radius_mm, off + reach_mm(layer.support, chart.box));
  }
  return all;
}

}  // namespace lucerna
