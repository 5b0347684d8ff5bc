// SPDX-License-Identifier: Apache-2.0
#pragma once

// Only in builds with Embree (LUCERNA_EMBREE).
#include <embree3/rtcore.h>

#include "lucerna/scene.h"

namespace lucerna {

/// An Embree device: the only place where one is made, so that what the thread sanitizer says of Embree's own
/// threads can be told from races of ours (cmake/races_elsewhere.txt).
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

/// The triangles of a body in the luminaire frame, committed; to be attached to a scene and released. The
/// body must have triangles: Embree gives no buffer of size 0. Throws InputError where they do not fit the
/// memory.
RTCGeometry embree_triangles(const EmbreeDevice& device, const Body& body);

}  // namespace lucerna
