// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/backward/backward_estimator.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

BackwardEstimator::BackwardEstimator(const Scene& scene, int max_bounces) : sampler_(scene, max_bounces) {}

std::vector<BackwardEstimator::WayOut> BackwardEstimator::ways_out(const DirectionCell& cell) const {
  std::vector<WayOut> ways;
  for (const Exit exit : sampler_.scene().exits()) {
    const Direction before = sampler_.scene().direction_before(exit, cell.centre());
    ways.push_back({exit, sampler_.guide().for_directions(before, cell.radius_rad())});
  }
  return ways;
}

template <class Sink>
void BackwardEstimator::sample_mirrors(const DirectionCell& cell, const WayOut& way, std::uint64_t samples,
                                       std::uint64_t seed, const Sink& sink) const {
  const Sequence sequence(SequenceKind::sobol, seed);
  const BackwardScene& scene = sampler_.scene();
  BackwardScene::Scratch scratch;
  for (std::uint64_t i = 0; i < samples; ++i) {
    const auto u = sequence.point<4>(i);
    const TypeCAngles angles = cell.at(u[2], u[3]);
    const MirrorPlace place = way.guide.place(u[0], u[1]);
    const auto from = mirror_point(scene, place);
    if (!from) continue;
    const Direction start = scene.direction_before(way.exit, direction_from_type_c(angles));
    const double cd = sampler_.intensity_sample(place, *from, start, way.exit, {seed, i, 0}, scratch);
    if (cd > 0.0) sink(u[2], angles, cd / static_cast<double>(samples));
  }
}

template <class Sink>
void BackwardEstimator::sample_source(const DirectionCell& cell, Exit exit, std::size_t source,
                                      std::uint64_t samples, std::uint64_t seed, const Sink& sink) const {
  const Sequence sequence(SequenceKind::sobol, seed);
  const LineDisks& disks = sampler_.disks()[source];
  const BackwardScene& scene = sampler_.scene();
  BackwardScene::Scratch scratch;
  for (std::uint64_t i = 0; i < samples; ++i) {
    const auto u = sequence.point<4>(i);
    const TypeCAngles angles = cell.at(u[2], u[3]);
    const Direction start = scene.direction_before(exit, direction_from_type_c(angles));
    const LineDisks::Place place = disks.place(u[0], u[1], start);
    const double luminance =
        scene.direct_luminance(scene.sources()[source], {place.point_mm, start}, exit, {seed, i, 0}, scratch);
    if (luminance > 0.0) sink(u[2], angles, luminance / place.pdf_area / static_cast<double>(samples));
  }
}

template <class Sink>
void BackwardEstimator::sample_cell(const DirectionCell& cell, std::span<const WayOut> ways,
                                    std::uint64_t samples, std::uint64_t seed, const Sink& sink) const {
  for (const WayOut& way : ways) {
    if (!way.guide.empty()) sample_mirrors(cell, way, samples, seed, sink);
    for (std::size_t s = 0; s < sampler_.disks().size(); ++s)
      sample_source(cell, way.exit, s, direct_samples(samples), source_stream(seed, s), sink);
  }
}

std::vector<double> BackwardEstimator::cell_flux(const DirectionCell& cell, std::size_t c_parts,
                                                 std::size_t gamma_parts, std::uint64_t samples,
                                                 std::span<const std::uint64_t> seeds) const {
  const std::vector<WayOut> ways = ways_out(cell);
  const double solid_angle = cell.solid_angle_sr(), height = cell.gamma1_rad - cell.gamma0_rad;
  const auto part = [](double u, std::size_t parts) {
    return std::min(parts - 1, static_cast<std::size_t>(std::max(0.0, u) * static_cast<double>(parts)));
  };
  std::vector<double> flux(seeds.size() * c_parts * gamma_parts, 0.0);
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    const std::span<double> to = std::span(flux).subspan(k * c_parts * gamma_parts, c_parts * gamma_parts);
    sample_cell(cell, ways, samples, seeds[k], [&](double u, const TypeCAngles& a, double cd) {
      const std::size_t g = part((a.gamma_rad - cell.gamma0_rad) / height, gamma_parts);
      to[part(u, c_parts) * gamma_parts + g] += cd * solid_angle;
    });
  }
  return flux;
}

Estimate BackwardEstimator::intensity_cd(const Direction& direction, std::uint64_t samples,
                                         std::uint64_t replicates, std::uint64_t seed) const {
  LUCERNA_CHECK(replicates >= 2, "{} replicates", replicates);
  const TypeCAngles a = type_c_angles(direction);
  const DirectionCell cell{a.c_rad, a.c_rad, a.gamma_rad, a.gamma_rad};
  const std::vector<WayOut> ways = ways_out(cell);
  std::vector<double> cd(replicates, 0.0);
  parallel_blocks(replicates, 1, [&](std::size_t r, std::size_t) {
    sample_cell(cell, ways, samples, detail::mix_bits(seed * replicates + r),
                [&](double, const TypeCAngles&, double part) { cd[r] += part; });
  });
  return mean_estimate(cd);
}

}  // namespace lucerna
