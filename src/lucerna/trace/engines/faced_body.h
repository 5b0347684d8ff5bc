// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/optics/shapes/outline.h"
#include "lucerna/trace/engines/mirror_tracer.h"
#include "lucerna/trace/kernels/revolved_tree.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// The surface of a body with a height field at its top, in the body's frame: base and wall as cones, the
/// face exactly. A surface as through_solid takes it. Immutable and thread safe.
class FacedBody {
 public:
  /// As check_faced_outline takes them. Straight pieces leave the base's curve by `tolerance_mm` at most.
  FacedBody(std::span<const OutlinePoint> corners_mm, const std::shared_ptr<const HeightSurface>& face,
            double smooth_below_deg, double tolerance_mm);

  SurfaceHit first(const Ray& ray, double t_min_mm, double t_max_mm) const;
  Vec3 outward(const Vec3& point_mm, const SurfaceHit& hit) const;
  Vec3 smooth(const Vec3& point_mm, const SurfaceHit& hit) const;

  /// Of each part of the surface: the corner at which its side of the outline begins; the last one's is the
  /// outline's last, for the face.
  const std::vector<std::size_t>& corners() const { return corners_; }

 private:
  FacedBody(const std::vector<OutlineSide>& sides, std::shared_ptr<const HeightSurface> face,
            double radius_mm, std::size_t last_corner);

  /// The first place of the base or of the wall below the face's rim.
  SurfaceHit first_below(const Ray& ray, double t_min_mm, double t_max_mm) const;
  Vec3 face_normal(const Vec3& point_mm) const;

  std::shared_ptr<const HeightSurface> face_;
  RevolvedTree below_;
  std::vector<std::size_t> corners_;
  /// The parts that are wall and face, which come last.
  std::int32_t wall_, top_;
  MirrorTracer face_tracer_;
};

}  // namespace lucerna
