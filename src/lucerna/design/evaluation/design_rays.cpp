// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/design_rays.h"

#include <algorithm>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/counted_progress.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/evaluation/device_evaluator.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

std::vector<PlacedSource> checked(std::vector<PlacedSource> sources) {
  Scene scene;
  scene.sources = std::move(sources);
  check(scene);
  return scene.sources;
}

/// As RayNumbering deals them: a file by its rays, other sources by their flux.
std::vector<std::uint64_t> shares(const std::vector<PlacedSource>& sources) {
  const RayNumbering numbering(sources, 0);
  std::vector<std::uint64_t> out;
  for (std::size_t i = 0; i < sources.size(); ++i) out.push_back(numbering.word().share(i));
  return out;
}

}  // namespace

DesignRays::DesignRays(std::vector<PlacedSource> sources, const Frame& mirror_from_world, std::uint64_t seed)
    : sources_(checked(std::move(sources))),
      mirror_from_world_(mirror_from_world),
      word_(shares(sources_)),
      seed_(seed) {
  flux_ = total_flux(sources_);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const double share = static_cast<double>(word_.share(i)) / static_cast<double>(word_.total());
    ray_flux_.push_back(sources_[i].total_flux() / flux_ / share);
  }
}

void DesignRays::grow(std::uint64_t n, Progress& progress) {
  const std::uint64_t unit = kBlockRays * kDesignTasks;
  const std::size_t blocks = (n + unit - 1) / unit * kDesignTasks, old = block_.size();
  if (blocks <= old) return;
  block_.resize(blocks);
  CountedProgress counted(progress, "rays", 0, (blocks - old) * kBlockRays);
  parallel_blocks(blocks - old, kDesignTasks, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = old + first; b < old + last; ++b) fill(b);
    counted.add((last - first) * kBlockRays);
  });
}

double DesignRays::share_left(std::uint64_t count) const {
  double left = 0.0;
  const std::uint64_t blocks = count / kBlockRays;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    for (const float w : block_[b].weight) left += static_cast<double>(w);
  }
  return left / static_cast<double>(blocks * kBlockRays);
}

RayBlock DesignRays::first(std::uint64_t max) const {
  const std::uint64_t blocks = std::min(max, size()) / kBlockRays;
  RayBlock out;
  out.reserve(blocks * kBlockRays);
  const auto append = [](std::vector<float>& to, const std::array<float, kBlockRays>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (std::uint64_t b = 0; b < blocks; ++b) {
    append(out.x_mm, block_[b].x_mm);
    append(out.y_mm, block_[b].y_mm);
    append(out.z_mm, block_[b].z_mm);
    append(out.kx, block_[b].kx);
    append(out.ky, block_[b].ky);
    append(out.kz, block_[b].kz);
    append(out.weight, block_[b].weight);
  }
  return out;
}

void DesignRays::evaluate_on(std::shared_ptr<Accelerator> accelerator) {
  device_ = accelerator ? std::make_shared<DeviceEvaluator>(std::move(accelerator)) : nullptr;
}

void DesignRays::refract(const MediumView& medium, Pass into) {
  LUCERNA_CHECK(block_.empty(), "{} rays were drawn before they were to enter a lens", size());
  medium_ = medium;
  into_ = std::move(into);
}

void DesignRays::refract_in(const MediumView& medium, DesignShape last) {
  LUCERNA_CHECK(!into_ && std::holds_alternative<BsplineShape>(last.family()),
                "a last face that is no free form, or one of rays that have come into the lens ({})",
                static_cast<bool>(into_));
  medium_ = medium;
  last_ = std::move(last);
}

void DesignRays::fill(std::uint64_t b) {
  Block& block = block_[b];
  std::size_t at = 0;
  RayBlock rays;
  const std::uint64_t stream = b % kDesignStreams, first = b / kDesignStreams * kBlockRays;
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    const PlacedSource& source = sources_[k];
    const Frame mirror_from_source = mirror_from_world_ * source.world_from_source;
    const std::uint64_t from = word_.count(k, first), to = word_.count(k, first + kBlockRays);
    if (from == to) continue;
    rays.resize(to - from, 0);
    const std::uint64_t seed = detail::mix_bits(seed_ * 0x9E3779B97F4A7C15ull + k * kDesignStreams + stream);
    source.rays->emit(Sequence(SequenceKind::sobol, seed), from, rays);
    for (std::size_t i = 0; i < rays.size(); ++i, ++at) {
      Ray ray = mirror_from_source.ray(rays.ray(i));
      const double left = into_ ? into_(ray) : 1.0;
      block.x_mm[at] = static_cast<float>(ray.origin_mm.x);
      block.y_mm[at] = static_cast<float>(ray.origin_mm.y);
      block.z_mm[at] = static_cast<float>(ray.origin_mm.z);
      block.kx[at] = static_cast<float>(ray.direction.x());
      block.ky[at] = static_cast<float>(ray.direction.y());
      block.kz[at] = static_cast<float>(ray.direction.z());
      block.weight[at] = static_cast<float>(left * static_cast<double>(rays.weight[i]) * ray_flux_[k]);
    }
  }
  LUCERNA_CHECK(at == kBlockRays, "{} rays in a block", at);
}

}  // namespace lucerna
