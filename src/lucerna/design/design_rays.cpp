// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/design_rays.h"

#include <atomic>
#include <utility>

#include "lucerna/core/parallel.h"

namespace lucerna {

namespace {

std::vector<PlacedSource> checked(std::vector<PlacedSource> sources) {
  Scene scene;
  scene.sources = std::move(sources);
  check(scene);
  return scene.sources;
}

}  // namespace

DesignRays::DesignRays(std::vector<PlacedSource> sources, const Frame& mirror_from_world, std::uint64_t seed)
    : sources_(checked(std::move(sources))),
      mirror_from_world_(mirror_from_world),
      numbering_(sources_, seed) {
  for (const PlacedSource& s : sources_) flux_ += s.total_flux();
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const double share =
        static_cast<double>(numbering_.word().share(i)) / static_cast<double>(numbering_.word().total());
    ray_flux_.push_back(sources_[i].total_flux() / flux_ / share);
  }
}

void DesignRays::grow(std::uint64_t n, Progress& progress) {
  const std::uint64_t unit = kBlockRays * kReplicates;
  const std::size_t blocks = (n + unit - 1) / unit * kReplicates, old = block_.size();
  if (blocks <= old) return;
  block_.resize(blocks);
  std::atomic<std::uint64_t> done{0};
  parallel_blocks(blocks - old, kReplicates, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = old + first; b < old + last; ++b) fill(b);
    done += last - first;
    progress.update("rays", done * kBlockRays, (blocks - old) * kBlockRays);
  });
}

void DesignRays::fill(std::uint64_t b) {
  Block& block = block_[b];
  std::size_t at = 0;
  RayBlock rays;
  for (const SourceRun& run : numbering_.runs(b * kBlockRays, (b + 1) * kBlockRays)) {
    const PlacedSource& source = sources_[run.source];
    const Frame mirror_from_source = mirror_from_world_ * source.world_from_source;
    rays.resize(run.count, 0);
    source.rays->emit(Sequence(SequenceKind::sobol, run.sequence_seed), run.first, rays);
    for (std::size_t i = 0; i < rays.size(); ++i, ++at) {
      const Ray ray = mirror_from_source.ray(rays.ray(i));
      block.x_mm[at] = static_cast<float>(ray.origin_mm.x);
      block.y_mm[at] = static_cast<float>(ray.origin_mm.y);
      block.z_mm[at] = static_cast<float>(ray.origin_mm.z);
      block.kx[at] = static_cast<float>(ray.direction.x());
      block.ky[at] = static_cast<float>(ray.direction.y());
      block.kz[at] = static_cast<float>(ray.direction.z());
      block.weight[at] = static_cast<float>(static_cast<double>(rays.weight[i]) * ray_flux_[run.source]);
    }
  }
  LUCERNA_CHECK(at == kBlockRays, "{} rays in a block", at);
}

}  // namespace lucerna
