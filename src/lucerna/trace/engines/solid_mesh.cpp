// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solid_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "lucerna/mesh.h"
#include "lucerna/optics/mesh/mesh_shells.h"
#include "lucerna/trace/engines/body_tracer.h"

#if defined(LUCERNA_EMBREE)
#include "lucerna/trace/engines/embree_device.h"
#else
#include "lucerna/trace/kernels/triangle_bvh.h"
#endif

namespace lucerna {

namespace {

/// As float holds it, which the trees look at.
Vec3 rounded(const Vec3& p) {
  const auto single = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  return {single(p.x), single(p.y), single(p.z)};
}

/// The middle of the box about a mesh.
Vec3 middle_of(const Mesh& mesh) {
  Vec3 low = mesh.vertices_mm.front(), high = low;
  for (const Vec3& v : mesh.vertices_mm) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  return 0.5 * (low + high);
}

/// A mesh as a body whose own origin is elsewhere.
Body seen_from(const Vec3& centre_mm, const std::shared_ptr<const Mesh>& mesh, double smooth_below_deg) {
  Body body;
  body.mesh = mesh;
  body.world_from_body = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, -centre_mm);
  body.smooth_below_deg = smooth_below_deg;
  return body;
}

}  // namespace

#if defined(LUCERNA_EMBREE)

namespace {

/// Embree's rays start so far before the place that is asked for, mm: a triangle within rounding of it is
/// found, and its distance in double decides.
constexpr double kBefore_mm = 1e-3;

/// What decides of a triangle that Embree found.
struct Query {
  RTCIntersectContext context;  // first: Embree gives it back
  const Ray* ray;
  const Vec3* corners_mm;
  /// Of Embree's own ray, and what is asked for.
  double start_mm, t_min_mm, t_max_mm;

  /// How far away the plane of a triangle is, where that can be told; else what Embree says.
  double distance_mm(unsigned triangle, float embree_mm) const {
    const Vec3* const k = corners_mm + 3 * std::size_t{triangle};
    const Vec3 n = cross(k[1] - k[0], k[2] - k[0]);
    const double t = dot(n, k[0] - ray->origin_mm) / dot(n, ray->direction.vec());
    const double found = start_mm + static_cast<double>(embree_mm);
    return std::abs(t - found) < kBefore_mm ? t : found;
  }
};

/// Embree asks it of every triangle that its ray meets: those that are not in (t_min, t_max) are passed.
void refuse_beyond(const RTCFilterFunctionNArguments* args) {
  const auto& query = *reinterpret_cast<const Query*>(args->context);
  const auto& ray = *reinterpret_cast<const RTCRay*>(args->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  const double t = query.distance_mm(hit.primID, ray.tfar);
  if (!(t > query.t_min_mm && t < query.t_max_mm)) args->valid[0] = 0;
}

}  // namespace

struct SolidMesh::Finder {
  explicit Finder(const Body& body) {
    RTCGeometry g = embree_triangles(device, body);
    rtcSetGeometryIntersectFilterFunction(g, refuse_beyond);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(scene.get(), g, 0);
    rtcReleaseGeometry(g);
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene.get());
  }

  /// `ray` is seen from the centre; its way begins at `start_mm`, which is near the body.
  SurfaceHit first(const Ray& ray, const std::vector<Vec3>& corners_mm, double start_mm, double t_min_mm,
                   double t_max_mm) const {
    start_mm -= kBefore_mm;
    Query query{{}, &ray, corners_mm.data(), start_mm, t_min_mm, t_max_mm};
    rtcInitIntersectContext(&query.context);
    const Vec3 from_mm = ray.at(start_mm);
    RTCRayHit q{};
    q.ray.org_x = static_cast<float>(from_mm.x);
    q.ray.org_y = static_cast<float>(from_mm.y);
    q.ray.org_z = static_cast<float>(from_mm.z);
    q.ray.dir_x = static_cast<float>(ray.direction.x());
    q.ray.dir_y = static_cast<float>(ray.direction.y());
    q.ray.dir_z = static_cast<float>(ray.direction.z());
    q.ray.tfar = static_cast<float>(std::min(t_max_mm - start_mm + kBefore_mm, 1e30));
    q.ray.mask = 0xFFFFFFFFU;
    q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene.get(), &query.context, &q);
    if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {static_cast<std::int32_t>(q.hit.primID), query.distance_mm(q.hit.primID, q.ray.tfar),
            static_cast<double>(q.hit.u), static_cast<double>(q.hit.v)};
  }

  // One thread: the tree, and what is hit where two triangles meet, is the same in every run.
  EmbreeDevice device{"threads=1"};
  EmbreeScene scene{device};
};

#else

struct SolidMesh::Finder {
  explicit Finder(const Body& body) : tree({body}, true) {}

  SurfaceHit first(const Ray& ray, const std::vector<Vec3>&, double start_mm, double t_min_mm,
                   double t_max_mm) const {
    const TriangleHit hit = first_triangle(tree.view(), ray.at(start_mm), ray.direction.vec(),
                                           t_min_mm - start_mm, t_max_mm - start_mm);
    if (hit.triangle < 0) return {};
    const std::uint32_t number = tree.triangles()[static_cast<std::size_t>(hit.triangle)].number;
    return {static_cast<std::int32_t>(number), hit.t + start_mm, hit.u, hit.v};
  }

  TriangleBvh tree;
};

#endif

SolidMesh::SolidMesh(const std::shared_ptr<const Mesh>& mesh, double smooth_below_deg)
    : centre_mm_(middle_of(*mesh)), sense_(signed_volume(*mesh) < 0.0 ? -1.0 : 1.0) {
  const Body body = seen_from(centre_mm_, mesh, smooth_below_deg);
  corner_normals_ = smooth_normals(body);
  for (const auto& triangle : mesh->triangles) {
    for (const std::uint32_t k : triangle) {
      corners_mm_.push_back(rounded(mesh->vertices_mm[k] - centre_mm_));
      reach_mm_ = std::max(reach_mm_, length(corners_mm_.back()));
    }
  }
  finder_ = std::make_unique<const Finder>(body);
}

SolidMesh::~SolidMesh() = default;

SurfaceHit SolidMesh::first(const Ray& ray, double t_min_mm, double t_max_mm) const {
  const Ray own{ray.origin_mm - centre_mm_, ray.direction};
  // No farther away than the body is large: what is far has few digits in float.
  const double nearest_mm = -dot(own.origin_mm, own.direction.vec());
  const double start_mm = std::max(t_min_mm, nearest_mm - 1.01 * reach_mm_);
  return finder_->first(own, corners_mm_, start_mm, t_min_mm, t_max_mm);
}

Vec3 SolidMesh::outward(const Vec3&, const SurfaceHit& hit) const {
  const Vec3* const k = &corners_mm_[3 * static_cast<std::size_t>(hit.part)];
  return sense_ * cross(k[1] - k[0], k[2] - k[0]);
}

Vec3 SolidMesh::smooth(const Vec3&, const SurfaceHit& hit) const {
  if (corner_normals_.empty()) return {};
  return blended_normal(&corner_normals_[3 * static_cast<std::size_t>(hit.part)], hit.u, hit.v);
}

}  // namespace lucerna
