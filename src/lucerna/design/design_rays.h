// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lucerna/core/progress.h"
#include "lucerna/rayset/ray_block.h"
#include "lucerna/trace/ray_numbering.h"

namespace lucerna {

/// Independent streams that a design's rays are dealt to: the fewest whose difference shows the noise. Fewer
/// and longer Owen-scrambled nets are better: on a bench mirror 4 M rays of one stream have half the noise of
/// 16 streams of a sixteenth.
inline constexpr std::size_t kDesignStreams = 2;
/// What blocks of rays are padded to and dealt by, so that the order of summing is fixed.
inline constexpr std::size_t kDesignTasks = 16;

/// The rays that every evaluation of a design traces again (common random numbers), in the frame of the
/// mirror. Block b of kBlockRays rays belongs to stream b mod kDesignStreams; within a stream, sources take
/// their shares by SourceWord and each has a Sobol sequence of its own. Grows on demand and never changes
/// what is there. 28 bytes per ray. Not thread safe while it grows.
class DesignRays {
 public:
  /// `sources` in the luminaire frame. Throws InputError as `check(Scene)` does for sources.
  DesignRays(std::vector<PlacedSource> sources, const Frame& mirror_from_world, std::uint64_t seed);

  /// Makes sure that there are at least `n` rays (rounded up to kDesignTasks blocks). Progress phase "rays".
  void grow(std::uint64_t n, Progress& progress = no_progress());

  std::uint64_t size() const { return block_.size() * kBlockRays; }
  /// Flux of all sources, in their unit.
  double flux() const { return flux_; }
  FluxUnit unit() const { return sources_.front().rays->flux_unit(); }

  struct Block {
    std::array<float, kBlockRays> x_mm, y_mm, z_mm, kx, ky, kz;
    /// Flux in mean rays.
    std::array<float, kBlockRays> weight;
  };
  const Block& block(std::uint64_t b) const { return block_[b]; }
  /// A copy of the first `most` rays (whole blocks of them), for what takes ray sets.
  RayBlock first(std::uint64_t most) const;

 private:
  void fill(std::uint64_t b);

  std::vector<PlacedSource> sources_;
  Frame mirror_from_world_;
  SourceWord word_;
  std::uint64_t seed_;
  double flux_ = 0.0;
  std::vector<double> ray_flux_;
  std::vector<Block> block_;
};

}  // namespace lucerna
