// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_validation.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include "lucerna/core/parallel/counted_progress.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/trace/engines/ray_numbering.h"
#include "lucerna/trace/engines/solid_tracer.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kFirstRays = std::uint64_t{1} << 18;
/// Times that a ray may meet solids from outside.
constexpr int kMostPassages = 100;
/// Of the mesh, over the lens's size: with ten times as much exact lenses had an error of 0.7 %, not 0.4.
constexpr double kMeshTolerance = 1e-5;
constexpr double kNoLimitMm = std::numeric_limits<double>::max();

/// The same bodies by triangles.
std::vector<Solid> meshed(const Scene& scene) {
  std::vector<Solid> out = scene.solids;
  for (Solid& s : out) {
    s.mesh = surface_mesh(s, kMeshTolerance);
    s.outline_mm.clear();
    s.face = nullptr;
  }
  return out;
}

class LensBlockTracer {
 public:
  LensBlockTracer(const Scene& scene, const RayNumbering& numbering, const SolidTracer& solids,
                  const ErrorBoxes& boxes)
      : scene_(scene), numbering_(numbering), solids_(solids), boxes_(boxes) {}

  void add_block(std::uint64_t block, BoxSums& sums) {
    for (const SourceRun& run : numbering_.runs(block * kBlockRays, (block + 1) * kBlockRays)) {
      const PlacedSource& source = scene_.sources[run.source];
      rays_.resize(run.count, 0);
      source.rays->emit(Sequence(SequenceKind::sobol, run.sequence_seed), run.first, rays_);
      for (std::size_t i = 0; i < run.count; ++i) {
        const double flux = numbering_.ray_flux(run.source) * static_cast<double>(rays_.weight[i]);
        follow(source.world_from_source.ray(rays_.ray(i)), flux, {run.sequence_seed, run.first + i, 0}, sums);
      }
    }
    sums.rays += kBlockRays;
  }

 private:
  void follow(Ray ray, double flux, ReflectionKey key, BoxSums& sums) const {
    sums.emitted += flux;
    for (;; ++key.bounce) {
      const auto hit = solids_.first_hit(ray, kNoLimitMm, key.bounce > 0);
      if (!hit) return leave(ray, flux, key.bounce > 0, sums);
      const GlassPassage way = solids_.pass(ray, *hit, key);
      sums.bodies += flux * (1.0 - way.throughput);
      flux *= way.throughput;
      if (way.lost || key.bounce == kMostPassages) {
        sums.lost += flux;
        return;
      }
      ray = way.ray;
    }
  }

  void leave(const Ray& ray, double flux, bool met, BoxSums& sums) const {
    const std::size_t cell = boxes_.cell(ray.origin_mm, ray.direction.vec());
    sums.flux[cell] += flux;
    (met ? sums.out_reflected : sums.out_direct) += flux;
    if (!met) sums.direct[cell] += flux;
  }

  const Scene& scene_;
  const RayNumbering& numbering_;
  const SolidTracer& solids_;
  const ErrorBoxes& boxes_;
  RayBlock rays_;
};

double seconds_since_start(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

LensValidation validate_lens(const Scene& scene, const ErrorBoxes& boxes, std::span<const double> target,
                             TargetMode mode, std::uint64_t seed, std::uint64_t max_rays, double max_s,
                             Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  check(scene);
  const SolidTracer solids(meshed(scene));
  const RayNumbering numbering(scene.sources, seed ^ 0x56414C4944415445ull);
  std::vector<BoxSums> replicates(kReplicates);
  for (BoxSums& r : replicates) {
    r.flux.assign(boxes.size(), 0.0);
    r.direct.assign(boxes.size(), 0.0);
  }
  LensValidation out;
  constexpr std::uint64_t kUnit = kReplicates * kBlockRays;
  std::uint64_t done = 0, next = std::max<std::uint64_t>(1, std::min(kFirstRays, max_rays) / kUnit);
  while (next > done) {
    CountedProgress counted(progress, "validate", done * kUnit, max_rays);
    parallel_blocks(kReplicates, 1, [&](std::size_t r, std::size_t) {
      LensBlockTracer tracer(scene, numbering, solids, boxes);
      for (std::uint64_t j = done; j < next; ++j) tracer.add_block(kReplicates * j + r, replicates[r]);
      counted.add((next - done) * kBlockRays);
    });
    done = next;
    out.rays = done * kUnit;
    out.error = box_error(boxes, target, replicates, mode);
    const bool clear = out.rays >= kFirstRays && out.error.c48.floor <= 0.5 * out.error.c48.excess;
    const bool late = 2.0 * seconds_since_start(begin) > max_s;
    if (clear || late || progress.stop_requested()) break;
    next = std::min(2 * done, std::max<std::uint64_t>(done, max_rays / kUnit));
  }
  out.efficiency =
      replicate_share(replicates, [](const BoxSums& r) { return r.out_direct + r.out_reflected; });
  out.absorbed = replicate_share(replicates, [](const BoxSums& r) { return r.bodies; });
  out.lost = replicate_share(replicates, [](const BoxSums& r) { return r.lost; });
  out.seconds = seconds_since_start(begin);
  return out;
}

}  // namespace lucerna
