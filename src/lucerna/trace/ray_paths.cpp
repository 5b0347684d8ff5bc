// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/ray_paths.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "lucerna/core/error.h"
#include "lucerna/trace/ray_numbering.h"
#include "lucerna/trace/reference_tracer.h"

namespace lucerna {

namespace {

struct PlacedTracer {
  ReferenceTracer tracer;
  Frame world_from_mirror, mirror_from_world;
};

/// A hit in the luminaire frame.
struct WorldHit {
  double t_mm = std::numeric_limits<double>::infinity();
  Vec3 point_mm;
  Direction normal;
  bool front = true;
};

std::optional<WorldHit> nearest_hit(const std::vector<PlacedTracer>& mirrors, const Ray& ray) {
  std::optional<WorldHit> best;
  for (const PlacedTracer& m : mirrors) {
    const auto hit = m.tracer.first_hit(m.mirror_from_world.ray(ray));
    if (!hit || (best && best->t_mm <= hit->t_mm)) continue;
    best = {hit->t_mm, m.world_from_mirror.point(hit->point_mm), m.world_from_mirror.direction(hit->normal),
            hit->front};
  }
  return best;
}

/// What rays can meet.
struct Obstacles {
  std::vector<PlacedTracer> mirrors;
  const std::vector<Body>& bodies;
  BodyTracer body_tracer;
};

RayPath path_of(const Obstacles& obstacles, Ray ray, std::size_t source, int max_bounces) {
  RayPath path{source, {ray.origin_mm}, ray.direction, PathEnd::bounce_limit};
  for (int bounce = 0; bounce <= max_bounces; ++bounce) {
    const auto hit = nearest_hit(obstacles.mirrors, ray);
    const double reach = hit ? hit->t_mm : std::numeric_limits<double>::infinity();
    if (const auto body = obstacles.body_tracer.first_hit(ray, reach, bounce > 0)) {
      path.points_mm.push_back(ray.at(body->t_mm));
      if (!(obstacles.bodies[body->body].reflectance.at(-dot(ray.direction, body->normal)) > 0.0)) {
        path.end = PathEnd::body;
        return path;
      }
      ray = {ray.at(body->t_mm), Direction::from(reflect(ray.direction, body->normal))};
      path.last_direction = ray.direction;
      continue;
    }
    if (!hit) {
      path.end = PathEnd::out;
      return path;
    }
    path.points_mm.push_back(hit->point_mm);
    if (!hit->front) {
      path.end = PathEnd::mirror_back;
      return path;
    }
    ray = {hit->point_mm, Direction::from(reflect(ray.direction, hit->normal))};
    path.last_direction = ray.direction;
  }
  return path;
}

}  // namespace

std::vector<RayPath> ray_paths(const Scene& scene, std::uint64_t count, const PathOptions& options) {
  check(scene);
  if (options.max_bounces < 1)
    throw UsageError(fmt::format("{} bounces: expected at least 1", options.max_bounces));
  Obstacles obstacles{{}, scene.bodies, BodyTracer(scene.bodies)};
  for (const PlacedReflector& r : scene.reflectors) {
    // A coarse hierarchy finds the same hits; it is cheaper than a fine one for so few rays.
    obstacles.mirrors.push_back(
        {ReferenceTracer(r.reflector, 5), r.world_from_reflector, r.world_from_reflector.inverse()});
  }
  const RayNumbering numbering(scene.sources, options.seed);
  std::vector<RayPath> paths;
  RayBlock rays;
  for (std::uint64_t at = options.first_ray, end = at + count; at < end;) {
    const std::uint64_t to = std::min(end, (at / kBlockRays + 1) * kBlockRays);
    for (const SourceRun& run : numbering.runs(at, to)) {
      const PlacedSource& source = scene.sources[run.source];
      rays.resize(run.count, 0);
      source.rays->emit(Sequence(options.sequence, run.sequence_seed), run.first, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray ray = source.world_from_source.ray(rays.ray(i));
        if (!is_finite(ray.origin_mm) || !is_finite(ray.direction)) continue;
        paths.push_back(path_of(obstacles, ray, run.source, options.max_bounces));
      }
    }
    at = to;
  }
  return paths;
}

}  // namespace lucerna
