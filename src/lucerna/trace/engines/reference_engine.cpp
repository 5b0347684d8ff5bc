// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "lucerna/trace/engines/reference_tracer.h"
#include "lucerna/trace/engines/surface_finish.h"
#include "lucerna/trace/engines/trace_engine.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// A scene made ready: hierarchies built, frames inverted. Shared by all threads, never changed.
class ReferenceEngine final : public TraceEngine {
 public:
  ReferenceEngine(const Scene& scene, const RayNumbering& numbering, const TraceOptions& options)
      : TraceEngine(scene),
        scene_(scene),
        numbering_(numbering),
        max_bounces_(options.max_bounces),
        kind_(options.sequence) {
    for (const PlacedReflector& r : scene.reflectors) {
      mirrors_.push_back({ReferenceTracer(r.reflector), r.world_from_reflector,
                          r.world_from_reflector.inverse(), r.reflectance, finish_of(r)});
    }
  }

  std::string isa() const override { return "reference"; }

  /// Draws and traces the rays of one run.
  void trace_run(const SourceRun& run, TraceScratch& scratch, Tally& tally) const override {
    RayBlock& rays = scratch.rays;
    const PlacedSource& source = scene_.sources[run.source];
    rays.resize(run.count, 0);
    source.rays->emit(Sequence(kind_, run.sequence_seed), run.first, rays);
    emit_wavelengths(run, kind_, scratch);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      trace_ray(
          source.world_from_source.ray(rays.ray(i)),
          std::llround(static_cast<double>(rays.weight[i]) * numbering_.ray_flux(run.source) * kQuantaPerRay),
          {run.sequence_seed, run.first + i, 0}, scratch.wavelength_nm[i], scratch, tally);
    }
  }

 private:
  struct Mirror {
    ReferenceTracer tracer;
    Frame world_from_mirror, mirror_from_world;
    Reflectance reflectance;
    SurfaceFinish finish;
  };
  struct Nearest {
    const Mirror* mirror = nullptr;
    Ray local;
    MirrorHit hit{std::numeric_limits<double>::infinity(), {}, {}, true};
  };

  Nearest nearest(const Ray& ray) const {
    Nearest best;
    for (const Mirror& m : mirrors_) {
      const Ray local = m.mirror_from_world.ray(ray);
      const auto hit = m.tracer.first_hit(local);
      if (hit && hit->t_mm < best.hit.t_mm) best = {&m, local, *hit};
    }
    return best;
  }

  static void lose(LostCause cause, std::int64_t energy, Tally& tally) {
    tally.lost[static_cast<std::size_t>(cause)] += energy;
    ++tally.lost_rays[static_cast<std::size_t>(cause)];
  }

  /// Counts what a surface keeps of `energy` when it passes `throughput` on, and returns it.
  static std::int64_t absorb(std::int64_t energy, double throughput, std::size_t cause, Tally& tally) {
    const std::int64_t absorbed = energy - std::llround(static_cast<double>(energy) * throughput);
    tally.absorbed[cause] += absorbed;
    return absorbed;
  }

  void trace_ray(Ray ray, std::int64_t energy, ReflectionKey key, float wavelength_nm, TraceScratch& scratch,
                 Tally& tally) const {
    ++tally.rays;
    tally.emitted += energy;
    // `bounce` counts reflections, key.bounce all that the ray meets.
    for (int bounce = 0;; ++key.bounce) {
      if (!is_finite(ray.origin_mm) || !is_finite(ray.direction))
        return lose(LostCause::not_finite, energy, tally);
      const Nearest n = nearest(ray);
      const auto body = bodies().first_hit(ray, n.hit.t_mm, bounce > 0);
      if (const auto cover_glass = glasses().first_hit(ray, body ? body->t_mm : n.hit.t_mm, key.bounce > 0)) {
        const GlassPassage passage = glasses().pass(ray, *cover_glass, key, wavelength_nm);
        if (!passage.transmitted && passage.throughput > 0.0) {
          if (bounce == max_bounces_) return lose(LostCause::bounce_limit, energy, tally);
          ++bounce;
          ++tally.reflections;
        }
        energy -= absorb(energy, passage.throughput, glass_cause(cover_glass->glass), tally);
        if (energy == 0) return;
        if (passage.lost) return lose(LostCause::bounce_limit, energy, tally);
        ray = passage.ray;
        continue;
      }
      if (const auto& hit = body) {
        if (bounce == max_bounces_) return lose(LostCause::bounce_limit, energy, tally);
        const double cosine = -dot(ray.direction, hit->normal);
        energy -=
            absorb(energy, scene_.bodies[hit->body].reflectance.at(cosine), kMirrorLosses + hit->body, tally);
        if (energy == 0) return;
        ++bounce;
        ++tally.reflections;
        ray = {ray.at(hit->t_mm), reflected_off(scene_.bodies[hit->body], ray.direction, *hit, key)};
        continue;
      }
      if (n.mirror == nullptr) {
        (bounce == 0 ? tally.out_direct : tally.out_reflected) += energy;
        for (std::size_t d = 0; d < far_fields().size(); ++d) {
          if (!far_fields()[d].tent()) tally.bins[d][far_fields()[d].cell(ray.direction)] += energy;
        }
        leave(ray, energy, scratch, tally);
        return;
      }
      if (!n.hit.front) {
        tally.absorbed[static_cast<std::size_t>(MirrorLoss::back)] += energy;
        return;
      }
      if (bounce == max_bounces_) return lose(LostCause::bounce_limit, energy, tally);
      const double cosine = -dot(n.local.direction, n.hit.normal);
      energy -=
          absorb(energy, n.mirror->reflectance.at(cosine), static_cast<std::size_t>(MirrorLoss::face), tally);
      ++bounce;
      ++tally.reflections;
      const SurfaceFinish& finish = n.mirror->finish;
      const Direction normal = finish.slope_error_rad > 0.0
                                   ? tilted_normal(n.hit.normal, finish.slope_error_rad, key)
                                   : n.hit.normal;
      Direction out = Direction::from(reflect(n.local.direction, normal));
      if (finish.scatters()) out = scattered(finish, normal, out, key);
      ray = n.mirror->world_from_mirror.ray({n.hit.point_mm, out});
    }
  }

  const Scene& scene_;
  const RayNumbering& numbering_;
  int max_bounces_;
  SequenceKind kind_;
  std::vector<Mirror> mirrors_;
};

}  // namespace

std::unique_ptr<TraceEngine> make_reference_engine(const Scene& scene, const RayNumbering& numbering,
                                                   const TraceOptions& options) {
  return std::make_unique<ReferenceEngine>(scene, numbering, options);
}

}  // namespace lucerna
