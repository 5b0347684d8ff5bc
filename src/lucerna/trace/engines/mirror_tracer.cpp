// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/mirror_tracer.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "lucerna/optics/shapes/smooth_shape.h"
#include "lucerna/trace/kernels/hit_kernels.h"

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

void MirrorTracer::first_mm(const HitRays& rays, std::size_t n, double* t_mm) const {
  HitEnds ends;
  const HitKernels& kernels = best_hit_kernels();
  if (const auto* m = std::get_if<HitMirror<BsplineHitTable>>(&mirror_)) {
    kernels.bspline(*m, rays, n, ends);
  } else if (const auto* r = std::get_if<HitMirror<RevolutionHitTable>>(&mirror_)) {
    kernels.revolution(*r, rays, n, ends);
  } else {
    std::fill_n(ends.what, n, static_cast<std::int32_t>(kHitFailed));
  }
  for (std::size_t i = 0; i < n; ++i) {
    t_mm[i] = ends.what[i] == kHitNothing ? std::numeric_limits<double>::infinity() : ends.t[i];
    if (ends.what[i] != kHitFailed) continue;
    const Ray ray{{rays.x[i], rays.y[i], rays.z[i]},
                  Direction::from_unit({rays.dx[i], rays.dy[i], rays.dz[i]})};
    const auto hit = reference_.first_hit(ray);
    t_mm[i] = hit ? hit->t_mm : std::numeric_limits<double>::infinity();
  }
}

std::optional<MirrorHit> MirrorTracer::first_hit(const Ray& ray) const {
  const Found found = searched(ray);
  if (!found) return reference_.first_hit(ray);
  if (found->what == kHitNothing) return std::nullopt;
  const Vec3 p = ray.at(found->t_mm);
  return reference_.hit_on(surface_->at(p.x, p.y), p, found->t_mm, found->what == kHitFront);
}

}  // namespace lucerna
