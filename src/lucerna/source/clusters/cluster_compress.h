// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "lucerna/progress.h"
#include "lucerna/ray_file.h"
#include "lucerna/rays.h"
#include "lucerna/source/clusters/cluster_model.h"

namespace lucerna {

/// The defaults and what they rest on are in docs/theory/clusters.md, "Thresholds".
struct ClusterOptions {
  /// Largest file in bytes, at least 2000: where the penalty below gives more, it is raised. Absent =
  /// whatever the other thresholds give.
  std::optional<std::uint64_t> max_bytes;
  /// Size to use up, at least 2000: the penalty is raised or lowered until the file has at most this and, if
  /// the rays have that much to tell, 95 % of it. A model larger than the default's is nearer to its rays,
  /// not always to their source. Not together with `max_bytes`.
  std::optional<std::uint64_t> target_bytes;
  /// Most clusters; where more are worth their price, the price is raised. At least `min_clusters`.
  std::optional<std::size_t> max_clusters;
  /// Of the choice of rays that decide which clusters are removed.
  std::uint64_t seed = 1;
  /// Nats of log-likelihood that a split of a directional distribution must gain. More = smaller, coarser
  /// models.
  double penalty_nats = 6.0;
  /// Price of a cluster in splits: what its removal may cost.
  double cluster_price = 2.5;
  /// Fewest rays that a leaf of the first octree may be filled with before it is split, and most leaves: for
  /// more rays leaves hold more.
  std::size_t min_rays_per_leaf = 64, max_leaves = 30'000;
  /// Rays that take part in the removal; the rest come back for the final distributions.
  std::size_t removal_rays = std::size_t{1} << 22;
  /// Clusters that always stay: with fewer on a closed surface, parts of it lie on triangles that are no part
  /// of it.
  std::size_t min_clusters = 32;
  /// Weights of directions are stored in steps of 2^(level_step / 16): 1 to 16.
  int level_step = 8;
  /// Total flux; absent = the header's.
  std::optional<double> flux;
};

/// What happened on the way.
struct ClusterStatistics {
  std::uint64_t rays = 0;
  std::size_t octree_leaves = 0, rounds = 0, clusters = 0, triangles = 0, cells = 0, cells_with_light = 0;
  /// Penalty and price of the model: not the options' where a size or a number of clusters was asked for.
  double penalty_nats = 0.0, cluster_price = 0.0;
  std::uint64_t bytes = 0;
  double seconds_octree = 0.0, seconds_removal = 0.0, seconds_final = 0.0;
};

/// Compresses a ray set to Mas-Martin-Patow clusters (docs/theory/clusters.md): octree, removal of
/// clusters, directional distributions, mesh. Throws InputError without rays or flux, or if the size cannot
/// be met. Same seed, same bits, for any number of threads. About 70 bytes a ray beside the ray set.
std::unique_ptr<ClusterModel> compress_clusters(const RaySet& rays, const ClusterOptions& options = {},
                                                Progress& progress = no_progress(),
                                                ClusterStatistics* statistics = nullptr);

/// The same for a file: reads all of it first (28 bytes a ray).
std::unique_ptr<ClusterModel> compress_clusters(RayReader& reader, const ClusterOptions& options = {},
                                                Progress& progress = no_progress(),
                                                ClusterStatistics* statistics = nullptr);

}  // namespace lucerna
