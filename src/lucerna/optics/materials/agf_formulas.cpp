// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/materials/agf_formulas.h"

#include <array>
#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

// Which power of the wavelength each coefficient of n^2 belongs to.
constexpr std::array kSchott{0, 2, -2, -4, -6, -8};
constexpr std::array kExtended{0, 2, -2, -4, -6, -8, -10, -12};
constexpr std::array kExtended2{0, 2, -2, -4, -6, -8, 4, 6};
constexpr std::array kExtended3{0, 2, 4, -2, -4, -6, -8, -10, -12};

constexpr std::array<std::size_t, kAgfFormulas> kCoefficients{
    kSchott.size(), 6, 6, 5, 3, 8, 4, 4, 5, kExtended.size(), 10, kExtended2.size(), kExtended3.size()};

double powers(std::span<const int> power, std::span<const double> c, double w) {
  double sum = 0.0;
  for (std::size_t i = 0; i < power.size(); ++i) sum += c[i] * std::pow(w, power[i]);
  return sum;
}

/// Pairs of a strength and the square of a resonance.
double resonances(std::span<const double> pairs, double w2) {
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.size(); i += 2) sum += pairs[i] * w2 / (w2 - pairs[i + 1]);
  return sum;
}

double herzberger(std::span<const double> c, double w2) {
  const double l = 1.0 / (w2 - 0.028);
  return c[0] + l * (c[1] + l * c[2]) + w2 * (c[3] + w2 * (c[4] + w2 * c[5]));
}

double conrady(std::span<const double> c, double w) { return c[0] + c[1] / w + c[2] / std::pow(w, 3.5); }

/// Of the formulas that give n^2.
double squared_index(int formula, std::span<const double> c, double w) {
  const double w2 = w * w;
  switch (formula) {
    case 1:
      return powers(kSchott, c, w);
    case 2:   // Sellmeier 1
    case 6:   // Sellmeier 3
    case 11:  // Sellmeier 5
      return 1.0 + resonances(c, w2);
    case 4:  // Sellmeier 2: resonances themselves, and a second term of another form
      return 1.0 + c[0] + c[1] * w2 / (w2 - c[2] * c[2]) + c[3] / (w2 - c[4] * c[4]);
    case 7:  // Handbook of Optics 1
      return c[0] + c[1] / (w2 - c[2]) - c[3] * w2;
    case 8:  // Handbook of Optics 2
      return c[0] + c[1] * w2 / (w2 - c[2]) - c[3] * w2;
    case 9:  // Sellmeier 4
      return c[0] + resonances(c.subspan(1), w2);
    case 10:
      return powers(kExtended, c, w);
    case 12:
      return powers(kExtended2, c, w);
    default:
      return powers(kExtended3, c, w);
  }
}

}  // namespace

std::size_t agf_coefficients(int formula) {
  LUCERNA_CHECK(formula >= 1 && formula <= kAgfFormulas, "formula {}", formula);
  return kCoefficients[static_cast<std::size_t>(formula) - 1];
}

double agf_index(int formula, std::span<const double> coefficients, double wavelength_um) {
  const auto c = coefficients.first(agf_coefficients(formula));
  if (formula == 3) return herzberger(c, wavelength_um * wavelength_um);
  if (formula == 5) return conrady(c, wavelength_um);
  return std::sqrt(squared_index(formula, c, wavelength_um));
}

}  // namespace lucerna
