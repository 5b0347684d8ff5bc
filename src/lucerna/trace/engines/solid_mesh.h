// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// The triangles of a closed body, in its frame, as a surface that through_solid takes; parts are its
/// triangles. By Embree where it is built with it, which is several times as fast, else by a TriangleBvh.
/// Corners are rounded to float as seen from the middle of the body, wherever that is; places are computed in
/// double. Immutable and thread safe.
class SolidMesh {
 public:
  /// Normals change steadily across triangles that meet at less than `smooth_below_deg`.
  SolidMesh(const std::shared_ptr<const Mesh>& mesh, double smooth_below_deg);
  ~SolidMesh();
  SolidMesh(const SolidMesh&) = delete;
  SolidMesh& operator=(const SolidMesh&) = delete;

  /// The first triangle in (t_min_mm, t_max_mm).
  SurfaceHit first(const Ray& ray, double t_min_mm, double t_max_mm) const;
  Vec3 outward(const Vec3& point_mm, const SurfaceHit& hit) const;
  Vec3 smooth(const Vec3& point_mm, const SurfaceHit& hit) const;

 private:
  /// How triangles are found.
  struct Finder;

  Vec3 centre_mm_;
  double reach_mm_ = 0.0;  ///< of all corners from there
  /// 1 where triangles are counter-clockwise seen from outside, else -1.
  double sense_ = 1.0;
  /// Three a triangle, from the centre.
  std::vector<Vec3> corners_mm_;
  /// Likewise; empty for flat triangles.
  std::vector<Vec3> corner_normals_;
  std::unique_ptr<const Finder> finder_;
};

}  // namespace lucerna
