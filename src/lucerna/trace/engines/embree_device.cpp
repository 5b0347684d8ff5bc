// SPDX-License-Identifier: Apache-2.0
#if defined(LUCERNA_EMBREE)
#include "lucerna/trace/engines/embree_device.h"

#include <cstdint>

#include "lucerna/core/io/error.h"

namespace lucerna {

// Constructors are not inlined: their names have to stand in the stacks that the thread sanitizer shows.
__attribute__((noinline)) EmbreeDevice::EmbreeDevice(const char* config) : device_(rtcNewDevice(config)) {
  if (device_ == nullptr) throw InputError("Embree gives no device", ErrorCause::unsupported);
}

EmbreeDevice::~EmbreeDevice() { rtcReleaseDevice(device_); }

__attribute__((noinline)) EmbreeScene::EmbreeScene(const EmbreeDevice& device)
    : scene_(rtcNewScene(device.get())) {
  if (scene_ == nullptr) throw InputError("Embree gives no scene", ErrorCause::unsupported);
}

EmbreeScene::~EmbreeScene() { rtcReleaseScene(scene_); }

RTCGeometry embree_triangles(const EmbreeDevice& device, const Body& body) {
  const Mesh& mesh = *body.mesh;
  RTCGeometry g = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* v = static_cast<float*>(
      rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.vertices_mm.size()));
  auto* t = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
  if (v == nullptr || t == nullptr) {
    rtcReleaseGeometry(g);
    throw InputError(fmt::format("the mesh of '{}' does not fit the memory", body.name));
  }
  for (const Vec3& p : mesh.vertices_mm) {
    const Vec3 w = body.world_from_body.point(p);
    for (const double x : {w.x, w.y, w.z}) *v++ = static_cast<float>(x);
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t k : triangle) *t++ = k;
  }
  rtcCommitGeometry(g);
  return g;
}

}  // namespace lucerna
#endif
