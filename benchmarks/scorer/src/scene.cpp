// SPDX-License-Identifier: Apache-2.0
#include "scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace bench {

namespace {

/// Nearer hits than this share of the scene's size are the surface that the ray starts on.
constexpr double kLift = 1e-6;

}  // namespace

SurfaceScene::SurfaceScene(const std::vector<Part>& parts)
    : parts_(parts),
      device_(rtcNewDevice("threads=1")),
      scene_(device_ ? rtcNewScene(device_.get()) : nullptr) {
  if (!device_ || !scene_) throw std::runtime_error("Embree gives no device");
  if (rtcGetDeviceProperty(device_.get(), RTC_DEVICE_PROPERTY_FILTER_FUNCTION_SUPPORTED) == 0)
    throw std::runtime_error("this Embree was built without filter functions");
  for (unsigned i = 0; i < parts.size(); ++i) attach(parts[i], i);
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  rtcCommitScene(scene_.get());
  if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE)
    throw std::runtime_error("Embree cannot build the scene");
}

void SurfaceScene::attach(const Part& part, unsigned id) {
  const Triangles& mesh = part.surface->triangles();
  RTCGeometry g = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                              3 * sizeof(float), mesh.corners.size()));
  auto* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                               3 * sizeof(unsigned), mesh.triangles.size()));
  if (corners == nullptr || index == nullptr)
    throw std::runtime_error("Embree has no memory for the surfaces");
  for (const Vec3& p : mesh.corners) {
    for (const double x : {p.x, p.y, p.z}) {
      *corners++ = static_cast<float>(x);
      size_ = std::max(size_, std::abs(x));
    }
  }
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t k : t) *index++ = k;
  }
  rtcSetGeometryIntersectFilterFunction(g, &SurfaceScene::look_at);
  rtcCommitGeometry(g);
  rtcAttachGeometryByID(scene_.get(), g, id);
  rtcReleaseGeometry(g);
}

/// What Embree hands to `look_at` along one ray: a context is where it begins.
struct SurfaceScene::Search {
  RTCIntersectContext context;
  const SurfaceScene* scene;
  Vec3 origin, direction;
  PartHit nearest;
};

void SurfaceScene::look_at(const RTCFilterFunctionNArguments* args) {
  auto& search = *reinterpret_cast<Search*>(args->context);
  const RTCHit at = rtcGetHitFromHitN(args->hit, args->N, 0);
  const FlatHit flat{at.primID, RTCRayN_tfar(args->ray, args->N, 0), at.u, at.v};
  const Part& part = search.scene->parts_[at.geomID];
  Hit hit;
  if (part.surface->refine(search.origin, search.direction, flat, hit) && hit.t > kLift * search.scene->size_)
    search.nearest = {&part, hit};
  else
    args->valid[0] = 0;
}

SurfaceScene::PartHit SurfaceScene::first_hit(const Vec3& o, const Vec3& d) const {
  Search search{{}, this, o, d, {}};
  rtcInitIntersectContext(&search.context);
  RTCRayHit q{};
  q.ray.org_x = static_cast<float>(o.x);
  q.ray.org_y = static_cast<float>(o.y);
  q.ray.org_z = static_cast<float>(o.z);
  q.ray.dir_x = static_cast<float>(d.x);
  q.ray.dir_y = static_cast<float>(d.y);
  q.ray.dir_z = static_cast<float>(d.z);
  q.ray.tfar = std::numeric_limits<float>::infinity();
  q.ray.mask = 0xFFFFFFFFU;
  q.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_.get(), &search.context, &q);
  PartHit& found = search.nearest;
  if (found.part != nullptr && found.part->flip) {
    found.hit.normal = -found.hit.normal;
    found.hit.geometric = -found.hit.geometric;
  }
  return found;
}

}  // namespace bench
