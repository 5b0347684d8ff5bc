// SPDX-License-Identifier: Apache-2.0
#pragma once

// Only in builds with Embree (LUCERNA_EMBREE).
#include <embree3/rtcore.h>

#include "lucerna/scene.h"

namespace lucerna {

/// An Embree device. Devices and scenes are made here only, so that what the thread sanitizer says of
/// Embree's own threads can be told from races of ours (cmake/races_elsewhere.txt).
class EmbreeDevice {
 public:
  /// `config` as rtcNewDevice takes it. Throws InputError where Embree gives no device.
  explicit EmbreeDevice(const char* config = nullptr);
  ~EmbreeDevice();
  EmbreeDevice(const EmbreeDevice&) = delete;
  EmbreeDevice& operator=(const EmbreeDevice&) = delete;

  RTCDevice get() const { return device_; }

 private:
  RTCDevice device_;
};

/// An Embree scene without geometries; does not outlive its device.
class EmbreeScene {
 public:
  explicit EmbreeScene(const EmbreeDevice& device);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  RTCScene get() const { return scene_; }

 private:
  RTCScene scene_;
};

/// The triangles of a body in the luminaire frame, committed; to be attached to a scene and released. The
/// body must have triangles: Embree gives no buffer of size 0. Throws InputError where they do not fit the
/// memory.
RTCGeometry embree_triangles(const EmbreeDevice& device, const Body& body);

}  // namespace lucerna
