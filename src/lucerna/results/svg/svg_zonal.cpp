// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_zonal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/photometric_metrics.h"

namespace lucerna {

std::string zonal_svg(const IntensityDistribution& d, const DiagramOptions& options) {
  check_drawable(d, "zonal diagram");
  constexpr std::size_t kZones = 18;
  constexpr double kLeft = 96.0, kRight = 430.0, kTop = 92.0, kRow = 22.0;
  std::array<double, kZones> flux{};
  for (std::size_t i = 0; i < kZones; ++i)
    flux[i] = zonal_flux(d, 10.0 * static_cast<double>(i), 10.0 * static_cast<double>(i + 1));
  const double all = total_flux(d), max = *std::max_element(flux.begin(), flux.end());
  const double step = nice_step(max, 5);
  const double bottom = kTop + kRow * kZones;
  const PlotAxis x{0.0, max > 0.0 ? step * std::ceil(max / step - 1e-9) : 1.0, kLeft, kRight};
  const PlotAxis y{0.0, 180.0, kTop, bottom};

  SvgCanvas canvas(660.0, bottom + 60.0);
  canvas.data("plot", "zonal");
  canvas.data("x", x.data());
  canvas.data("y", y.data());
  canvas.data("zones", fmt::format("{:.6g}", fmt::join(flux, " ")));
  const double down = zonal_flux(d, 0.0, 90.0);
  const auto percent = [&](double part) { return all > 0.0 ? 100.0 * part / all : 0.0; };
  draw_title(canvas, options.title.empty() ? "Zonal flux" : options.title,
             fmt::format("{} {} in all, {:.1f} % down, {:.1f} % up", label_number(all), symbol(d.unit),
                         percent(down), percent(all - down)));
  draw_grid(canvas, x, ticks(x, 5), "", y, {}, "");
  const SvgText head{.size = 12.0, .anchor = "end", .fill = "#444"};
  canvas.text({kLeft - 8.0, kTop - 8.0}, "γ", head);
  canvas.text({500.0, kTop - 8.0}, std::string(symbol(d.unit)), head);
  canvas.text({556.0, kTop - 8.0}, "%", head);
  canvas.text({640.0, kTop - 8.0}, "from 0°: %", head);
  for (std::size_t i = 0; i < kZones; ++i) {
    const double from = 10.0 * static_cast<double>(i), top = y.at(from);
    canvas.rectangle({kLeft, top + 3.0}, x.at(flux[i]) - kLeft, kRow - 6.0,
                     {.fill = std::string(kCurveColors[i < 9 ? 0 : 1])});
    const double base = top + 0.5 * kRow + 4.5;
    const SvgText number{.size = 12.0, .anchor = "end"};
    canvas.text({kLeft - 8.0, base}, fmt::format("{:g}–{:g}°", from, from + 10.0), number);
    canvas.text({500.0, base}, label_number(flux[i]), number);
    canvas.text({556.0, base}, fmt::format("{:.1f}", percent(flux[i])), number);
    canvas.text({640.0, base}, fmt::format("{:.1f}", percent(zonal_flux(d, 0.0, from + 10.0))), number);
  }
  canvas.line({kLeft - 60.0, y.at(90.0)}, {640.0, y.at(90.0)}, {.stroke = "#777", .width = 1.0});
  canvas.text({0.5 * (kLeft + kRight), bottom + 38.0}, fmt::format("flux in the zone, {}", symbol(d.unit)),
              {.size = 12.5, .anchor = "middle", .fill = "#444"});
  return canvas.str();
}

}  // namespace lucerna
