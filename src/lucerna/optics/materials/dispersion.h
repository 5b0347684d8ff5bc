// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "lucerna/material.h"

namespace lucerna {

/// Sellmeier: n^2 = 1 + sum of strength * w^2 / (w^2 - resonance_um2), w the wavelength in um.
struct SellmeierTerm {
  double strength, resonance_um2;
};
double sellmeier_index(std::span<const SellmeierTerm> terms, double wavelength_um);

/// A sum of factor * w^power, w the wavelength in um: of n or, in other publications, of n^2.
struct PowerTerm {
  double factor;
  int power;
};
double power_sum(std::span<const PowerTerm> terms, double wavelength_um);

/// One row of a table of a metal.
struct MetalRow {
  double wavelength_um, n, k;
};
/// Linear between the rows, whose wavelengths ascend; `wavelength_um` within them.
RefractiveIndex interpolated(std::span<const MetalRow> rows, double wavelength_um);

/// `value(nm)` at even steps from `min_nm` to `max_nm`: of at most a nanometre, but at most 100 000.
template <class Value>
std::vector<double> each_nanometre(double min_nm, double max_nm, const Value& value) {
  const auto steps = static_cast<std::size_t>(std::clamp(std::ceil(max_nm - min_nm), 1.0, 1e5));
  std::vector<double> out;
  for (std::size_t i = 0; i <= steps; ++i)
    out.push_back(value(std::lerp(min_nm, max_nm, static_cast<double>(i) / static_cast<double>(steps))));
  return out;
}

}  // namespace lucerna
