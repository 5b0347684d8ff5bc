// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace/engines/surface_finish.h"
#include "lucerna/trace/kernels/body_kernel.h"

namespace lucerna {

inline Direction reflected_off(const Body& body, const Direction& direction, const BodyHit& hit,
                               const ReflectionKey& key) {
  return reflected_off(finish_of(body), direction, hit, key);
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

  /// The first body within (0, t_max_mm) of a ray in the luminaire frame; `returning`: the ray hit something
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
