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
    /// No part, and yet not nothing: the search ended after kMaxPassed flat hits whose surfaces were missed.
    bool given_up = false;
  };
  /// Flat hits that are looked at along a ray: those whose surface is missed are passed.
  static constexpr int kMaxPassed = 64;
  /// The first hit farther than a millionth of the scene's size; a null part for none. Normals are turned
  /// where the part says `flip`.
  PartHit first_hit(const Vec3& origin, const Vec3& direction) const;

 private:
  struct Release {
    void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
    void operator()(RTCScene s) const { rtcReleaseScene(s); }
  };
  void attach(const Part& part, unsigned id);

  const std::vector<Part>& parts_;
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
  double size_ = 0.0;
};

}  // namespace bench
