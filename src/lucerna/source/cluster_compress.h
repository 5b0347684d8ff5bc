// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "lucerna/core/progress.h"
#include "lucerna/rayset/ray_set.h"
#include "lucerna/rayset/ray_stream.h"
#include "lucerna/source/cluster_model.h"

namespace lucerna {

/// Defaults are those of the sweeps in docs/algorithms/clusters.md.
struct ClusterOptions {
  /// Largest file in bytes; absent = whatever the other thresholds give. At least 2000.
  std::optional<std::uint64_t> max_bytes;
  /// Of the choice of rays that decide which clusters are removed.
  std::uint64_t seed = 1;
  /// Nats of log-likelihood that a split of a directional distribution must gain. More = smaller, coarser
  /// models.
  double penalty_nats = 6.0;
  /// Price of a cluster in splits: what its removal may cost.
  double cluster_price = 5.0;
  /// Rays in a leaf of the first octree: a 10,000th of all, but at least this.
  std::size_t min_rays_per_leaf = 64;
  /// Rays that take part in the removal; the rest come back for the final distributions.
  std::size_t removal_rays = std::size_t{1} << 21;
  /// Total flux; absent = the header's.
  std::optional<double> flux;
};

/// What happened on the way.
struct ClusterStatistics {
  std::uint64_t rays = 0;
  std::size_t octree_leaves = 0, rounds = 0, clusters = 0, triangles = 0, cells = 0, cells_with_light = 0;
  /// Penalty of the final distributions: above the option's where `max_bytes` asked for it.
  double penalty_nats = 0.0;
  std::uint64_t bytes = 0;
  double seconds_octree = 0.0, seconds_removal = 0.0, seconds_final = 0.0;
};

/// Compresses a ray set by the seed's method (docs/algorithms/clusters.md): octree, removal of clusters,
/// directional distributions, mesh. Throws InputError without rays or flux, or if `max_bytes` cannot be met.
/// Same seed, same bits, for any number of threads. About 70 bytes a ray beside the ray set.
std::unique_ptr<ClusterModel> compress_clusters(const RaySet& rays, const ClusterOptions& options = {},
                                                Progress& progress = no_progress(),
                                                ClusterStatistics* statistics = nullptr);

/// The same for a file: reads all of it first (28 bytes a ray).
std::unique_ptr<ClusterModel> compress_clusters(RayReader& reader, const ClusterOptions& options = {},
                                                Progress& progress = no_progress(),
                                                ClusterStatistics* statistics = nullptr);

}  // namespace lucerna
