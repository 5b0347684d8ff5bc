// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

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

}  // namespace lucerna
