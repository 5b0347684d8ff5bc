// SPDX-License-Identifier: Apache-2.0
#if defined(LUCERNA_EMBREE)
#include "lucerna/trace/engines/embree_device.h"

#include <cstdint>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

// The thread sanitizer's stacks leave out the function that calls a library without instrumentation, and show
// its caller: so the calls stand in functions of their own, and neither these nor the constructors are
// inlined.
__attribute__((noinline)) RTCDevice device_of_embree(const char* config) {
  RTCDevice device = rtcNewDevice(config);
  if (device == nullptr) throw InputError("Embree gives no device", ErrorCause::unsupported);
  return device;
}

__attribute__((noinline)) RTCScene scene_of_embree(RTCDevice device) {
  RTCScene scene = rtcNewScene(device);
  if (scene == nullptr) throw InputError("Embree gives no scene", ErrorCause::unsupported);
  return scene;
}

}  // namespace

__attribute__((noinline)) EmbreeDevice::EmbreeDevice(const char* config)
    : device_(device_of_embree(config)) {}

EmbreeDevice::~EmbreeDevice() { rtcReleaseDevice(device_); }

__attribute__((noinline)) EmbreeScene::EmbreeScene(const EmbreeDevice& device)
    : scene_(scene_of_embree(device.get())) {}

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
