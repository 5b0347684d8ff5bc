// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/metrics/figure_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lucerna {

std::string figure_text(double value) {
  if (!std::isfinite(value)) return kNoFigure;
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  if (size != 0.0 && (size < 1e-4 || size >= 1e9)) return fmt::format("{:.4e}", value);
  const int before = size >= 1.0 ? static_cast<int>(std::floor(std::log10(size))) + 1 : 0;
  const int leading_zeros =
      size > 0.0 && size < 0.1 ? -static_cast<int>(std::floor(std::log10(size))) - 1 : 0;
  std::string text = fmt::format("{:.{}f}", value, std::max(0, 5 - before + leading_zeros));
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

std::string figure_text(double value, double standard_error) {
  // As `estimate_text`: rounding is no error.
  constexpr double kRounding = 1e-12;
  if (!std::isfinite(value) || !std::isfinite(standard_error) ||
      !(standard_error > kRounding * std::abs(value)))
    return figure_text(value);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(standard_error))), 0, 9);
  return fmt::format("{:.{}f} ± {:.{}f}", value, decimals, standard_error, decimals);
}

}  // namespace lucerna
