// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/body_tracer.h"

#include "lucerna/core/io/error.h"

#if defined(LUCERNA_EMBREE)
#include "lucerna/trace/engines/embree_device.h"
#endif

namespace lucerna {

void check(const Body& body) {
  if (!body.mesh || body.mesh->triangles.empty())
    throw InputError(fmt::format("body '{}' has no triangles", body.name));
  if (!(body.smooth_below_deg >= 0.0 && body.smooth_below_deg <= 180.0)) {
    throw InputError(fmt::format("body '{}': smooth below {} degrees, expected 0 to 180", body.name,
                                 body.smooth_below_deg));
  }
  if (!(body.slope_error_mrad >= 0.0 && body.slope_error_mrad <= 1000.0)) {
    throw InputError(fmt::format("body '{}': slope_error_mrad = {}, expected 0 to 1000", body.name,
                                 body.slope_error_mrad));
  }
}

std::vector<Vec3> smooth_normals(const Body& body) {
  if (body.smooth_below_deg == 0.0) return {};
  std::vector<Vec3> normals = corner_normals(*body.mesh, body.smooth_below_deg);
  for (Vec3& n : normals) n = body.world_from_body.vector(n);
  return normals;
}

#if defined(LUCERNA_EMBREE)

struct BodyTracer::Device {
  EmbreeDevice device;
  /// What light straight from the source meets, and what all other light does (Debian's Embree has no ray
  /// masks).
  EmbreeScene direct{device}, returning{device};
};

BodyTracer::BodyTracer(const std::vector<Body>& bodies) : count_(bodies.size()) {
  if (bodies.empty()) return;
  device_ = std::make_unique<Device>();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    check(bodies[i]);
    corner_normals_.push_back(smooth_normals(bodies[i]));
    RTCGeometry g = embree_triangles(device_->device, bodies[i]);
    rtcAttachGeometryByID(device_->returning.get(), g, static_cast<unsigned>(i));
    if (!bodies[i].only_returning_light)
      rtcAttachGeometryByID(device_->direct.get(), g, static_cast<unsigned>(i));
    rtcReleaseGeometry(g);
  }
  for (RTCScene scene : {device_->direct.get(), device_->returning.get()}) {
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene);
  }
}

std::optional<BodyHit> BodyTracer::first_hit(const Ray& ray, double t_max_mm, bool returning) const {
  if (empty()) return std::nullopt;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit q{};
  q.ray.org_x = static_cast<float>(ray.origin_mm.x);
  q.ray.org_y = static_cast<float>(ray.origin_mm.y);
  q.ray.org_z = static_cast<float>(ray.origin_mm.z);
  q.ray.dir_x = static_cast<float>(ray.direction.x());
  q.ray.dir_y = static_cast<float>(ray.direction.y());
  q.ray.dir_z = static_cast<float>(ray.direction.z());
  q.ray.tnear = returning ? static_cast<float>(kBodyStart) : 0.0F;
  q.ray.tfar = static_cast<float>(t_max_mm);
  q.ray.mask = 0xFFFFFFFFU;
  q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1((returning ? device_->returning : device_->direct).get(), &context, &q);
  if (q.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const std::vector<Vec3>& corners = corner_normals_[q.hit.geomID];
  return body_hit(ray.direction, static_cast<double>(q.ray.tfar), q.hit.geomID,
                  {q.hit.Ng_x, q.hit.Ng_y, q.hit.Ng_z},
                  corners.empty() ? nullptr : &corners[3 * std::size_t{q.hit.primID}],
                  static_cast<double>(q.hit.u), static_cast<double>(q.hit.v));
}

#else

struct BodyTracer::Device {};

BodyTracer::BodyTracer(const std::vector<Body>& bodies) : count_(bodies.size()) {
  if (!bodies.empty()) throw InputError("the scene has bodies, and this program was built without Embree");
}

std::optional<BodyHit> BodyTracer::first_hit(const Ray&, double, bool) const { return std::nullopt; }

#endif

BodyTracer::~BodyTracer() = default;

}  // namespace lucerna
