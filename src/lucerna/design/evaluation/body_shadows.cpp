// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/body_shadows.h"

#include <utility>

#include "lucerna/cad.h"
#include "lucerna/trace/kernels/body_kernel.h"

namespace lucerna {

namespace {

/// Of the meshes of other reflectors.
constexpr CadTolerance kMirrorTolerance{.chord_mm = 0.01, .slope_deg = 0.5};

Body as_body(const PlacedReflector& mirror) {
  CadTolerance tolerance = kMirrorTolerance;
  Body body;
  body.name = "mirror";
  body.mesh = std::make_shared<const Mesh>(cad_mesh_within(mirror.reflector, tolerance));
  body.world_from_body = mirror.world_from_reflector;
  body.reflectance = mirror.reflectance;
  return body;
}

}  // namespace

BodyShadows::BodyShadows(std::vector<Body> bodies, std::size_t reflectors)
    : bodies_(std::move(bodies)),
      reflectors_(reflectors),
      direct_(bodies_, false),
      returning_(bodies_, true) {
  for (const Body& body : bodies_) check(body);
}

std::optional<ShadowHit> BodyShadows::first(const Vec3& origin, const Vec3& direction, double t_max_mm,
                                            bool returning) const {
  const TriangleBvhView tree = (returning ? returning_ : direct_).view();
  const TriangleHit hit = first_triangle(tree, origin, direction, returning ? kBodyStart : 0.0, t_max_mm);
  if (hit.triangle < 0) return std::nullopt;
  const TreeTriangle& triangle = tree.triangles[hit.triangle];
  const Direction along = Direction::from(direction);
  const Vec3 normal = normal_of(triangle);
  const BodyHit at = body_hit(along, hit.t, triangle.body, normal, nullptr, hit.u, hit.v);
  const bool back = triangle.body >= reflectors_ && dot(along, normal) > 0.0;
  const Vec3 place = origin + hit.t * direction + kBodyStart * at.face.vec();
  const double reflected = back ? 0.0 : bodies_[triangle.body].reflectance.at(-dot(along, at.normal));
  return ShadowHit{place, reflect(along, at.normal).vec(), reflected};
}

std::shared_ptr<const BodyShadows> shadows_of(const Scene& scene, const Frame& mirror_from_world) {
  std::vector<Body> bodies = scene.bodies;
  const std::size_t reflectors = bodies.size();
  for (std::size_t i = 1; i < scene.reflectors.size(); ++i) bodies.push_back(as_body(scene.reflectors[i]));
  if (bodies.empty()) return nullptr;
  for (Body& body : bodies) body.world_from_body = mirror_from_world * body.world_from_body;
  return std::make_shared<const BodyShadows>(std::move(bodies), reflectors);
}

}  // namespace lucerna
