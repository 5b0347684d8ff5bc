// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/random.h"
#include "lucerna/trace/kernels/body_kernel.h"
#include "lucerna/trace/kernels/cover_glass_kernel.h"
#include "lucerna/trace/kernels/revolved_kernel.h"
#include "lucerna/trace/kernels/scatter_kernel.h"

namespace lucerna {

// What light does at and in closed bodies of a clear medium; small functions that CPU and GPU share.

/// Amplitudes that a smooth boundary between two clear media reflects, of light whose field is perpendicular
/// (s) and parallel (p) to the plane of incidence.
struct Boundary {
  double s = 1.0, p = 1.0;
  /// Of the refracted ray with the normal; 0 where reflection is total.
  double cos_refracted = 0.0;

  /// Share of unpolarised light.
  LUCERNA_HD double reflectance() const { return 0.5 * (s * s + p * p); }
};

/// `ratio`: the index beyond the boundary over that before it, > 0. Fresnel's formulas (M. Born, E. Wolf,
/// "Principles of Optics", 7th ed., 1.5.2) and total reflection, whose phases are left out.
LUCERNA_HD inline Boundary boundary(double ratio, double cos_incidence) {
  const double c = cos_incidence < 1.0 ? cos_incidence : 1.0;
  if (ratio == 1.0) return {0.0, 0.0, c};
  const double squared = 1.0 - (1.0 - c * c) / (ratio * ratio);
  if (!(squared > 0.0) || !(c > 0.0)) return {};
  const double t = std::sqrt(squared);
  return {(c - ratio * t) / (c + ratio * t), (ratio * c - t) / (ratio * c + t), t};
}

/// The amplitudes' derivatives by the cosine of incidence `c`, with `t` the cosine beyond (not 0) and `ratio`
/// as `boundary` has it: of (c - ratio t) / (c + ratio t) and (ratio c - t) / (ratio c + t).
struct AmplitudeSlopes {
  double s = 0.0, p = 0.0;
};
LUCERNA_HD inline AmplitudeSlopes amplitude_slopes(double ratio, double c, double t) {
  const double dt = c / (ratio * ratio * t), both = 2.0 * ratio * (t - c * dt);
  return {both / ((c + ratio * t) * (c + ratio * t)), both / ((ratio * c + t) * (ratio * c + t))};
}

/// Snell's law for what `boundary` found; `normal` is unit and towards where the light comes from.
LUCERNA_HD inline Vec3 refracted(const Direction& d, const Direction& normal, double ratio,
                                 const Boundary& found) {
  const double c = -dot(d, normal);
  return (1.0 / ratio) * d.vec() + (c / ratio - found.cos_refracted) * normal.vec();
}

/// A clear medium as a kernel reads it.
struct MediumView {
  double index = 1.0, absorption_per_mm = 0.0;
};

/// Where a ray meets a clear body: the part of its surface, and where on it.
struct SurfaceHit {
  std::int32_t part = -1;  ///< none
  double t_mm = 0.0, u = 0.0, v = 0.0;
};

/// Lobes of a body's surface. `rough`: by parts of it, 1 where it has them; null: everywhere.
struct SolidFinish {
  SurfaceFinish lobes;
  const std::uint8_t* rough = nullptr;

  LUCERNA_HD bool scatters_at(const SurfaceHit& hit) const {
    return lobes.lobe_count > 0 && (rough == nullptr || rough[hit.part] != 0);
  }
};

/// A ray inside a body that starts on its surface is not stopped by what is nearer than this, mm.
inline constexpr double kSolidStart = 1e-6;
/// How often a ray meets the surface of one body before it is given up.
inline constexpr int kMaxInsideHits = 1000;

// A surface as through_solid takes it: `first` hit, the `outward` normal there (any length), and the `smooth`
// one (any length and side, 0 for none).

/// An outline that turns about z, in the body's frame.
struct RevolvedSurface {
  RevolvedView view;

  LUCERNA_HD SurfaceHit first(const Ray& ray, double t_min_mm, double t_max_mm) const {
    const SideHit hit = first_side(view, ray.origin_mm, ray.direction.vec(), t_min_mm, t_max_mm);
    return {hit.side, hit.t, hit.share, 0.0};
  }
  LUCERNA_HD Vec3 outward(const Vec3& point_mm, const SurfaceHit& hit) const {
    return cone_normal(view.sides[hit.part], point_mm);
  }
  LUCERNA_HD Vec3 smooth(const Vec3& point_mm, const SurfaceHit& hit) const {
    return curve_normal(view.sides[hit.part], hit.u, point_mm);
  }
};

/// Light on its way through a body: a ray, and the direction of its electric field. Unpolarised light is one
/// of two directions across each other, by chance.
struct PolarisedRay {
  Ray ray;
  Vec3 field;
};

/// Unit and across `d`, one of two by `u`, which is uniform in [0, 1).
LUCERNA_HD inline Vec3 any_field(const Direction& d, const Direction& normal, double u) {
  const Vec3 s = cross(d.vec(), normal.vec());
  // Along the normal every direction across is as good.
  const Vec3 across =
      dot(s, s) > 1e-24 ? s : cross(d.vec(), std::abs(d.x()) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  const Direction first = Direction::from(across);
  return u < 0.5 ? first.vec() : cross(d.vec(), first.vec());
}

/// Where a ray meets a body: the normal that counts, and what the boundary does.
struct BoundaryHit {
  Direction normal;
  double ratio = 1.0;
  Boundary found;
};

/// `outward` and `smooth`: as a surface has them.
LUCERNA_HD inline BoundaryHit boundary_hit(const Direction& d, const Vec3& outward, const Vec3& smooth,
                                           double ratio) {
  const BodyHit at = smoothed_hit(d, 0.0, 0, outward, smooth);
  const BoundaryHit found{at.normal, ratio, boundary(ratio, -dot(d, at.normal))};
  if (found.found.cos_refracted == 0.0) return found;
  // A smooth normal may send the refracted ray back to the side that it came from: the surface's own does
  // not.
  if (dot(refracted(d, at.normal, ratio, found.found), at.face.vec()) < 0.0) return found;
  return {at.face, ratio, boundary(ratio, -dot(d, at.face))};
}

/// Sends light on from a boundary at distance `t_mm`; true if it is reflected, which `u`, uniform in [0, 1),
/// decides.
LUCERNA_HD inline bool cross_boundary(PolarisedRay& light, const BoundaryHit& at, double t_mm, double u) {
  const Direction d = light.ray.direction;
  const Boundary& b = at.found;
  const Vec3 across = cross(d.vec(), at.normal.vec());
  const Vec3 s = dot(across, across) > 1e-24 ? Direction::from(across).vec() : light.field;
  const double of_s = dot(light.field, s), of_p = dot(light.field, cross(d.vec(), s));
  const double all = of_s * of_s + of_p * of_p;
  const double reflected_s = of_s * b.s, reflected_p = of_p * b.p;
  const bool reflected = u * all < reflected_s * reflected_s + reflected_p * reflected_p;
  const Direction out =
      Direction::from(reflected ? reflect(d, at.normal).vec() : refracted(d, at.normal, at.ratio, b));
  // What passes: 2 c / (c + n t) = 1 + s, and 2 c / (n c + t) = (1 + p) / n.
  const Vec3 field = reflected
                         ? reflected_s * s + reflected_p * cross(out.vec(), s)
                         : (of_s * (1.0 + b.s)) * s + (of_p * (1.0 + b.p) / at.ratio) * cross(out.vec(), s);
  light = {{light.ray.at(t_mm), out}, length(field) > 0.0 ? field / length(field) : s};
  return reflected;
}

/// Turns light that has just left a boundary by the body's lobes; what they take is unpolarised. What would
/// come out on the other side of the surface goes on as it was.
LUCERNA_HD inline void scatter_on(const SurfaceFinish& lobes, const Direction& normal, const Vec3& outward,
                                  double index, Rng& rng, PolarisedRay& light) {
  const Direction smooth = light.ray.direction;
  const bool same_side = dot(smooth, normal) > 0.0;
  const Direction side = same_side ? normal : Direction::from(-1.0 * normal.vec());
  const Direction out = scattered(lobes, side, smooth, index, rng);
  if (out == smooth || (dot(outward, out.vec()) > 0.0) != (dot(outward, smooth.vec()) > 0.0)) return;
  light.ray.direction = out;
  light.field = any_field(out, side, rng.uniform());
}

/// What decides what becomes of a ray in a body: the streams of cover glasses, since a ray meets one thing at
/// a time.
LUCERNA_HD inline Rng solid_random(const ReflectionKey& key) {
  return {key.sequence_seed, key.ray, 0x20000u + static_cast<std::uint32_t>(key.bounce)};
}

/// Follows a ray that met a clear body until it is outside again: reflected there, or after all its way
/// within. One branch is taken by chance at each boundary, with weight 1. Polarisation is kept within the
/// body. `visit` is called with every point of the surface on the way. What is given up has `lost` set.
template <class Surface, class Visit>
LUCERNA_HD inline GlassPassage through_solid(const Surface& surface, const MediumView& medium,
                                             const SolidFinish& finish, const Ray& ray, SurfaceHit hit,
                                             const ReflectionKey& key, const Visit& visit) {
  Rng rng = solid_random(key);
  GlassPassage out;
  out.throughput = 1.0;
  Vec3 outward = surface.outward(ray.at(hit.t_mm), hit);
  bool inside = dot(outward, ray.direction.vec()) > 0.0;
  out.transmitted = inside;
  PolarisedRay light{ray, any_field(ray.direction, Direction::from(outward), rng.uniform())};
  for (int i = 0; i < kMaxInsideHits; ++i) {
    if (inside) out.throughput *= std::exp(-medium.absorption_per_mm * hit.t_mm);
    const Direction d = light.ray.direction;
    const Vec3 point_mm = light.ray.at(hit.t_mm);
    const double u = rng.uniform();
    if ((dot(outward, d.vec()) > 0.0) != inside) {  // rounding: a surface that is behind the ray
      light.ray.origin_mm = point_mm;
    } else {
      const double ratio = inside ? 1.0 / medium.index : medium.index;
      const BoundaryHit at = boundary_hit(d, outward, surface.smooth(point_mm, hit), ratio);
      const bool reflected = cross_boundary(light, at, hit.t_mm, u);
      visit(point_mm);
      if (!reflected) {
        inside = !inside;
        out.transmitted = true;
      }
      if (finish.scatters_at(hit))
        scatter_on(finish.lobes, at.normal, outward, inside ? medium.index : 1.0, rng, light);
      if (!inside) {
        out.ray = light.ray;
        return out;
      }
    }
    hit = surface.first(light.ray, kSolidStart, 1e300);
    if (hit.part < 0) break;
    outward = surface.outward(light.ray.at(hit.t_mm), hit);
  }
  out.ray = light.ray;
  out.lost = true;
  return out;
}

}  // namespace lucerna
