// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/core/frame.h"
#include "lucerna/reflector/mesh.h"
#include "lucerna/trace/body_kernel.h"
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
  /// > 0: a mirror's normal changes steadily across triangles that meet at less than this angle
  /// (`corner_normals`); 0: every triangle is flat.
  double smooth_below_deg = 0.0;
  /// As PlacedReflector::slope_error_mrad, on both sides.
  double slope_error_mrad = 0.0;
};

/// Throws InputError unless the body has triangles, 0 <= smooth_below_deg <= 180 and 0 <= slope_error_mrad <=
/// 1000.
void check(const Body& body);

inline Direction reflected_off(const Body& body, const Direction& direction, const BodyHit& hit,
                               const ReflectionKey& key) {
  return reflected_off(body.slope_error_mrad, direction, hit, key);
}

/// Three normals a triangle, in the luminaire frame, if the body is smooth; else none.
std::vector<Vec3> smooth_normals(const Body& body);

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
  /// Smooth normals by body, three a triangle, in the luminaire frame; empty for flat ones.
  std::vector<std::vector<Vec3>> corner_normals_;
  std::size_t count_;
  std::unique_ptr<Device> device_;
};

}  // namespace lucerna
