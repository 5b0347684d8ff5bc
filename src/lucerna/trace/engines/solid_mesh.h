// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// The triangles of closed bodies, in the luminaire frame, as a surface that through_solid takes. By Embree
/// where it is built with it, which is several times as fast, else by a TriangleBvh. Places are computed in
/// double either way, of corners that are rounded to float. Immutable and thread safe.
class SolidMeshes {
 public:
  explicit SolidMeshes(const std::vector<Body>& bodies);
  ~SolidMeshes();
  SolidMeshes(const SolidMeshes&) = delete;
  SolidMeshes& operator=(const SolidMeshes&) = delete;

  /// The first triangle in (t_min_mm, t_max_mm).
  SurfaceHit first(const Ray& ray, double t_min_mm, double t_max_mm) const;
  Vec3 outward(const Vec3& point_mm, const SurfaceHit& hit) const;
  Vec3 smooth(const Vec3& point_mm, const SurfaceHit& hit) const;

  /// Number of the body that part of the surface belongs to.
  std::size_t body_of(std::int32_t part) const;

 private:
  /// How triangles are found.
  struct Finder;

  struct Placed {
    /// The parts of the surface that are its triangles begin here.
    std::int32_t first_part;
    /// 1 where triangles are counter-clockwise seen from outside, else -1.
    double sense;
    /// Three a triangle; empty for flat triangles.
    std::vector<Vec3> corner_normals;
  };

  void add(const Body& body);

  std::vector<Placed> bodies_;
  /// Three a triangle.
  std::vector<Vec3> corners_mm_;
  std::unique_ptr<const Finder> finder_;
};

}  // namespace lucerna
