// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lucerna/estimate.h"
#include "lucerna/random.h"
#include "lucerna/trace/backward/backward_sampler.h"
#include "lucerna/trace/detectors/direction_cell.h"

namespace lucerna {

/// Intensity without bins: an integral over the mirrors of the luminance that is seen through them, and over
/// the sources of what they send directly (one mirror: S. Hirst, J. Muschaweck, P. Benitez, 2018). Places on
/// the mirrors, lines past the sources and directions within a cell are Owen-scrambled Sobol points; each
/// seed is an independent replicate. Unbiased for every number of samples, but for light that `start_on`
/// moves (support.h). Immutable and thread safe; the scene must outlive it.
class BackwardEstimator {
 public:
  /// Throws as BackwardSampler.
  explicit BackwardEstimator(const Scene& scene, int max_bounces = 100);

  /// Flux towards a cell of directions, cut into c_parts x gamma_parts equal steps of C and gamma, once for
  /// each seed: that of part (c, gamma) by seed k is [(k * c_parts + c) * gamma_parts + gamma]. `samples`
  /// rays by mirrors and a quarter of that by each source directly; powers of two are best. About 1 us each.
  std::vector<double> cell_flux(const DirectionCell& cell, std::size_t c_parts, std::size_t gamma_parts,
                                std::uint64_t samples, std::span<const std::uint64_t> seeds) const;

  /// Intensity along one direction from `replicates` >= 2 times `samples`, with its standard error.
  Estimate intensity_cd(const Direction& direction, std::uint64_t samples, std::uint64_t replicates = 16,
                        std::uint64_t seed = 1) const;

 private:
  /// A way out of the luminaire, and where the mirrors send light of a cell that takes it.
  struct WayOut {
    Exit exit;
    CellGuide guide;
  };
  std::vector<WayOut> ways_out(const DirectionCell& cell) const;
  /// One sample: a direction of the cell and what it adds to the mean intensity there.
  template <class Sink>
  void sample_mirrors(const DirectionCell& cell, const WayOut& way, std::uint64_t samples, std::uint64_t seed,
                      const Sink& sink) const;
  template <class Sink>
  void sample_source(const DirectionCell& cell, Exit exit, std::size_t source, std::uint64_t samples,
                     std::uint64_t seed, const Sink& sink) const;
  template <class Sink>
  void sample_cell(const DirectionCell& cell, std::span<const WayOut> ways, std::uint64_t samples,
                   std::uint64_t seed, const Sink& sink) const;

  BackwardSampler sampler_;
};

}  // namespace lucerna
