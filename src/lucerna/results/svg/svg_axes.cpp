// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

IntensityDistribution moved_by_errors(const IntensityDistribution& d, std::span<const double> standard_error,
                                      double errors) {
  LUCERNA_CHECK(standard_error.size() == d.cd.size(), "{} errors for {} values", standard_error.size(),
                d.cd.size());
  IntensityDistribution out = d;
  for (std::size_t i = 0; i < out.cd.size(); ++i)
    out.cd[i] = std::max(0.0, out.cd[i] + errors * standard_error[i]);
  return out;
}

ShownIntensity shown_intensity(const IntensityDistribution& distribution,
                               const std::optional<double>& lamp_flux_lm) {
  if (distribution.unit != FluxUnit::lumen) return {1.0, "W/sr"};
  if (lamp_flux_lm && *lamp_flux_lm > 0.0) return {1000.0 / *lamp_flux_lm, "cd/klm"};
  return {1.0, "cd"};
}

double PlotAxis::at(double value) const {
  const double share = log ? std::log(std::max(value, first) / first) / std::log(last / first)
                           : (value - first) / (last - first);
  return at_first + share * (at_last - at_first);
}

std::string PlotAxis::data() const {
  return fmt::format("{:g} {:g} {:.9g} {:.9g}{}", at_first, at_last, first, last, log ? " log" : "");
}

std::vector<double> ticks(const PlotAxis& axis, int wanted) {
  std::vector<double> values;
  if (axis.log) {
    for (int power = static_cast<int>(std::ceil(std::log10(axis.first) - 1e-9));
         power <= std::floor(std::log10(axis.last) + 1e-9); ++power)
      values.push_back(std::pow(10.0, power));
    return values;
  }
  const double step = nice_step(axis.last - axis.first, wanted);
  for (double i = std::ceil(axis.first / step - 1e-9); i * step <= axis.last + 1e-9 * step; i += 1.0)
    values.push_back(i * step + 0.0);
  return values;
}

std::vector<double> angle_ticks(double first_deg, double last_deg) {
  double step = 30.0;
  for (const double finer : {15.0, 10.0, 5.0, 2.0}) {
    if ((last_deg - first_deg) / finer <= 12.0 + 1e-9) step = finer;
  }
  std::vector<double> values;
  for (double i = std::ceil(first_deg / step - 1e-9); i * step <= last_deg + 1e-9; i += 1.0)
    values.push_back(i * step + 0.0);
  return values;
}

std::string degrees_text(const std::optional<double>& angle_deg) {
  return angle_deg ? fmt::format("{:.1f}°", *angle_deg) : "–";
}

void draw_grid(SvgCanvas& canvas, const PlotAxis& x, const std::vector<double>& x_ticks,
               const std::string& x_suffix, const PlotAxis& y, const std::vector<double>& y_ticks,
               const std::string& y_suffix) {
  const SvgStyle thin{.stroke = "#d4d4d4", .width = 0.8}, edge{.stroke = "#777", .width = 1.1};
  const double left = std::min(x.at_first, x.at_last), right = std::max(x.at_first, x.at_last);
  const double top = std::min(y.at_first, y.at_last), bottom = std::max(y.at_first, y.at_last);
  for (const double value : x_ticks) {
    canvas.line({x.at(value), top}, {x.at(value), bottom}, thin);
    canvas.text({x.at(value), bottom + 17.0}, label_number(value) + x_suffix,
                {.size = 12.0, .anchor = "middle"});
  }
  for (const double value : y_ticks) {
    canvas.line({left, y.at(value)}, {right, y.at(value)}, thin);
    canvas.text({left - 7.0, y.at(value) + 4.0}, label_number(value) + y_suffix,
                {.size = 12.0, .anchor = "end"});
  }
  canvas.rectangle({left, top}, right - left, bottom - top, edge);
}

void draw_title(SvgCanvas& canvas, const std::string& title, const std::string& below) {
  canvas.text({0.5 * canvas.width(), 28.0}, title, {.size = 17.0, .anchor = "middle", .bold = true});
  canvas.text({0.5 * canvas.width(), 48.0}, below, {.size = 12.5, .anchor = "middle", .fill = "#444"});
}

std::array<int, 3> viridis_rgb(double share) {
  static constexpr std::array<std::array<int, 3>, 9> kAnchors{{{0x44, 0x01, 0x54},
                                                               {0x47, 0x2d, 0x7b},
                                                               {0x3b, 0x52, 0x8b},
                                                               {0x2c, 0x72, 0x8e},
                                                               {0x21, 0x91, 0x8c},
                                                               {0x28, 0xae, 0x80},
                                                               {0x5e, 0xc9, 0x62},
                                                               {0xad, 0xdc, 0x30},
                                                               {0xfd, 0xe7, 0x25}}};
  const double place = 8.0 * std::clamp(share, 0.0, 1.0);
  const auto i = std::min<std::size_t>(7, static_cast<std::size_t>(place));
  const double t = place - static_cast<double>(i);
  std::array<int, 3> c{};
  for (std::size_t k = 0; k < 3; ++k)
    c[k] = static_cast<int>(std::lround((1.0 - t) * kAnchors[i][k] + t * kAnchors[i + 1][k]));
  return c;
}

std::string viridis(double share) {
  const auto [r, g, b] = viridis_rgb(share);
  return fmt::format("#{:02x}{:02x}{:02x}", r, g, b);
}

double range_holding(const IntensityDistribution& d, double axis_gamma_deg, double share,
                     const std::vector<double>& ranges_deg) {
  LUCERNA_CHECK(!ranges_deg.empty(), "no ranges");
  const auto angle = [&](std::size_t i) {
    return std::abs(d.gamma_deg[i % d.gamma_deg.size()] - axis_gamma_deg);
  };
  double peak = 0.0, widest = 0.0;
  for (std::size_t i = 0; i < d.cd.size(); ++i) {
    if (angle(i) <= ranges_deg.back()) peak = std::max(peak, d.cd[i]);
  }
  for (std::size_t i = 0; i < d.cd.size(); ++i) {
    if (peak > 0.0 && d.cd[i] >= share * peak && angle(i) <= ranges_deg.back())
      widest = std::max(widest, angle(i));
  }
  for (const double range : ranges_deg) {
    if (widest < range) return range;
  }
  return ranges_deg.back();
}

void check_drawable(const IntensityDistribution& distribution, const char* name) {
  if (const std::string fault = grid_fault(distribution); !fault.empty())
    throw InputError(std::string(name) + ": " + fault);
}

}  // namespace lucerna
