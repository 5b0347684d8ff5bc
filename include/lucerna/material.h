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

/// Index and absorption of a clear medium over wavelength, from samples at even steps, linear between them.
/// Beyond both ends they are those of the ends. Immutable and thread safe.
class Dispersion {
 public:
  /// Samples from `min_nm` to `max_nm`: indices, and absorption coefficients (natural, 1/mm) or none. Throws
  /// InputError unless 0 < min_nm < max_nm are finite, there are two samples or more, equally many of both
  /// (or no absorption), indices are 1 to 4, and coefficients finite and >= 0.
  Dispersion(double min_nm, double max_nm, std::vector<double> index,
             std::vector<double> absorption_per_mm = {});

  /// Where samples begin.
  double min_nm() const { return min_nm_; }
  /// As far as there are samples.
  double max_nm() const { return max_nm_; }
  /// False: the medium's absorption is not part of it.
  bool has_absorption() const { return !absorption_per_mm_.empty(); }

  /// The index at a wavelength > 0. O(1).
  double index(double wavelength_nm) const { return at(index_, wavelength_nm); }
  /// The absorption coefficient at a wavelength > 0; 0 without `has_absorption`. O(1).
  double absorption_per_mm(double wavelength_nm) const {
    return has_absorption() ? at(absorption_per_mm_, wavelength_nm) : 0.0;
  }

 private:
  double at(const std::vector<double>& samples, double wavelength_nm) const;

  double min_nm_, max_nm_;
  std::vector<double> index_, absorption_per_mm_;
};

/// `refractive_index` of a clear medium over its whole range, within 1e-5. No absorption. Throws InputError
/// for a metal, and for a name that is not known. Thread safe.
[[nodiscard]] Dispersion dispersion(std::string_view material);

/// The share of unpolarised light that a smooth boundary from air to `medium` reflects, by Fresnel's formulas
/// with a complex index. `cos_incidence` in [0, 1]. Thread safe.
[[nodiscard]] double fresnel_reflectance(double cos_incidence, const RefractiveIndex& medium);

}  // namespace lucerna
#pragma GCC visibility pop
