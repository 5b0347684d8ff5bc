// SPDX-License-Identifier: Apache-2.0
#include "lucerna/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

namespace {

/// The power of ten of the last digit that is printed of an error.
int last_place(double error) {
  const int leading = static_cast<int>(std::floor(std::log10(error)));
  const double first = error / std::pow(10.0, leading);
  // 0.96 to one digit is 1, whose place is one higher.
  if (first >= 9.5) return leading;
  return first < 1.95 ? leading - 1 : leading;
}

/// Errors below this share of the value are what sums of exact numbers leave.
constexpr double kRounding = 1e-12;

}  // namespace

Estimate mean_estimate(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  double mean = 0.0, squares = 0.0;
  for (const double v : values) mean += v / n;
  if (values.size() < 2) return {mean, std::numeric_limits<double>::quiet_NaN()};
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / (n * (n - 1.0)))};
}

std::string estimate_text(const Estimate& e, std::string_view unit) {
  if (e.mean == 0.0 && std::signbit(e.mean)) return estimate_text({0.0, e.standard_error}, unit);
  const std::string tail = unit.empty() ? std::string() : fmt::format(" {}", unit);
  if (!(std::isfinite(e.standard_error) && e.standard_error > kRounding * std::abs(e.mean) &&
        std::isfinite(e.mean)))
    return fmt::format("{:.5g}{}", e.mean, tail);
  const int place = last_place(e.standard_error);
  if (place < -9 || place > 9) return fmt::format("{:.5g} +- {:.1g}{}", e.mean, e.standard_error, tail);
  const double step = std::pow(10.0, place);
  const auto rounded = [&](double x) { return place > 0 ? std::round(x / step) * step : x; };
  const int decimals = std::max(0, -place);
  return fmt::format("{:.{}f} +- {:.{}f}{}", rounded(e.mean), decimals, rounded(e.standard_error), decimals,
                     tail);
}

std::string share_text(const Estimate& e) {
  return estimate_text({100.0 * e.mean, 100.0 * e.standard_error}, "%");
}

}  // namespace lucerna
