// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#pragma GCC visibility push(default)
namespace lucerna {

/// Complex refractive index n + ik of a medium at one wavelength, in air.
struct RefractiveIndex {
  /// Ratio of the speeds of light; > 0.
  double n = 1.0;
  /// Extinction coefficient; 0 for a clear medium, whose weak absorption is not part of this table.
  double k = 0.0;
};

/// What is known of a material.
struct MaterialInfo {
  /// As `refractive_index` takes it: "aluminium", "bk7".
  std::string name;
  /// What was measured.
  std::string meaning;
  /// Where the numbers were published.
  std::string source;
  /// The wavelengths that there are numbers for.
  double min_nm = 0.0, max_nm = 0.0;
  /// An opaque mirror, or a clear medium.
  bool is_metal = false;
};

/// All materials: metals first, each group by name. Thread safe.
[[nodiscard]] std::vector<MaterialInfo> materials();

/// The index of a material at a wavelength in vacuum. Clear media by their dispersion formula, metals by
/// linear interpolation between 20 nm. Throws InputError for a name that is not known (naming the nearest)
/// and for a wavelength out of the material's range. Thread safe.
[[nodiscard]] RefractiveIndex refractive_index(std::string_view material, double wavelength_nm);

/// The share of unpolarised light that a smooth boundary from air to `medium` reflects, by Fresnel's formulas
/// with a complex index. `cos_incidence` in [0, 1]. Thread safe.
[[nodiscard]] double fresnel_reflectance(double cos_incidence, const RefractiveIndex& medium);

}  // namespace lucerna
#pragma GCC visibility pop
