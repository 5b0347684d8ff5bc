// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/scene.h"

namespace lucerna {

/// How a ray's way through a scene ended.
enum class RayEnd { out, mirror_back, body, glass, bounce_limit };

/// The way of one ray in the luminaire frame.
struct RayPath {
  std::size_t source = 0;
  /// Where it starts, then every point where it hits a mirror, a body, a face of a cover glass or the surface
  /// of a solid: inside these it goes to and fro as often as the tracer says.
  std::vector<Vec3> points_mm;
  /// How often it was reflected before it leaves each of these points, as TraceOptions::max_bounces counts: a
  /// glass that returns it counts once, on leaving the glass; one that lets it through does not.
  std::vector<int> reflections;
  /// Direction after the last point; what leaves goes on along it.
  Direction last_direction;
  RayEnd end = RayEnd::out;
};

struct PathOptions {
  std::uint64_t seed = 1;
  SequenceKind sequence = SequenceKind::sobol;
  std::uint64_t first_ray = 0;
  /// Reflections after which a ray is given up; at least 1.
  int max_bounces = 100;
};

/// The ways of up to `count` rays of the run that `trace` makes of the same seed, sequence and first ray: for
/// pictures. Bodies that reflect at all and glasses that keep some light pass a ray on whole; at a glass it
/// goes where the trace sends it. Slope errors are left out, and so are rays with a coordinate that is not
/// finite. By the reference tracer, one thread; the hierarchies cost more
/// than some hundred rays. Throws InputError on a bad scene (`check`).
std::vector<RayPath> ray_paths(const Scene& scene, std::uint64_t count, const PathOptions& options = {});

}  // namespace lucerna
