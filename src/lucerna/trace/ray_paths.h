// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/core/sequence.h"
#include "lucerna/trace/scene.h"

namespace lucerna {

/// How a ray's way through a scene ended.
enum class PathEnd { out, mirror_back, body, bounce_limit };

/// The way of one ray in the luminaire frame.
struct RayPath {
  std::size_t source = 0;
  /// Where it starts, then every point where it meets a mirror or a body.
  std::vector<Vec3> points_mm;
  /// Direction after the last point; what leaves goes on along it.
  Direction last_direction;
  PathEnd end = PathEnd::out;
};

struct PathOptions {
  std::uint64_t seed = 1;
  SequenceKind sequence = SequenceKind::sobol;
  std::uint64_t first_ray = 0;
  /// Reflections after which a ray is given up; at least 1.
  int max_bounces = 100;
};

/// The ways of up to `count` rays of the run that `trace` makes of the same seed, sequence and first ray: for
/// pictures. Bodies that reflect at all pass a ray on whole; slope errors are left out. Rays with a
/// coordinate that is not finite are left out. By the reference tracer, one thread; the hierarchies cost more
/// than some hundred rays. Throws InputError on a bad scene (`check`).
std::vector<RayPath> ray_paths(const Scene& scene, std::uint64_t count, const PathOptions& options = {});

}  // namespace lucerna
