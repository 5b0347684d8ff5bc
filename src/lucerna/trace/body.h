// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/core/frame.h"
#include "lucerna/reflector/mesh.h"
#include "lucerna/trace/reflectance.h"
#include "lucerna/trace/slope_error.h"

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

struct BodyHit {
  double t_mm = 0.0;
  std::size_t body = 0;
  /// Normal towards the side the ray came from: the triangle's own, or the smooth one where that sends the
  /// reflected ray to the same side.
  Direction normal;
  /// The triangle's own, towards the same side.
  Direction face;
};

/// Where a mirror reflects a ray that met it: about the normal, tilted by the body's slope error of this
/// reflection. What a tilt sends into the triangle is reflected there once more: nothing leaks through.
Direction reflected_off(const Body& body, const Direction& direction, const BodyHit& hit,
                        const ReflectionKey& key);

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
