// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

/// Statistical tests for the tests labelled `statistical`. One false-alarm level for the whole suite: at 1e-6
/// a red test means a bug, and seeds are fixed, so a green one stays green. Never re-seed to get green.
namespace lucerna::test {

inline constexpr double kFalseAlarm = 1e-6;

/// Regularised upper incomplete gamma function Q(a, x): series below x < a + 1, Lentz's continued fraction
/// above (Numerical Recipes, 3rd ed., section 6.2).
inline double gamma_q(double a, double x) {
  if (x <= 0.0) return 1.0;
  const double front = std::exp(-x + a * std::log(x) - std::lgamma(a));
  if (x < a + 1.0) {
    double term = 1.0 / a, sum = term;
    for (int n = 1; n < 10000 && term > 1e-17 * sum; ++n) sum += term *= x / (a + n);
    return 1.0 - front * sum;
  }
  double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, h = d;
  for (int i = 1; i < 10000; ++i) {
    const double an = -i * (i - a);
    b += 2.0;
    d = 1.0 / (an * d + b);
    c = b + an / c;
    h *= d * c;
    if (std::abs(d * c - 1.0) < 1e-16) break;
  }
  return front * h;
}

/// p-value of Pearson's chi-square for counts against expectations with the same total. Cells that expect
/// fewer than 5 are pooled; a hit where nothing is expected gives 0.
inline double chi_square_p(std::span<const double> observed, std::span<const double> expected) {
  double chi2 = 0.0, pooled_observed = 0.0, pooled_expected = 0.0;
  int cells = 0;
  const auto add = [&](double o, double e) {
    chi2 += (o - e) * (o - e) / e;
    ++cells;
  };
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] <= 0.0) {
      if (observed[i] > 0.0) return 0.0;
    } else if (expected[i] < 5.0) {
      pooled_observed += observed[i];
      pooled_expected += expected[i];
    } else {
      add(observed[i], expected[i]);
    }
  }
  if (pooled_expected > 0.0) add(pooled_observed, pooled_expected);
  return cells < 2 ? 1.0 : gamma_q(0.5 * (cells - 1), 0.5 * chi2);
}

/// Chi-square against equal expectations.
inline double chi_square_uniform_p(std::span<const double> observed) {
  const double total = std::accumulate(observed.begin(), observed.end(), 0.0);
  const std::vector<double> expected(observed.size(), total / static_cast<double>(observed.size()));
  return chi_square_p(observed, expected);
}

/// The power of a chi-square test: the root-mean-square relative deviation of the cells' true shares from the
/// expected ones that is rejected in 999 of 1000 draws of `n` counts over `cells` equal cells. Smaller ones
/// may pass. The statistic is then about normal with mean v + l and variance 2 v + 4 l, v = cells - 1, l = n
/// times the deviation's square (P. B. Patnaik, Biometrika 36, 1949).
inline double seen_deviation(double n, double cells) {
  const double v = cells - 1.0;
  double low = v, high = 1e3 * (v + 100.0);
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (gamma_q(0.5 * v, 0.5 * middle) > kFalseAlarm ? low : high) = middle;
  }
  const double critical = high;
  low = 0.0, high = 1e3 * critical;
  for (int i = 0; i < 200; ++i) {
    const double l = 0.5 * (low + high);
    (v + l - 3.09 * std::sqrt(2.0 * v + 4.0 * l) < critical ? low : high) = l;
  }
  return std::sqrt(high / n);
}

/// Two-sided p-value of a standard normal deviate.
inline double normal_p(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

}  // namespace lucerna::test
