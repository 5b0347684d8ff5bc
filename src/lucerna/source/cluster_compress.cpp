// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/cluster_compress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "lucerna/core/error.h"
#include "lucerna/core/random.h"
#include "lucerna/source/cluster_build.h"
#include "lucerna/source/cluster_removal.h"

namespace lucerna {

namespace {

/// The seed's figure: 20,000 to 30,000 leaves suffice for 10 M rays, which a 10,000th of the rays per leaf
/// gives.
constexpr std::size_t kRaysPerLeafShare = 10'000;
constexpr std::uint64_t kLeastBytes = 2000;
/// A cluster's point, density and two triangles, in bytes; they get at most this share of the file.
constexpr double kClusterBytes = 15.0, kClusterShare = 0.3;
/// The final penalty may be this much above that of the removal before clusters are removed again.
constexpr double kPenaltyRatio = 2.5;
constexpr double kLargestPenalty = 1e9;

class Clock {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Rays for the removal: one at random out of each of `count` equal runs of the octree's order, or all.
std::vector<ClusterRay> removal_rays(const PreparedRays& p, std::size_t count, std::uint64_t seed) {
  const std::size_t n = p.rays.size(), m = std::min(n, std::max<std::size_t>(1, count));
  std::vector<ClusterRay> chosen(m);
  std::size_t leaf = 0;
  for (std::size_t k = 0; k < m; ++k) {
    const double u = m == n ? 0.0 : Rng(seed, k).uniform();
    const auto i = std::min(n - 1, static_cast<std::size_t>((static_cast<double>(k) + u) *
                                                            static_cast<double>(n) / static_cast<double>(m)));
    while (p.leaf_begin[leaf + 1] <= i) ++leaf;
    const Vec3 arm = p.rays.origin_mm(i) - p.surface.centre_mm;
    chosen[k] = {static_cast<float>(arm.x), static_cast<float>(arm.y), static_cast<float>(arm.z), p.code[i],
                 p.rays.weight[i],          p.leaf_cluster[leaf]};
  }
  return chosen;
}

class Compressor {
 public:
  Compressor(const PreparedRays& prepared, const ClusterOptions& options, const ClusterData& totals,
             Progress& progress, ClusterStatistics& statistics)
      : prepared_(prepared),
        options_(options),
        totals_(totals),
        progress_(progress),
        statistics_(statistics),
        rays_(removal_rays(prepared, options.removal_rays, options.seed)),
        kept_(prepared.place.size()) {
    std::iota(kept_.begin(), kept_.end(), 0u);
  }

  ClusterData run() {
    Clock clock;
    for (double penalty = options_.penalty_nats; penalty < kLargestPenalty; penalty *= 1.6) {
      remove(penalty);
      statistics_.seconds_removal += clock.lap();
      const double fixed = kClusterBytes * static_cast<double>(kept_.size());
      const bool removable = prepared_.surface.has_area() && kept_.size() > 32;
      if (removable && options_.max_bytes && fixed > kClusterShare * static_cast<double>(*options_.max_bytes))
        continue;
      const bool fits = finish(penalty, removable ? kPenaltyRatio * penalty : kLargestPenalty);
      statistics_.seconds_final += clock.lap();
      if (fits) return std::move(data_);
    }
    throw InputError(fmt::format("these rays do not fit in {} bytes", *options_.max_bytes));
  }

 private:
  void remove(double penalty) {
    if (!prepared_.surface.has_area()) return;
    const RemovalOptions options{penalty, options_.cluster_price};
    RemovalResult result =
        remove_clusters(prepared_.surface, prepared_.point_mm, rays_, std::move(kept_), options, progress_);
    kept_ = std::move(result.kept);
    statistics_.rounds += result.rounds;
  }

  /// Distributions from all rays, coarser ones while the file is too large.
  bool finish(double penalty, double largest) {
    progress_.step("compress: distributions", 0, 0);
    const AssignedRays assigned = assign_rays(prepared_, kept_);
    data_ = assigned.data;
    data_.flux = totals_.flux;
    data_.flux_unit = totals_.flux_unit;
    data_.training_rays = totals_.training_rays;
    for (double fine = penalty; fine <= largest;) {
      progress_.step("compress: distributions", 0, 0);
      set_directions(assigned, fine, data_);
      statistics_.penalty_nats = fine;
      statistics_.bytes = encode_nfl(encode_clusters(data_)).size();
      if (!options_.max_bytes || statistics_.bytes <= *options_.max_bytes) return true;
      // Sizes fall a little slower than the penalty rises.
      const double over = static_cast<double>(statistics_.bytes) / static_cast<double>(*options_.max_bytes);
      fine *= std::clamp(over, 1.03, 3.0);
    }
    return false;
  }

  const PreparedRays& prepared_;
  const ClusterOptions& options_;
  const ClusterData& totals_;
  Progress& progress_;
  ClusterStatistics& statistics_;
  std::vector<ClusterRay> rays_;
  std::vector<std::uint32_t> kept_;
  ClusterData data_;
};

}  // namespace

std::unique_ptr<ClusterModel> compress_clusters(const RaySet& set, const ClusterOptions& options,
                                                Progress& progress, ClusterStatistics* statistics) {
  ClusterStatistics unused;
  ClusterStatistics& s = statistics ? *statistics : unused;
  s = {};
  ClusterData totals;
  totals.flux = options.flux.value_or(set.header.flux().value_or(0.0));
  totals.flux_unit = set.header.flux_unit;
  if (!(totals.flux > 0.0) || !std::isfinite(totals.flux)) {
    throw InputError("the rays have no stated flux > 0; give one");
  }
  if (options.max_bytes && *options.max_bytes < kLeastBytes) {
    throw UsageError(
        fmt::format("a model of at most {} bytes; at least {} are needed", *options.max_bytes, kLeastBytes));
  }
  if (!(options.penalty_nats > 0.0) || !(options.cluster_price >= 0.0)) {
    throw UsageError("penalties and prices of a compression are > 0");
  }
  Clock clock;
  progress.step("compress: octree", 0, 0);
  const std::size_t per_leaf = std::max(options.min_rays_per_leaf, set.rays.size() / kRaysPerLeafShare);
  const PreparedRays prepared = prepare_rays(set.rays, per_leaf);
  totals.training_rays = prepared.rays.size();
  s.rays = prepared.rays.size();
  s.octree_leaves = prepared.leaf_begin.size() - 1;
  s.seconds_octree = clock.lap();
  auto model = std::make_unique<ClusterModel>(Compressor(prepared, options, totals, progress, s).run());
  s.clusters = model->clusters();
  s.triangles = model->triangles();
  s.cells = model->leaves();
  s.cells_with_light =
      static_cast<std::size_t>(std::count_if(model->data().leaf.begin(), model->data().leaf.end(),
                                             [](const ClusterLeaf& leaf) { return leaf.level > 0; }));
  return model;
}

std::unique_ptr<ClusterModel> compress_clusters(RayReader& reader, const ClusterOptions& options,
                                                Progress& progress, ClusterStatistics* statistics) {
  RaySet set;
  set.header = reader.header();
  set.rays.resize(0, set.header.columns.size());
  RayBlock block;
  while (reader.read(block, kStreamBlock) > 0) {
    progress.step("compress: read", set.rays.size(), reader.ray_count());
    set.rays.append(block);
  }
  return compress_clusters(set, options, progress, statistics);
}

}  // namespace lucerna
