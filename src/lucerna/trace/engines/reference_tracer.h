// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/geometry.h"
#include "lucerna/optics/height_field/height_mipmap.h"
#include "lucerna/trace/kernels/curve_view.h"
#include "lucerna/trace/kernels/facet_mirror.h"
#include "lucerna/trace/kernels/lens_array_walk.h"

namespace lucerna {

/// Where a ray hits a mirror, in the mirror's frame.
struct MirrorHit {
  /// Distance along the ray.
  double t_mm = 0.0;
  /// The point, put a hair (far below the wavelength of light) off the surface on the side the ray came from,
  /// so that the reflected ray starts on the right side of it.
  Vec3 point_mm;
  /// Normal of the exact surface, towards +z.
  Direction normal;
  /// The ray came from the reflecting side.
  bool front = true;
};

/// The plain tracer that faster ones are checked against: a maximum-mipmap quadtree walked from the ray's
/// start, each hit refined on the exact surface to rounding, normals exact, all in double. A sign change of
/// (height of the ray - height of the surface) between shared cell borders cannot fall between cells, so the
/// surface is watertight; within a cell up to two crossings are found. Where the surface is convex, which
/// cells are told, a line has no more than that, and the walk ends. Swept curves (Reflector::curve),
/// facets and arrays of lenslets go to kernels of their own instead. Immutable and thread safe.
class ReferenceTracer {
 public:
  /// 2^levels cells a side; a hit does not depend on it but where a ray grazes the surface twice within one
  /// cell.
  explicit ReferenceTracer(const Reflector& reflector, int levels = 8);

  /// The first point in [0, infinity) where `ray` (in the mirror's frame) hits the mirror; nothing if it
  /// passes by or through the hole.
  std::optional<MirrorHit> first_hit(const Ray& ray) const;

  /// The hit of a ray that met a height field at distance `t_mm`, over (p.x, p.y), where it is `s`.
  MirrorHit hit_on(const SurfacePoint& s, const Vec3& p, double t_mm, bool front) const;

 private:
  std::optional<MirrorHit> first_hit_with_curve(const Ray& ray) const;
  std::optional<MirrorHit> first_hit_with_facets(const Ray& ray) const;
  std::optional<MirrorHit> first_hit_with_array(const Ray& ray) const;

  Reflector reflector_;
  std::optional<HeightMipmap> mipmap_;  ///< of height fields
  CurveView curve_{};                   ///< of swept curves; points into reflector_.curve
  std::optional<FacetMirror> facets_;   ///< of faceted surfaces
  /// Of arrays of lenslets; belongs to reflector_.
  const LensArraySurface* array_ = nullptr;
  double offset_mm_;
};

}  // namespace lucerna
