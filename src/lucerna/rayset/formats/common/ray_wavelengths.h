// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/rays.h"
#include "lucerna/rayset/data/spectrum_sampler.h"

namespace lucerna {

/// A wavelength for each ray, for formats whose rays cannot be without: the ray's own; else the one that all
/// rays have; else one drawn evenly from the first spectral table; else 555 nm, the peak of V(lambda).
class RayWavelengths {
 public:
  /// Adds a sentence to `warnings` where wavelengths are drawn or unknown.
  RayWavelengths(const RaySetHeader& header, std::vector<std::string>& warnings);

  /// The column of RayBlock::extra that has them; absent if there is none.
  std::optional<std::size_t> column() const { return column_; }

  /// In nm, of ray `i` of `block`, which is ray `number` (from 0) of the whole set.
  float of(const RayBlock& block, std::size_t i, std::uint64_t number) const {
    if (column_) return block.extra[*column_][i];
    return spectrum_ ? (*spectrum_)(number) : one_nm_;
  }

 private:
  std::optional<std::size_t> column_;
  std::optional<SpectrumSampler> spectrum_;
  float one_nm_;
};

}  // namespace lucerna
