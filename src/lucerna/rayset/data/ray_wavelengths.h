// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/rays.h"
#include "lucerna/rayset/data/spectrum_sampler.h"

namespace lucerna {

/// A wavelength for each ray of a set: the ray's own; else one drawn from the spectrum that its index names
/// (the first one where it names none), whatever the order of the rays; else the one that all rays have.
/// Thread safe.
class RayWavelengths {
 public:
  /// `drawn`: what a ray is a share of, power or the lumens of that power. `unknown_nm`: of rays where
  /// nothing is known.
  RayWavelengths(const RaySetHeader& header, FluxUnit drawn, float unknown_nm = 0.0F);

  /// The column of RayBlock::extra that has them; absent if there is none.
  std::optional<std::size_t> column() const { return column_; }
  bool are_known() const { return column_ || are_drawn() || one_nm_; }
  /// From the ray's own columns?
  bool differ_by_ray() const { return column_ || (are_drawn() && index_ && spectra_.size() > 1); }
  /// From spectra?
  bool are_drawn() const { return !column_ && !spectra_.empty(); }

  /// In nm, of ray `i` of `block`, which is ray `number` (from 0) of the whole set.
  float of(const RayBlock& block, std::size_t i, std::uint64_t number) const;

 private:
  std::optional<std::size_t> column_, index_;
  std::vector<SpectrumSampler> spectra_;
  std::optional<float> one_nm_;
  float unknown_nm_;
};

/// What a writer says that gives each ray a wavelength, 555 nm where none is known: a sentence where they are
/// drawn or unknown, else empty.
std::string wavelengths_warning(const RayWavelengths& wavelengths);
/// The peak of V(lambda).
inline constexpr float kGreen_nm = 555.0F;

}  // namespace lucerna
