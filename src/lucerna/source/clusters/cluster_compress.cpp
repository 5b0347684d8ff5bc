// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_compress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/source/clusters/cluster_build.h"
#include "lucerna/source/clusters/cluster_removal.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMinBytes = 2000;
/// A search for a size ends with at least this share of it used, or when it has tried so many penalties.
constexpr double kUsedShare = 0.95;
constexpr int kMaxTrials = 14;
/// Below, every ray has a triangle of directions of its own; above, there is no split.
constexpr double kMinPenalty = 0.02, kLargestPenalty = 1e9;

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
    const Vec3 radius_vector = p.rays.origin_mm(i) - p.surface.centre_mm;
    chosen[k] = {static_cast<float>(radius_vector.x),
                 static_cast<float>(radius_vector.y),
                 static_cast<float>(radius_vector.z),
                 p.code[i],
                 p.rays.weight[i],
                 p.leaf_cluster[leaf]};
  }
  return chosen;
}

/// Clusters left by a removal at some penalty, and the rays that decide the next.
struct Removal {
  double penalty = 0.0;
  std::vector<std::uint32_t> retained;
  std::vector<ClusterRay> rays;
};

class Compressor {
 public:
  Compressor(const PreparedRays& prepared, const ClusterOptions& options, const ClusterData& totals,
             Progress& progress, ClusterStatistics& statistics)
      : prepared_(prepared),
        options_(options),
        totals_(totals),
        progress_(progress),
        statistics_(statistics) {
    base_.retained.resize(prepared.place.size());
    std::iota(base_.retained.begin(), base_.retained.end(), 0u);
    base_.rays = removal_rays(prepared, options.removal_rays, options.seed);
  }

  ClusterData run() {
    const std::optional<std::uint64_t> limit =
        options_.max_bytes ? options_.max_bytes : options_.target_bytes;
    Made first = make(options_.penalty_nats);
    const bool done = !limit || (options_.max_bytes && first.bytes <= *limit);
    Made best = done ? std::move(first) : search(std::move(first), *limit);
    if (limit && best.bytes > *limit)
      throw InputError(fmt::format("these rays do not fit in {} bytes", *limit));
    statistics_.penalty_nats = best.penalty;
    statistics_.cluster_price = best.price;
    statistics_.bytes = best.bytes;
    return std::move(best.data);
  }

 private:
  struct Made {
    double penalty = 0.0, price = 0.0;
    std::uint64_t bytes = 0;
    ClusterData data;
    Removal removal;
  };

  /// The model at a penalty, from the removal at the largest penalty below that is known to leave too much.
  Made make(double penalty) {
    Clock clock;
    Made made{penalty, options_.cluster_price, 0, {}, base_};
    remove(made);
    statistics_.seconds_removal += clock.lap();
    progress_.step("compress: distributions", 0, 0);
    const AssignedRays assigned = assign_rays(prepared_, made.removal.retained);
    made.data = assigned.data;
    made.data.flux = totals_.flux;
    made.data.flux_unit = totals_.flux_unit;
    made.data.training_rays = totals_.training_rays;
    set_directions(assigned, penalty, options_.level_step, made.data);
    made.bytes = encode_nfl(encode_clusters(made.data)).size();
    statistics_.seconds_final += clock.lap();
    return made;
  }

  void remove(Made& made) {
    if (!prepared_.surface.has_area()) return;
    Removal& r = made.removal;
    for (;; made.price *= 1.6) {
      RemovalResult result =
          remove_clusters(prepared_.surface, prepared_.point_mm, r.rays, std::move(r.retained),
                          {made.penalty, made.price, options_.min_clusters}, progress_);
      r.retained = std::move(result.retained);
      statistics_.rounds += result.rounds;
      if (!options_.max_clusters || r.retained.size() <= *options_.max_clusters) break;
      if (made.price * made.penalty > kLargestPenalty) break;
    }
    r.penalty = made.penalty;
  }

  /// Sizes fall with the penalty, nearly as a power of it between two tries: regula falsi in the logarithms,
  /// kept off the ends of the bracket.
  Made search(Made made, std::uint64_t limit) {
    double low = 0.0, low_bytes = 0.0, high = 0.0,
           high_bytes = 0.0;  // penalties of too large and of good files
    std::optional<Made> best;
    for (int trials = 1;; ++trials) {
      const double bytes = static_cast<double>(made.bytes), penalty = made.penalty;
      const double over = bytes / static_cast<double>(limit);
      if (made.bytes > limit) {
        low = penalty;
        low_bytes = bytes;
        base_ = std::move(made.removal);
        if (!best) best = std::move(made);
      } else {
        high = penalty;
        high_bytes = bytes;
        best = std::move(made);
        if (over >= kUsedShare) break;
      }
      if (low >= kLargestPenalty || (high > 0.0 && high <= kMinPenalty)) break;
      if (high > 0.0 && (trials >= kMaxTrials || high < 1.005 * low)) break;
      const double factor = std::pow(over, 0.8);
      double next = penalty * (over > 1.0 ? std::clamp(factor, trials < kMaxTrials ? 1.15 : 10.0, 10.0)
                                          : std::clamp(factor, 0.1, 0.87));
      if (low > 0.0 && high > 0.0) {
        const double goal = std::log(0.975 * static_cast<double>(limit));
        const double t = (std::log(low_bytes) - goal) / std::max(1e-9, std::log(low_bytes / high_bytes));
        next = low * std::pow(high / low, std::clamp(t, 0.15, 0.85));
      }
      made = make(std::clamp(next, kMinPenalty, kLargestPenalty));
    }
    return std::move(*best);
  }

  const PreparedRays& prepared_;
  const ClusterOptions& options_;
  const ClusterData& totals_;
  Progress& progress_;
  ClusterStatistics& statistics_;
  Removal base_;
};

void check(const ClusterOptions& options) {
  if (options.max_bytes && options.target_bytes)
    throw UsageError("a largest size or a size to use up, not both");
  for (const auto& bytes : {options.max_bytes, options.target_bytes}) {
    if (bytes && *bytes < kMinBytes) {
      throw UsageError(fmt::format("a model of at most {} bytes; at least {} are needed", *bytes, kMinBytes));
    }
  }
  if (!(options.penalty_nats >= kMinPenalty) || !(options.cluster_price >= 0.0)) {
    throw UsageError(fmt::format("a penalty of {} nats and a price of {}; at least {} and 0 are expected",
                                 options.penalty_nats, options.cluster_price, kMinPenalty));
  }
  if (options.max_clusters && *options.max_clusters < options.min_clusters) {
    throw UsageError(fmt::format("at most {} clusters; at least {} are kept", *options.max_clusters,
                                 options.min_clusters));
  }
  if (options.level_step < 1 || options.level_step > 16) {
    throw UsageError(fmt::format("a step of {} levels; 1 to 16 are expected", options.level_step));
  }
}

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
  check(options);
  Clock clock;
  progress.step("compress: octree", 0, 0);
  const PreparedRays prepared = prepare_rays(set.rays, options.min_rays_per_leaf, options.max_leaves);
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
