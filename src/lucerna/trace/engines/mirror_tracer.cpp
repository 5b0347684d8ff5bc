// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/mirror_tracer.h"

#include <type_traits>

#include "lucerna/optics/shapes/smooth_shape.h"

namespace lucerna {

MirrorTracer::MirrorTracer(const Reflector& reflector, int levels)
    : surface_(reflector.surface), reference_(reflector, levels) {
  if (const auto* s = dynamic_cast<const SmoothSurface<BsplineShape>*>(surface_.get()))
    mirror_ = hit_mirror(s->shape().view(), reflector.aperture);
  if (const auto* s = dynamic_cast<const SmoothSurface<RevolutionShape>*>(surface_.get()))
    mirror_ = hit_mirror(s->shape().view(), reflector.aperture);
}

MirrorTracer::Found MirrorTracer::searched(const Ray& ray) const {
  const auto search = [&](const auto& mirror) -> Found {
    if constexpr (std::is_same_v<decltype(mirror), const std::monostate&>) {
      return std::nullopt;
    } else {
      const HitEnd found = search_first(mirror, ray.origin_mm, ray.direction.vec(), false, 0.0);
      return found.what == kHitFailed ? std::nullopt : Found(found);
    }
  };
  return std::visit(search, mirror_);
}

std::optional<double> MirrorTracer::first_mm(const Ray& ray) const {
  if (const Found found = searched(ray))
    return found->what == kHitNothing ? std::nullopt : std::optional(found->t_mm);
  const auto hit = reference_.first_hit(ray);
  return hit ? std::optional(hit->t_mm) : std::nullopt;
}

std::optional<MirrorHit> MirrorTracer::first_hit(const Ray& ray) const {
  const Found found = searched(ray);
  if (!found) return reference_.first_hit(ray);
  if (found->what == kHitNothing) return std::nullopt;
  const Vec3 p = ray.at(found->t_mm);
  return reference_.hit_on(surface_->at(p.x, p.y), p, found->t_mm, found->what == kHitFront);
}

}  // namespace lucerna
