// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_isolux.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lucerna/photometric_metrics.h"
#include "lucerna/results/svg/svg_contour.h"

namespace lucerna {

namespace {

constexpr std::size_t kCells = 151, kLevels = 9;

/// Round illuminances 1, 2, 5 times powers of ten below `largest`, descending.
std::vector<double> round_levels(double largest) {
  std::vector<double> levels;
  if (!(largest > 0.0)) return levels;
  for (int power = static_cast<int>(std::floor(std::log10(largest))); levels.size() < kLevels; --power) {
    for (const double factor : {5.0, 2.0, 1.0}) {
      const double level = factor * std::pow(10.0, power);
      if (level < largest && levels.size() < kLevels) levels.push_back(level);
    }
  }
  return levels;
}

std::string size_text(const LitArea& area) {
  return fmt::format("{}{} m ({} x {} m)", area.cut ? "> " : "", label_number(area.diameter_mm / 1000.0),
                     label_number(area.width_x_mm / 1000.0), label_number(area.width_y_mm / 1000.0));
}

void draw_levels(SvgCanvas& canvas, const SampledField& field, const std::vector<double>& levels,
                 SvgPoint scale, const std::string& unit) {
  const auto color = [&](std::size_t i) {
    // The brighter half of viridis under the lines, so that lines and numbers stay legible.
    return viridis(1.0 - 0.75 * static_cast<double>(i) / static_cast<double>(kLevels - 1));
  };
  for (std::size_t i = levels.size(); i-- > 0;)
    canvas.area(thinned(contour_rings(field, levels[i])), {.fill = color(i)});
  for (const double level : levels) {
    for (const auto& line : contour_lines(field, level))
      canvas.polyline(thinned(line), {.stroke = "#222", .width = 0.8});
  }
  LineLabels labels;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (const auto& line : contour_lines(field, levels[i]))
      labels.write(canvas, line, label_number(levels[i]), 0.4 + 0.1 * static_cast<double>(i % 3), 90.0);
  }
  canvas.text({scale.x, scale.y - 10.0}, "at least, " + unit, {.size = 12.0, .fill = "#444"});
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const double y = scale.y + 20.0 * static_cast<double>(i);
    canvas.rectangle({scale.x, y}, 16.0, 16.0, {.stroke = "#777", .width = 0.6, .fill = color(i)});
    canvas.text({scale.x + 22.0, y + 12.5}, label_number(levels[i]), {.size = 12.0});
  }
}

}  // namespace

std::string isolux_svg(const PlaneIlluminance& e, FluxUnit flux_unit, const std::string& title,
                       const std::string& below) {
  const std::string unit = flux_unit == FluxUnit::lumen ? "lx" : "W/m²";
  constexpr double kLeft = 74.0, kTop = 84.0, kSize = 420.0;
  const IlluminatedPlane& plane = e.plane;
  const double larger = std::max(plane.size_x_mm, plane.size_y_mm);
  const double width = kSize * plane.size_x_mm / larger, height = kSize * plane.size_y_mm / larger;
  const double half_x = 0.0005 * plane.size_x_mm, half_y = 0.0005 * plane.size_y_mm;
  const PlotAxis x{-half_x, half_x, kLeft, kLeft + width}, y{-half_y, half_y, kTop + height, kTop};
  SampledField field;
  for (std::size_t i = 0; i < plane.nx; ++i) field.x.push_back(x.at(plane.x_mm(i) / 1000.0));
  for (std::size_t i = 0; i < plane.ny; ++i) field.y.push_back(y.at(plane.y_mm(i) / 1000.0));
  field.value = e.lx;

  SvgCanvas canvas(640.0, kTop + std::max(height, 220.0) + 132.0);
  canvas.data("plot", "isolux");
  canvas.data("x", x.data());
  canvas.data("y", y.data());
  draw_title(canvas, title.empty() ? "Isolux diagram" : title, below);
  draw_levels(canvas, field, round_levels(e.max_lx), {kLeft + kSize + 22.0, kTop + 16.0}, unit);
  draw_grid(canvas, x, ticks(x, 8), "", y, ticks(y, 8), "");
  canvas.text({kLeft + width, kTop + height + 36.0}, "x, m", {.size = 12.0, .anchor = "end", .fill = "#555"});
  canvas.text({kLeft, kTop - 8.0}, "y, m", {.size = 12.0, .fill = "#555"});
  const double text_y = kTop + std::max(height, 220.0) + 56.0;
  canvas.text({kLeft, text_y},
              fmt::format("E at the centre {} · mean {} · min {} {} · U0 {}", label_number(e.centre_lx),
                          label_number(e.mean_lx), label_number(e.min_lx), unit, label_number(e.uniformity)));
  canvas.text({kLeft, text_y + 19.0},
              fmt::format("Largest {} {} at x {}, y {} m", label_number(e.max_lx), unit,
                          label_number(e.max_x_mm / 1000.0), label_number(e.max_y_mm / 1000.0)));
  canvas.text({kLeft, text_y + 38.0}, "Diameter (x by y) at 50 %: " + size_text(e.half));
  canvas.text({kLeft, text_y + 57.0}, "and at 10 %: " + size_text(e.tenth));
  return canvas.str();
}

std::string isolux_svg(const IntensityDistribution& d, const IsoluxOptions& options) {
  check_drawable(d, "isolux diagram");
  const bool up = axis_gamma_deg(d) > 90.0;
  IlluminatedPlane plane{
      .luminaire_from_plane = plane_frame({.distance_mm = 1000.0 * options.distance_m,
                                           .aim = Direction::from_unit({0.0, 0.0, up ? 1.0 : -1.0})}),
      .nx = kCells,
      .ny = kCells};
  PlaneIlluminance e;
  for (const double distances : {1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0}) {
    plane.size_x_mm = 1000.0 * options.size_m.value_or(distances * options.distance_m);
    plane.size_y_mm = plane.size_x_mm;
    e = plane_illuminance(d, plane);
    if (options.size_m || !lit_area(e, 0.05).cut) break;
  }
  return isolux_svg(e, d.unit, options.diagram.title,
                    fmt::format("plane {:g} m {} the luminaire – C0 is right, {} is up", options.distance_m,
                                up ? "above" : "below", up ? "C270" : "C90"));
}

}  // namespace lucerna
