// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/materials/dispersion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

double sellmeier_index(std::span<const SellmeierTerm> terms, double wavelength_um) {
  const double w2 = wavelength_um * wavelength_um;
  double squared = 1.0;
  for (const SellmeierTerm& t : terms) squared += t.strength * w2 / (w2 - t.resonance_um2);
  return std::sqrt(squared);
}

double power_sum(std::span<const PowerTerm> terms, double wavelength_um) {
  double sum = 0.0;
  for (const PowerTerm& t : terms) sum += t.factor * std::pow(wavelength_um, t.power);
  return sum;
}

Dispersion::Dispersion(double min_nm, double max_nm, std::vector<double> index,
                       std::vector<double> absorption_per_mm)
    : min_nm_(min_nm),
      max_nm_(max_nm),
      index_(std::move(index)),
      absorption_per_mm_(std::move(absorption_per_mm)) {
  if (!(min_nm > 0.0 && min_nm < max_nm && std::isfinite(max_nm)))
    throw InputError(
        fmt::format("dispersion: found {} to {} nm, expected ascending wavelengths above 0", min_nm, max_nm));
  if (index_.size() < 2 || (has_absorption() && absorption_per_mm_.size() != index_.size())) {
    throw InputError(
        fmt::format("dispersion: found {} indices and {} absorption coefficients, expected two "
                    "or more, equally many of both or no coefficients",
                    index_.size(), absorption_per_mm_.size()));
  }
  for (const double n : index_) {
    if (!(n >= 1.0 && n <= 4.0))
      throw InputError(fmt::format("dispersion: found the index {}, expected 1 to 4", n));
  }
  for (const double a : absorption_per_mm_) {
    if (!(a >= 0.0 && std::isfinite(a)))
      throw InputError(
          fmt::format("dispersion: found an absorption of {} / mm, expected a finite number >= 0", a));
  }
}

double Dispersion::at(const std::vector<double>& samples, double wavelength_nm) const {
  const double last = static_cast<double>(samples.size() - 1);
  const double place = std::clamp((wavelength_nm - min_nm_) / (max_nm_ - min_nm_), 0.0, 1.0) * last;
  const auto below = std::min(static_cast<std::size_t>(place), samples.size() - 2);
  return std::lerp(samples[below], samples[below + 1], place - static_cast<double>(below));
}

RefractiveIndex interpolated(std::span<const MetalRow> rows, double wavelength_um) {
  const auto after = std::ranges::upper_bound(rows, wavelength_um, {}, &MetalRow::wavelength_um);
  if (after == rows.end()) return {rows.back().n, rows.back().k};
  if (after == rows.begin()) return {after->n, after->k};
  const MetalRow &b = *after, &a = *(after - 1);
  const double t = (wavelength_um - a.wavelength_um) / (b.wavelength_um - a.wavelength_um);
  return {std::lerp(a.n, b.n, t), std::lerp(a.k, b.k, t)};
}

}  // namespace lucerna
