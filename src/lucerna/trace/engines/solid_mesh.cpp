// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solid_meshes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/mesh.h"
#include "lucerna/trace/engines/body_tracer.h"

#if defined(LUCERNA_EMBREE)
#include "lucerna/trace/engines/embree_device.h"
#else
#include "lucerna/trace/kernels/triangle_bvh.h"
#endif

namespace lucerna {

namespace {

/// Six times the volume; below 0 where triangles are clockwise seen from outside.
double signed_volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles)
    sum += dot(mesh.vertices_mm[t[0]], cross(mesh.vertices_mm[t[1]], mesh.vertices_mm[t[2]]));
  return sum;
}

/// As float holds it, which the trees look at.
Vec3 rounded(const Vec3& p) {
  const auto single = [](double x) { return static_cast<double>(static_cast<float>(x)); };
  return {single(p.x), single(p.y), single(p.z)};
}

}  // namespace

#if defined(LUCERNA_EMBREE)

namespace {

/// Embree's own rays start so far before the place that is asked for, mm: where they begin within rounding of
/// a triangle, it is found, and its distance in double decides.
constexpr double kBefore_mm = 1e-3;

/// What decides of a triangle that Embree found.
struct Query {
  RTCIntersectContext context;  // first: Embree gives it back
  const Ray* ray;
  const Vec3* corners_mm;  ///< of all triangles
  double t_min_mm, t_max_mm;
};

/// How far away the plane of a triangle is, where that can be told; else what Embree says.
double distance_mm(const Ray& ray, const Vec3* corner_mm, double embree_mm) {
  const Vec3 n = cross(corner_mm[1] - corner_mm[0], corner_mm[2] - corner_mm[0]);
  const double t = dot(n, corner_mm[0] - ray.origin_mm) / dot(n, ray.direction.vec());
  return std::abs(t - embree_mm) < kBefore_mm ? t : embree_mm;
}

/// Embree asks it of every triangle that its ray meets: those before t_min or beyond t_max are passed.
void refuse_beyond(const RTCFilterFunctionNArguments* args) {
  const auto& query = *reinterpret_cast<const Query*>(args->context);
  const auto& first_corner = *static_cast<const std::size_t*>(args->geometryUserPtr);
  const RTCRay& ray = *reinterpret_cast<const RTCRay*>(args->ray);
  const RTCHit& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  const double t = distance_mm(*query.ray, query.corners_mm + first_corner + 3 * std::size_t{hit.primID},
                               static_cast<double>(ray.tfar) + query.t_min_mm - kBefore_mm);
  if (!(t > query.t_min_mm && t < query.t_max_mm)) args->valid[0] = 0;
}

}  // namespace

struct SolidMeshes::Finder {
  // One thread: the tree, and what is hit where two triangles meet, is the same in every run.
  EmbreeDevice device{"threads=1"};
  EmbreeScene scene{device};
  std::vector<std::size_t> first_corners;
};

SolidMeshes::SolidMeshes(const std::vector<Body>& bodies) {
  auto finder = std::make_unique<Finder>();
  finder->first_corners.reserve(bodies.size());  // Embree keeps their addresses
  for (const Body& body : bodies) {
    finder->first_corners.push_back(corners_mm_.size());
    add(body);
    RTCGeometry g = embree_triangles(finder->device, body);
    rtcSetGeometryUserData(g, &finder->first_corners.back());
    rtcSetGeometryIntersectFilterFunction(g, refuse_beyond);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(finder->scene.get(), g, static_cast<unsigned>(bodies_.size() - 1));
    rtcReleaseGeometry(g);
  }
  rtcSetSceneFlags(finder->scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcCommitScene(finder->scene.get());
  finder_ = std::move(finder);
}

SurfaceHit SolidMeshes::first(const Ray& ray, double t_min_mm, double t_max_mm) const {
  Query query{{}, &ray, corners_mm_.data(), t_min_mm, t_max_mm};
  rtcInitIntersectContext(&query.context);
  const Vec3 from_mm = ray.at(t_min_mm - kBefore_mm);
  RTCRayHit q{};
  q.ray.org_x = static_cast<float>(from_mm.x);
  q.ray.org_y = static_cast<float>(from_mm.y);
  q.ray.org_z = static_cast<float>(from_mm.z);
  q.ray.dir_x = static_cast<float>(ray.direction.x());
  q.ray.dir_y = static_cast<float>(ray.direction.y());
  q.ray.dir_z = static_cast<float>(ray.direction.z());
  q.ray.tfar = static_cast<float>(std::min(t_max_mm - t_min_mm + 2.0 * kBefore_mm, 1e30));
  q.ray.mask = 0xFFFFFFFFU;
  q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(finder_->scene.get(), &query.context, &q);
  if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  const std::int32_t part = bodies_[q.hit.geomID].first_part + static_cast<std::int32_t>(q.hit.primID);
  const double t_mm = distance_mm(ray, &corners_mm_[3 * static_cast<std::size_t>(part)],
                                  static_cast<double>(q.ray.tfar) + t_min_mm - kBefore_mm);
  return {part, t_mm, static_cast<double>(q.hit.u), static_cast<double>(q.hit.v)};
}

#else

struct SolidMeshes::Finder {
  TriangleBvh tree;
};

SolidMeshes::SolidMeshes(const std::vector<Body>& bodies) {
  for (const Body& body : bodies) add(body);
  finder_ = std::make_unique<const Finder>(Finder{TriangleBvh(bodies, true)});
}

SurfaceHit SolidMeshes::first(const Ray& ray, double t_min_mm, double t_max_mm) const {
  const TriangleHit hit =
      first_triangle(finder_->tree.view(), ray.origin_mm, ray.direction.vec(), t_min_mm, t_max_mm);
  if (hit.triangle < 0) return {};
  const TreeTriangle& found = finder_->tree.triangles()[static_cast<std::size_t>(hit.triangle)];
  return {bodies_[found.body].first_part + static_cast<std::int32_t>(found.number), hit.t, hit.u, hit.v};
}

#endif

SolidMeshes::~SolidMeshes() = default;

void SolidMeshes::add(const Body& body) {
  Placed placed{static_cast<std::int32_t>(corners_mm_.size() / 3),
                signed_volume(*body.mesh) < 0.0 ? -1.0 : 1.0, smooth_normals(body)};
  for (const auto& triangle : body.mesh->triangles) {
    for (const std::uint32_t k : triangle)
      corners_mm_.push_back(rounded(body.world_from_body.point(body.mesh->vertices_mm[k])));
  }
  bodies_.push_back(std::move(placed));
}

Vec3 SolidMeshes::outward(const Vec3&, const SurfaceHit& hit) const {
  const Vec3* const k = &corners_mm_[3 * static_cast<std::size_t>(hit.part)];
  return bodies_[body_of(hit.part)].sense * cross(k[1] - k[0], k[2] - k[0]);
}

Vec3 SolidMeshes::smooth(const Vec3&, const SurfaceHit& hit) const {
  const Placed& body = bodies_[body_of(hit.part)];
  if (body.corner_normals.empty()) return {};
  return blended_normal(&body.corner_normals[3 * static_cast<std::size_t>(hit.part - body.first_part)], hit.u,
                        hit.v);
}

std::size_t SolidMeshes::body_of(std::int32_t part) const {
  const auto after = std::upper_bound(bodies_.begin(), bodies_.end(), part,
                                      [](std::int32_t p, const Placed& body) { return p < body.first_part; });
  return static_cast<std::size_t>(after - bodies_.begin()) - 1;
}

}  // namespace lucerna
