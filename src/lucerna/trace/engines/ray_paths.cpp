// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/ray_paths.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/engines/glass_tracer.h"
#include "lucerna/trace/engines/ray_colours.h"
#include "lucerna/trace/engines/ray_numbering.h"
#include "lucerna/trace/engines/reference_tracer.h"
#include "lucerna/trace/tally/flux_quanta.h"

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

/// What rays can hit.
struct Obstacles {
  std::vector<PlacedTracer> mirrors;
  const std::vector<Body>& bodies;
  BodyTracer body_tracer;
  const std::vector<CoverGlass>& glasses;
  GlassTracer glass_tracer;
};

/// A ray on its way, and the way behind it.
class PathWalk {
 public:
  PathWalk(const Obstacles& obstacles, const Ray& ray, std::size_t source, const ReflectionKey& key,
           float wavelength_nm, int max_bounces)
      : obstacles_(obstacles),
        ray_(ray),
        key_(key),
        wavelength_nm_(wavelength_nm),
        max_bounces_(max_bounces) {
    path_ = {source, {ray.origin_mm}, {0}, ray.direction, RayEnd::out};
  }

  RayPath run() {
    while (step()) ++key_.bounce;
    path_.last_direction = ray_.direction;
    return std::move(path_);
  }

 private:
  /// On to what the ray meets next; false where its way ends.
  bool step() {
    const auto hit = nearest_hit(obstacles_.mirrors, ray_);
    double reach = hit ? hit->t_mm : std::numeric_limits<double>::infinity();
    const auto body = obstacles_.body_tracer.first_hit(ray_, reach, reflections_ > 0);
    if (body) reach = body->t_mm;
    if (const auto glass = obstacles_.glass_tracer.first_hit(ray_, reach, key_.bounce > 0))
      return pass(*glass);
    if (body) {
      const Vec3 at = ray_.at(body->t_mm);
      if (!(obstacles_.bodies[body->body].reflectance.at(-dot(ray_.direction, body->normal)) > 0.0))
        return end_at(at, RayEnd::body);
      return reflect_at(at, body->normal);
    }
    if (!hit) return false;
    if (!hit->front) return end_at(hit->point_mm, RayEnd::mirror_back);
    return reflect_at(hit->point_mm, hit->normal);
  }

  void note(const Vec3& at) {
    path_.points_mm.push_back(at);
    path_.reflections.push_back(reflections_);
  }

  bool end_here(RayEnd end) {
    path_.end = end;
    return false;
  }

  bool end_at(const Vec3& at, RayEnd end) {
    note(at);
    return end_here(end);
  }

  bool reflect_at(const Vec3& at, const Direction& normal) {
    if (reflections_ == max_bounces_) return end_at(at, RayEnd::bounce_limit);
    ++reflections_;
    note(at);
    ray_ = {at, Direction::from(reflect(ray_.direction, normal))};
    return true;
  }

  /// Every point of a solid's surface on the way.
  bool pass_solid(const GlassHit& hit) {
    const GlassPassage passage =
        obstacles_.glass_tracer.pass(ray_, hit, key_, wavelength_nm_, [this](const Vec3& at) { note(at); });
    if (!(passage.throughput > 0.0)) return end_here(RayEnd::glass);
    if (passage.lost || (!passage.transmitted && reflections_ == max_bounces_))
      return end_here(RayEnd::bounce_limit);
    if (!passage.transmitted) path_.reflections.back() = ++reflections_;
    ray_ = passage.ray;
    return true;
  }

  /// In at one face, as often to the other and back as the trace has it, and out.
  bool pass(const GlassHit& hit) {
    if (obstacles_.glass_tracer.is_solid(hit)) return pass_solid(hit);
    const Vec3 in = ray_.at(hit.t_mm);
    const GlassPassage passage = obstacles_.glass_tracer.pass(ray_, hit, key_, wavelength_nm_);
    if (!(passage.throughput > 0.0)) return end_at(in, RayEnd::glass);
    if (!passage.transmitted && reflections_ == max_bounces_) return end_at(in, RayEnd::bounce_limit);
    const CoverGlass& glass = obstacles_.glasses[hit.glass];
    const Vec3 z = glass.world_from_glass.vector({0.0, 0.0, 1.0});
    const Vec3 across = (dot(z, ray_.direction.vec()) < 0.0 ? -glass.thickness_mm : glass.thickness_mm) * z;
    const Vec3 out = passage.ray.origin_mm;
    const Vec3 along = out - in - (passage.transmitted ? across : Vec3{});
    for (int way = 0; way < passage.ways; ++way)
      note(in + (static_cast<double>(way) / passage.ways) * along + (way % 2 == 1 ? across : Vec3{}));
    if (!passage.transmitted) ++reflections_;
    note(out);
    ray_ = passage.ray;
    return true;
  }

  const Obstacles& obstacles_;
  Ray ray_;
  ReflectionKey key_;
  float wavelength_nm_;
  int max_bounces_;
  int reflections_ = 0;
  RayPath path_;
};

}  // namespace

std::vector<RayPath> ray_paths(const Scene& scene, std::uint64_t count, const PathOptions& options) {
  check(scene);
  if (options.max_bounces < 1)
    throw UsageError(fmt::format("{} bounces: expected at least 1", options.max_bounces));
  Obstacles obstacles{
      {}, scene.bodies, BodyTracer(scene.bodies), scene.glasses, GlassTracer(scene.glasses, scene.solids)};
  for (const PlacedReflector& r : scene.reflectors) {
    // A coarse hierarchy finds the same hits; it is cheaper than a fine one for so few rays.
    obstacles.mirrors.push_back(
        {ReferenceTracer(r.reflector, 5), r.world_from_reflector, r.world_from_reflector.inverse()});
  }
  const RayNumbering numbering(scene.sources, options.seed);
  const RayColours colours(scene);
  std::vector<RayPath> paths;
  RayBlock rays;
  for (std::uint64_t at = options.first_ray, end = at + count; at < end;) {
    const std::uint64_t to = std::min(end, (at / kBlockRays + 1) * kBlockRays);
    for (const SourceRun& run : numbering.runs(at, to)) {
      const PlacedSource& source = scene.sources[run.source];
      const Sequence sequence(options.sequence, run.sequence_seed);
      rays.resize(run.count, 0);
      source.rays->emit(sequence, run.first, rays);
      std::vector<float> wavelength_nm(run.count);
      colours.emit(run.source, sequence, run.first, wavelength_nm);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Ray ray = source.world_from_source.ray(rays.ray(i));
        if (!is_finite(ray.origin_mm) || !is_finite(ray.direction)) continue;
        const ReflectionKey key{run.sequence_seed, run.first + i, 0};
        paths.push_back(
            PathWalk(obstacles, ray, run.source, key, wavelength_nm[i], options.max_bounces).run());
      }
    }
    at = to;
  }
  return paths;
}

}  // namespace lucerna
