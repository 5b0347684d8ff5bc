// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

/// Deals the rays of a run, numbered 0, 1, 2, ..., to the sources. Which source a number belongs to is fixed
/// by whole shares alone, in a balanced word: of the first n numbers, source s has n * share(s) / sum of
/// shares to within 1 + log2(number of sources), and exactly share(s) of the first sum of shares. Built as a
/// binary tree of two-letter balanced words, so that a count costs O(log sources). Thread safe.
class SourceInterleaving {
 public:
  /// At least one share; each > 0; their sum below 2^62.
  explicit SourceInterleaving(const std::vector<std::uint64_t>& shares);

  std::uint64_t total() const { return nodes_.back().total; }
  std::uint64_t share(std::size_t source) const { return nodes_[source].total; }

  /// How many of the numbers 0 .. n - 1 belong to `source`.
  std::uint64_t count(std::size_t source, std::uint64_t n) const;

 private:
  struct Node {
    std::uint64_t total;
    std::size_t parent;
    bool is_left;
    std::uint64_t left_total;
  };
  std::vector<Node> nodes_;  ///< sources first, root last
};

/// A run of consecutive rays of one source, all of one block.
struct SourceRun {
  std::size_t source = 0;
  /// Index of its first ray in the stream that `sequence_seed` starts, and how many there are.
  std::uint64_t first = 0, count = 0;
  std::uint64_t sequence_seed = 0;
};

/// The numbering of the rays of one run: pure arithmetic, so that any part of it can be traced anywhere.
/// Block b (rays 512 b .. 512 b + 511) belongs to replicate b mod 16. A source that any number of rays can be
/// drawn from has a stream of its own in every replicate, seeded by (seed, source, replicate); block b = 16 j
/// + r takes a slot of that stream, slot j. A finite source (a ray file) has one stream, seeded by (seed,
/// source), through all replicates, so that every ray of it comes exactly once in the first total() numbers.
class RayNumbering {
 public:
  /// A ray file takes a share of as many numbers as it has rays; other sources share 2^20 in proportion to
  /// their flux.
  RayNumbering(const std::vector<PlacedSource>& sources, std::uint64_t seed);

  /// Rays of a run whose number is not given: the sum of all shares.
  std::uint64_t default_count() const { return word_.total(); }
  /// One past the last ray of a trace for which `asked` was: the rays of a file count once, for the same ones
  /// again would make errors smaller than they are.
  std::uint64_t last_ray(std::optional<std::uint64_t> asked) const;
  const SourceInterleaving& word() const { return word_; }
  /// Flux of a ray of weight 1 of `source`, in units of the run's mean ray.
  double ray_flux(std::size_t source) const { return streams_[source].ray_flux; }

  /// The runs that make up the rays [first, last), which must lie in one block.
  std::vector<SourceRun> runs(std::uint64_t first, std::uint64_t last) const;

 private:
  struct Stream {
    bool finite;
    /// Numbers that a block sets aside in a replicate's stream.
    std::uint64_t slot;
    double ray_flux;
  };
  SourceInterleaving word_;
  std::vector<Stream> streams_;
  std::uint64_t seed_;
};

}  // namespace lucerna
