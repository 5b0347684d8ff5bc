// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_validation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "lucerna/core/parallel/counted_progress.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kFirstRays = std::uint64_t{1} << 18;

/// Adds rays to the cells of the boxes.
class BoxTally {
 public:
  BoxTally(const ErrorBoxes& boxes, BoxSums& sums) : boxes_(boxes), sums_(sums) {}
  void emitted(double flux) { sums_.emitted += flux; }
  void absorbed(double flux) { sums_.bodies += flux; }
  void lost(double flux) { sums_.lost += flux; }
  void left(const Ray& ray, double flux, int surfaces) {
    const std::size_t cell = boxes_.cell(ray.origin_mm, ray.direction.vec());
    sums_.flux[cell] += flux;
    (surfaces > 0 ? sums_.out_reflected : sums_.out_direct) += flux;
    if (surfaces == 0) sums_.direct[cell] += flux;
  }

 private:
  const ErrorBoxes& boxes_;
  BoxSums& sums_;
};

double seconds_since_start(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

double error_with_light(const DesignError& error, double light_weight) {
  return std::hypot(error.c48.excess, std::sqrt(light_weight) * (1.0 - error.in_rectangle.mean));
}

LensValidation validate_lens(const Scene& scene, LensSurface surface, const ErrorBoxes& boxes,
                             std::span<const double> target, TargetMode mode, std::uint64_t seed,
                             std::uint64_t max_rays, double max_s, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const LensBlocks lens(scene, surface, seed ^ 0x56414C4944415445ull);
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
      BoxTally tally(boxes, replicates[r]);
      RayBlock rays;
      for (std::uint64_t j = done; j < next; ++j) lens.follow(kReplicates * j + r, rays, tally);
      replicates[r].rays += (next - done) * kBlockRays;
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
  out.has_light = std::any_of(replicates.begin(), replicates.end(),
                              [](const BoxSums& r) { return r.out_reflected + r.bodies + r.lost > 0.0; });
  out.efficiency =
      replicate_share(replicates, [](const BoxSums& r) { return r.out_direct + r.out_reflected; });
  out.absorbed = replicate_share(replicates, [](const BoxSums& r) { return r.bodies; });
  out.lost = replicate_share(replicates, [](const BoxSums& r) { return r.lost; });
  out.seconds = seconds_since_start(begin);
  return out;
}

}  // namespace lucerna
