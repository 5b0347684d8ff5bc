// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lucerna/detectors.h"
#include "lucerna/trace/backward/backward_sampler.h"

namespace lucerna {

/// Why light cannot be followed backward from a detector through a scene; empty if it can.
/// `no_backward_reason`, and not through a cover glass, which moves lines aside.
std::string no_backward_image_reason(const Scene& scene);

/// Illuminance and luminance in the cells of a detector by light that is followed backward from there: what a
/// trace counts, for detectors that few of its rays find. Unbiased for every number of samples, with the
/// limits of BackwardEstimator. Each seed is an independent replicate. Immutable and thread safe; the scene
/// must outlive it.
class BackwardImage {
 public:
  /// Throws as BackwardSampler, and InputError with `no_backward_image_reason`.
  BackwardImage(const Scene& scene, int max_bounces);

  /// Whether a plane is far enough from every source and mirror to look at them from there.
  bool can_see(const PlaneGrid& grid) const;

  /// Flux / m^2 on the lit side of a cell, one value a seed: `samples` rays by mirrors and a quarter of that
  /// by each source directly, about 1 us each. The grid must be one that `can_see`.
  std::vector<double> illuminance(const PlaneGrid& grid, std::size_t cell, std::uint64_t samples,
                                  std::span<const std::uint64_t> seeds) const;
  /// Flux / (m^2 sr) of a cell, one value a seed, by `samples` lines through it.
  std::vector<double> luminance(const LuminanceDetector& detector, std::size_t cell, std::uint64_t samples,
                                std::span<const std::uint64_t> seeds) const;

 private:
  double by_mirrors(const PlaneGrid& grid, std::size_t cell, const CellGuide& guide, std::uint64_t samples,
                    std::uint64_t seed) const;
  double by_source(const PlaneGrid& grid, std::size_t cell, std::size_t source, std::uint64_t samples,
                   std::uint64_t seed) const;

  BackwardSampler sampler_;
};

}  // namespace lucerna
