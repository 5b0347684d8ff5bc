// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "lucerna/scene.h"

namespace lucerna {

/// Rays that are sent through triangles together, float32, mm. In their order neighbours are the nearer the
/// more there are: a mesh of a million triangles does not fit a cache.
inline constexpr std::size_t kMeshBatch = std::size_t{1} << 18;
struct MeshRays {
  alignas(64) float x[kMeshBatch], y[kMeshBatch], z[kMeshBatch];
  alignas(64) float dx[kMeshBatch], dy[kMeshBatch], dz[kMeshBatch];
};

/// Their first hits: distance, place on the triangle, which mesh (kNoMesh: none) and which of its triangles.
inline constexpr std::uint32_t kNoMesh = 0xFFFFFFFFu;
struct MeshHits {
  alignas(64) float t[kMeshBatch];
  /// Weights of the triangle's second and third corner.
  alignas(64) float u[kMeshBatch], v[kMeshBatch];
  alignas(64) std::uint32_t mesh[kMeshBatch], triangle[kMeshBatch];
};

/// Finds first hits of batches of rays with meshes. Immutable and thread safe.
class MeshHitFinder {
 public:
  virtual ~MeshHitFinder() = default;
  /// Of rays [0, n), in (0, infinity).
  virtual void first_hits(const MeshRays& rays, std::size_t n, MeshHits& hits) const = 0;
};

/// Do Embree's hits exist in this build?
bool has_embree();

/// Embree's; coordinates rounded to float32. Throws InputError without Embree.
std::unique_ptr<MeshHitFinder> embree_hits(const std::vector<Body>& meshes);
/// Those of the library's own tree (trace/kernels/triangle_bvh.h), one ray at a time in double; coordinates
/// rounded likewise. Some ten times slower.
std::unique_ptr<MeshHitFinder> tree_hits(const std::vector<Body>& meshes);

}  // namespace lucerna
