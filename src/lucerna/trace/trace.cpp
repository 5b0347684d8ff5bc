// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/trace.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <utility>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"
#include "lucerna/trace/ray_numbering.h"
#include "lucerna/trace/reference_tracer.h"

namespace lucerna {

namespace {

/// A scene made ready: hierarchies built, frames inverted. Shared by all threads, never changed.
class LightTracer {
 public:
  LightTracer(const Scene& scene, const TraceOptions& options)
      : scene_(scene), max_bounces_(options.max_bounces), kind_(options.sequence) {
    for (const PlacedReflector& r : scene.reflectors) {
      mirrors_.push_back({ReferenceTracer(r.reflector), r.world_from_reflector,
                          r.world_from_reflector.inverse(), r.reflectance});
    }
    for (const FarFieldDetector& d : scene.far_fields) far_fields_.emplace_back(d);
    const RayNumbering numbering(scene.sources, options.seed);
    double flux = 0.0;
    for (const PlacedSource& s : scene.sources) flux += s.total_flux();
    for (std::size_t i = 0; i < scene.sources.size(); ++i) {
      const double share =
          static_cast<double>(numbering.word().share(i)) / static_cast<double>(numbering.word().total());
      ray_flux_.push_back(scene.sources[i].total_flux() / flux / share);
    }
  }

  Tally empty_tally() const {
    Tally t;
    t.absorbed.resize(kMirrorLosses);
    t.lost.resize(kLostCauses);
    t.lost_rays.resize(kLostCauses);
    for (const FarFieldGrid& grid : far_fields_) t.bins.emplace_back(grid.size());
    return t;
  }

  /// Draws and traces the rays of one run.
  void trace_run(const SourceRun& run, RayBlock& rays, Tally& tally) const {
    const PlacedSource& source = scene_.sources[run.source];
    rays.resize(run.count, 0);
    source.rays->emit(Sequence(kind_, run.sequence_seed), run.first, rays);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      trace_ray(source.world_from_source.ray(rays.ray(i)),
                to_units(static_cast<double>(rays.weight[i]) * ray_flux_[run.source]), tally);
    }
  }

 private:
  struct Mirror {
    ReferenceTracer tracer;
    Frame world_from_mirror, mirror_from_world;
    Reflectance reflectance;
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

  void trace_ray(Ray ray, std::int64_t energy, Tally& tally) const {
    ++tally.rays;
    tally.emitted += energy;
    for (int bounce = 0;; ++bounce) {
      if (!is_finite(ray.origin_mm) || !is_finite(ray.direction))
        return lose(LostCause::not_finite, energy, tally);
      const Nearest n = nearest(ray);
      if (n.mirror == nullptr) {
        (bounce == 0 ? tally.out_direct : tally.out_reflected) += energy;
        for (std::size_t d = 0; d < far_fields_.size(); ++d) {
          tally.bins[d][far_fields_[d].cell(ray.direction)] += energy;
        }
        return;
      }
      if (!n.hit.front) {
        tally.absorbed[static_cast<std::size_t>(MirrorLoss::back)] += energy;
        return;
      }
      if (bounce == max_bounces_) return lose(LostCause::bounce_limit, energy, tally);
      const double cosine = -dot(n.local.direction, n.hit.normal);
      const auto kept = static_cast<std::int64_t>(
          std::llround(static_cast<double>(energy) * n.mirror->reflectance.at(cosine)));
      tally.absorbed[static_cast<std::size_t>(MirrorLoss::face)] += energy - kept;
      energy = kept;
      ++tally.reflections;
      const Direction out = Direction::from(reflect(n.local.direction, n.hit.normal));
      ray = n.mirror->world_from_mirror.ray({n.hit.point_mm, out});
    }
  }

  const Scene& scene_;
  int max_bounces_;
  SequenceKind kind_;
  std::vector<Mirror> mirrors_;
  std::vector<FarFieldGrid> far_fields_;
  std::vector<double> ray_flux_;  ///< of a ray with weight 1, in mean rays
};

/// Blocks of one replicate that a thread takes at a time: 32 k rays, so that clearing and adding bins is
/// cheap beside them.
constexpr std::uint64_t kTaskBlocks = 64;

}  // namespace

std::uint64_t default_ray_count(const Scene& scene) {
  check(scene);
  return RayNumbering(scene.sources, 0).default_count();
}

TraceResult trace(const Scene& scene, const TraceOptions& options, Progress& progress) {
  check(scene);
  const RayNumbering numbering(scene.sources, options.seed);
  TraceResult result;
  result.first_ray = options.first_ray;
  result.last_ray = options.last_ray.value_or(numbering.default_count());
  if (!(result.first_ray < result.last_ray && result.last_ray <= kMostRays)) {
    throw UsageError(
        fmt::format("rays {}:{}: expected first < last <= {}", result.first_ray, result.last_ray, kMostRays));
  }
  if (options.max_bounces < 1)
    throw UsageError(fmt::format("{} bounces: expected at least 1", options.max_bounces));
  result.seed = options.seed;
  result.sequence = options.sequence;
  result.max_bounces = options.max_bounces;
  result.isa = "reference";
  result.unit = scene.sources.front().rays->flux_unit();
  for (const PlacedSource& s : scene.sources) result.flux += s.total_flux();
  result.far_fields = scene.far_fields;

  const LightTracer tracer(scene, options);
  result.replicates.assign(kReplicates, tracer.empty_tally());
  std::mutex mutex;
  std::uint64_t done = 0;
  // A task is a row of blocks of one replicate; rows are aligned to ray 0, so that the cut does not depend on
  // the range.
  const std::uint64_t row = kTaskBlocks * kReplicates * kBlockRays;
  const std::uint64_t first_row = result.first_ray / row, rows = (result.last_ray - 1) / row + 1 - first_row;
  parallel_blocks(rows * kReplicates, 1, [&](std::size_t task, std::size_t) {
    const std::uint64_t replicate = task % kReplicates;
    const std::uint64_t row_begin = (first_row + task / kReplicates) * row;
    Tally tally = tracer.empty_tally();
    RayBlock rays;
    for (std::uint64_t k = 0; k < kTaskBlocks; ++k) {
      const std::uint64_t begin = row_begin + (k * kReplicates + replicate) * kBlockRays;
      const std::uint64_t from = std::max(begin, result.first_ray);
      const std::uint64_t to = std::min(begin + kBlockRays, result.last_ray);
      if (from >= to) continue;
      for (const SourceRun& run : numbering.runs(from, to)) tracer.trace_run(run, rays, tally);
    }
    const std::lock_guard lock(mutex);
    result.replicates[replicate] += tally;
    done += tally.rays;
    progress.step("trace", done, result.last_ray - result.first_ray);
  });
  return result;
}

}  // namespace lucerna
