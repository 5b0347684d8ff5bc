// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "lucerna/optics/shapes/outline.h"
#include "lucerna/trace/engines/mirror_tracer.h"
#include "lucerna/trace/kernels/revolved_tree.h"
#include "lucerna/trace/kernels/solid_kernel.h"
#include "lucerna/trace/kernels/solid_kernels.h"

namespace lucerna {

/// The surface of a body with a height field at its top, and at its bottom where it has one there, in the
/// body's frame: base and walls as cones, the faces exactly. A surface as through_solid takes it. Immutable
/// and thread safe.
class FacedBody {
 public:
  /// As check_faced_outline takes them; `bottom` is null for none. Straight pieces leave the base's curve by
  /// `tolerance_mm` at most.
  FacedBody(std::span<const OutlinePoint> corners_mm, const std::shared_ptr<const HeightSurface>& top,
            const std::shared_ptr<const HeightSurface>& bottom, double smooth_below_deg, double tolerance_mm);

  SurfaceHit first(const Ray& ray, double t_min_mm, double t_max_mm) const;
  Vec3 outward(const Vec3& point_mm, const SurfaceHit& hit) const;
  Vec3 smooth(const Vec3& point_mm, const SurfaceHit& hit) const;

  /// The same of many rays, as SolidFlight asks of a surface.
  void first(const SolidKernels& kernels, double t_min_mm, std::size_t n, SolidBatch& batch) const;
  void normals(const SolidKernels& kernels, std::size_t n, SolidBatch& batch) const;

  /// Of each part of the surface: the corner of FacedBase at which its side begins, of a face that of its lid
  /// or floor.
  const std::vector<std::size_t>& corners() const { return corners_; }

 private:
  /// A face, the wall that ends at its rim, and which parts of the surface they are.
  struct Face {
    Face(std::shared_ptr<const HeightSurface> height, double radius_mm, double up, std::int32_t wall,
         std::int32_t part);
    /// Along or against the outward side.
    Vec3 normal(const Vec3& point_mm) const;
    bool is_below(const Vec3& point_mm) const;
    /// Moves the rays of a batch to it that meet it before batch.t.
    void meet(double t_min_mm, std::size_t n, SolidBatch& batch) const;

    std::shared_ptr<const HeightSurface> height;
    MirrorTracer tracer;
    /// It is nowhere beyond these heights.
    HeightRange band;
    /// 1 where the outside is above, -1 where it is below.
    double up;
    std::int32_t wall, part;
  };

  FacedBody(const std::vector<OutlineSide>& sides, std::span<const OutlinePoint> corners_mm,
            const std::shared_ptr<const HeightSurface>& top,
            const std::shared_ptr<const HeightSurface>& bottom);

  /// The first place of the base, or of a wall below its face's rim.
  SurfaceHit first_below(const Ray& ray, double t_min_mm, double t_max_mm) const;
  const Face* face_of(std::int32_t part) const;

  RevolvedTree below_;
  std::vector<std::size_t> corners_;
  std::vector<Face> faces_;
};

}  // namespace lucerna
