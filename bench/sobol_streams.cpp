// SPDX-License-Identifier: Apache-2.0
// What the standard errors of Sobol runs cost: the noise of a far field (15 x 1 degrees, share of all flux,
// relative RMS against 32 M rays of other seeds, mean of 8 seeds, 4 of the longest run) of N rays in the
// tracer's 16 scrambled streams, in one stream of N, and of independent random rays. A disk and a cylinder at
// the focus of a paraboloid. Usage: bench_sobol_streams
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/engines/trace_engine.h"

namespace {

using namespace lucerna;

enum class Streams { sixteen, one, random };
constexpr std::uint64_t kRun = 512;  // rays that an engine takes at once

Scene lamp(bool disk) {
  const Direction down = Direction::from({0, 0, -1});
  EmitterOptions shape{.kind = EmitterKind::cylinder, .radius_mm = 1.0, .length_mm = 6.0};
  if (disk) shape = {.kind = EmitterKind::disk, .radius_mm = 1.0};
  Scene scene;
  // The disk looks into a mirror below it, the cylinder stands in one above it.
  scene.sources = {{make_emitter(shape), disk ? Frame::from_axis(down, 0.0, {}) : Frame(), std::nullopt}};
  const Frame placed =
      disk ? Frame::from_axis(Direction{}, 0.0, {0, 0, -15}) : Frame::from_axis(down, 0.0, {0, 0, 15});
  scene.reflectors.push_back({conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0)),
                              placed, Reflectance(1.0), 0.0});
  scene.far_fields = {{"far", 15.0, 1.0}};
  return scene;
}

/// Shares of the flux by cell of the grid, from the finer cells that are counted.
std::vector<double> grid_shares(const FarFieldDetector& detector, const Tally& tally) {
  const FarFieldGrid grid(detector), counted = FarFieldGrid::counted(detector);
  const FarFieldParts parts = counted_parts(detector);
  std::vector<double> shares(grid.size());
  for (std::size_t i = 0; i < counted.size(); ++i) {
    const std::size_t c = (i / counted.gamma_count() + parts.c / 2) / parts.c % grid.c_count();
    const std::size_t g = (i % counted.gamma_count() + parts.gamma / 2) / parts.gamma;
    shares[c * grid.gamma_count() + g] +=
        static_cast<double>(tally.bins[0][i]) / static_cast<double>(tally.emitted);
  }
  return shares;
}

/// Shares of the flux by far-field cell.
std::vector<double> far_shares(const Scene& scene, Streams streams, std::uint64_t rays, std::uint64_t seed) {
  TraceOptions options;
  options.seed = seed;
  options.sequence = streams == Streams::random ? SequenceKind::random : SequenceKind::sobol;
  options.cells = 512;
  const RayNumbering numbering(scene.sources, seed);
  const auto engine = make_wavefront_engine(scene, numbering, options);
  Tally tally = engine->empty_tally();
  TraceScratch scratch;
  for (std::uint64_t at = 0; at < rays; at += kRun) {
    if (streams == Streams::one) {
      engine->trace_run({0, at, kRun, 7919 * seed + 1}, scratch, tally);
    } else {
      for (const SourceRun& run : numbering.runs(at, at + kRun)) engine->trace_run(run, scratch, tally);
    }
  }
  return grid_shares(scene.far_fields[0], tally);
}

void run(const char* name, const Scene& scene) {
  std::vector<double> truth(FarFieldGrid(scene.far_fields[0]).size());
  constexpr int kTruths = 4;
  for (int k = 0; k < kTruths; ++k) {
    const auto p = far_shares(scene, Streams::one, 1u << 23, 1000u + static_cast<std::uint64_t>(k));
    for (std::size_t i = 0; i < p.size(); ++i) truth[i] += p[i] / kTruths;
  }
  double square = 0.0;
  for (const double x : truth) square += x * x;
  const auto error = [&](Streams streams, int log2_rays) {
    const int seeds = log2_rays < 20 ? 8 : 4;
    double sum = 0.0;
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto p =
          far_shares(scene, streams, std::uint64_t{1} << log2_rays, static_cast<std::uint64_t>(seed));
      for (std::size_t i = 0; i < p.size(); ++i) sum += (p[i] - truth[i]) * (p[i] - truth[i]);
    }
    return 100.0 * std::sqrt(sum / (seeds * square));
  };
  for (const int n : {14, 16, 18, 20}) {
    fmt::print("| {} | 2^{} | {:.2f} % | {:.2f} % | {:.2f} % |\n", name, n, error(Streams::sixteen, n),
               error(Streams::one, n), error(Streams::random, n));
  }
}

}  // namespace

int main() {
  const ThreadLimit one(1);
  fmt::print("| source | rays | 16 streams | one | random |\n|---|---|---|---|---|\n");
  run("disk", lamp(true));
  run("cylinder", lamp(false));
}
