// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <vector>

#include "submission.h"

namespace bench {

/// The surfaces of a submission in Embree. Built by one thread, so that a hit has the same bits whatever
/// traces it. Immutable; thread safe.
class SurfaceScene {
 public:
  explicit SurfaceScene(const std::vector<Part>& parts);

  struct PartHit {
    const Part* part = nullptr;
    Hit hit;
  };
  /// The first hit farther than a millionth of the scene's size; a null part for none. Normals are turned
  /// where the part says `flip`.
  PartHit first_hit(const Vec3& origin, const Vec3& direction) const;

 private:
  struct Release {
    void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
    void operator()(RTCScene s) const { rtcReleaseScene(s); }
  };
  struct Search;
  /// Called by Embree for each triangle nearer than those before: keeps the hit with its surface, if there is
  /// one.
  static void look_at(const RTCFilterFunctionNArguments* args);
  void attach(const Part& part, unsigned id);

  const std::vector<Part>& parts_;
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
  double size_ = 0.0;
};

}  // namespace bench
