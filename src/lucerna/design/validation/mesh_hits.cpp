// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/mesh_hits.h"

#include <limits>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/kernels/triangle_bvh.h"

#if defined(LUCERNA_EMBREE)
#include "lucerna/trace/engines/embree_device.h"
#endif

namespace lucerna {

namespace {

class TreeHits final : public MeshHitFinder {
 public:
  explicit TreeHits(const std::vector<Body>& meshes) : tree_(meshes, true) {}

  void first_hits(const MeshRays& rays, std::size_t n, MeshHits& hits) const override {
    const TriangleBvhView view = tree_.view();
    for (std::size_t i = 0; i < n; ++i) {
      const auto wide = [](float a, float b, float c) {
        return Vec3{static_cast<double>(a), static_cast<double>(b), static_cast<double>(c)};
      };
      const TriangleHit hit =
          first_triangle(view, wide(rays.x[i], rays.y[i], rays.z[i]),
                         wide(rays.dx[i], rays.dy[i], rays.dz[i]), 0.0, std::numeric_limits<float>::max());
      hits.mesh[i] = kNoMesh;
      if (hit.triangle < 0) continue;
      const TreeTriangle& k = view.triangles[hit.triangle];
      hits.t[i] = static_cast<float>(hit.t);
      hits.u[i] = static_cast<float>(hit.u);
      hits.v[i] = static_cast<float>(hit.v);
      hits.mesh[i] = k.body;
      hits.triangle[i] = k.number;
    }
  }

 private:
  TriangleBvh tree_;
};

#if defined(LUCERNA_EMBREE)

class EmbreeHits final : public MeshHitFinder {
 public:
  explicit EmbreeHits(const std::vector<Body>& meshes) {
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      if (meshes[i].mesh->triangles.empty()) continue;
      RTCGeometry g = embree_triangles(device_, meshes[i]);
      rtcAttachGeometryByID(scene_.get(), g, static_cast<unsigned>(i));
      rtcReleaseGeometry(g);
    }
    // Robust: no ray passes between two triangles that share an edge.
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_.get());
  }

  void first_hits(const MeshRays& rays, std::size_t n, MeshHits& hits) const override {
    // One ray at a time: on rays in the order of their places, packets of 8 take half as long again.
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    for (std::size_t i = 0; i < n; ++i) {
      RTCRayHit q;
      q.ray.org_x = rays.x[i];
      q.ray.org_y = rays.y[i];
      q.ray.org_z = rays.z[i];
      q.ray.dir_x = rays.dx[i];
      q.ray.dir_y = rays.dy[i];
      q.ray.dir_z = rays.dz[i];
      q.ray.tnear = 0.0F;
      q.ray.tfar = std::numeric_limits<float>::max();
      q.ray.time = 0.0F;
      q.ray.mask = 0xFFFFFFFFU;
      q.ray.flags = 0;
      q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene_.get(), &context, &q);
      hits.t[i] = q.ray.tfar;
      hits.u[i] = q.hit.u;
      hits.v[i] = q.hit.v;
      hits.mesh[i] = q.hit.geomID == RTC_INVALID_GEOMETRY_ID ? kNoMesh : q.hit.geomID;
      hits.triangle[i] = q.hit.primID;
    }
  }

 private:
  /// An eighth faster with a million triangles.
  EmbreeDevice device_{"hugepages=1"};
  EmbreeScene scene_{device_};
};

#endif

}  // namespace

#if defined(LUCERNA_EMBREE)
bool has_embree() { return true; }
std::unique_ptr<MeshHitFinder> embree_hits(const std::vector<Body>& meshes) {
  return std::make_unique<EmbreeHits>(meshes);
}
#else
bool has_embree() { return false; }
std::unique_ptr<MeshHitFinder> embree_hits(const std::vector<Body>&) {
  throw InputError("this program was built without Embree");
}
#endif

std::unique_ptr<MeshHitFinder> tree_hits(const std::vector<Body>& meshes) {
  return std::make_unique<TreeHits>(meshes);
}

}  // namespace lucerna
