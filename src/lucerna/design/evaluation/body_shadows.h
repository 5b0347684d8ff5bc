// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace/kernels/triangle_bvh.h"

namespace lucerna {

/// What a design's ray hit in its way, in the mirror's frame.
struct ShadowHit {
  /// Where it goes on from, a little in front of the facet, and along what.
  Vec3 origin, direction;
  /// Share of the light that is reflected; 0: all of it ends here.
  double reflected = 0.0;
};

/// The bodies of a project, and its mirrors other than the one that is shaped, as the rays of a design meet
/// them: absorbers end a ray, mirrors reflect it off their flat facets (slope errors are left out; a
/// reflector's back absorbs), lamps stand only in the way of light that a mirror or another body sent back.
/// Hits by the library's own tree, one ray at a time. Immutable and thread safe.
class BodyShadows {
 public:
  /// In the mirror's frame; from number `reflectors` on their backs absorb. Throws InputError on a mesh
  /// without triangles.
  BodyShadows(std::vector<Body> bodies, std::size_t reflectors);

  /// The first one within (0, t_max_mm) of a ray; `returning`: it hit something before.
  std::optional<ShadowHit> first(const Vec3& origin, const Vec3& direction, double t_max_mm,
                                 bool returning) const;

 private:
  std::vector<Body> bodies_;
  std::size_t reflectors_;
  TriangleBvh direct_, returning_;
};

/// All that stands around a scene's first reflector; null where nothing does.
std::shared_ptr<const BodyShadows> shadows_of(const Scene& scene, const Frame& mirror_from_world);

}  // namespace lucerna
