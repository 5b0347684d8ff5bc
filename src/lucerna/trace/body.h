// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/core/frame.h"
#include "lucerna/reflector/mesh.h"
#include "lucerna/trace/reflectance.h"

namespace lucerna {

/// Something that is no height field: housing, shield, the lamp's own body; absorbs, or is a mirror on both
/// sides.
struct Body {
  /// The cause in the ledger.
  std::string name = "body";
  std::shared_ptr<const Mesh> mesh;
  Frame world_from_body;
  /// 0 absorbs everything.
  Reflectance reflectance{0.0};
  /// True for the lamp's own body: rays of a lamp's file already left it, so it only meets light that comes
  /// back from a mirror or another body; else its shadow would be counted twice.
  bool only_returning_light = false;
};

struct BodyHit {
  double t_mm = 0.0;
  std::size_t body = 0;
  /// Flat normal of the triangle, towards the side the ray came from.
  Direction normal;
};

/// Finds first hits with a set of bodies (Embree). Immutable and thread safe.
class BodyTracer {
 public:
  /// Throws InputError if there are bodies and the program was built without Embree, or a mesh is empty.
  explicit BodyTracer(const std::vector<Body>& bodies);
  ~BodyTracer();
  BodyTracer(const BodyTracer&) = delete;
  BodyTracer& operator=(const BodyTracer&) = delete;

  bool empty() const { return count_ == 0; }

  /// The first body within (0, t_max_mm) of a ray in the luminaire frame; `returning`: the ray met something
  /// before. Starts that lie on a triangle are stepped over by a thousandth of a millimetre (float32).
  std::optional<BodyHit> first_hit(const Ray& ray, double t_max_mm, bool returning) const;

 private:
  struct Device;
  std::size_t count_;
  std::unique_ptr<Device> device_;
};

}  // namespace lucerna
