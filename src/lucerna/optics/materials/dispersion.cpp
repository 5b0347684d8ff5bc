// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/materials/dispersion.h"

#include <algorithm>
#include <cmath>

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

RefractiveIndex interpolated(std::span<const MetalRow> rows, double wavelength_um) {
  const auto after = std::ranges::upper_bound(rows, wavelength_um, {}, &MetalRow::wavelength_um);
  if (after == rows.end()) return {rows.back().n, rows.back().k};
  if (after == rows.begin()) return {after->n, after->k};
  const MetalRow &b = *after, &a = *(after - 1);
  const double t = (wavelength_um - a.wavelength_um) / (b.wavelength_um - a.wavelength_um);
  return {std::lerp(a.n, b.n, t), std::lerp(a.k, b.k, t)};
}

}  // namespace lucerna
