// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_isocandela.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "lucerna/photometric_metrics.h"
#include "lucerna/results/svg/svg_contour.h"

namespace lucerna {

namespace {

constexpr int kSamples = 181;
constexpr std::size_t kBands = std::size(kPeakShares);

/// Band 0 is the brightest; `kBands` is what lies below the last line.
std::string band_color(std::size_t band) {
  return viridis(1.0 - static_cast<double>(band) / static_cast<double>(kBands));
}

void draw_bands(SvgCanvas& canvas, const SampledField& field, double peak) {
  if (!(peak > 0.0)) return;
  for (std::size_t i = kBands; i-- > 0;)
    canvas.area(thinned(contour_rings(field, kPeakShares[i] * peak)), {.fill = band_color(i)});
}

/// What the bands or lines mean, from `at` downwards.
void draw_scale(SvgCanvas& canvas, SvgPoint at, double peak, const ShownIntensity& unit, bool lines) {
  const SvgText number{.size = 12.0, .anchor = "end"};
  canvas.text({at.x + 68.0, at.y - 10.0}, "of peak", {.size = 12.0, .anchor = "end", .fill = "#444"});
  canvas.text({at.x + 118.0, at.y - 10.0}, unit.name, {.size = 12.0, .anchor = "end", .fill = "#444"});
  for (std::size_t i = 0; i < kBands + (lines ? 0 : 1); ++i) {
    const double y = at.y + 20.0 * static_cast<double>(i);
    canvas.rectangle({at.x, y}, 16.0, 16.0, {.stroke = "#777", .width = 0.6, .fill = band_color(i)});
    const double share = kPeakShares[std::min(i, kBands - 1)];
    const std::string sign = lines ? "" : i == kBands ? "< " : "≥ ";
    canvas.text({at.x + 68.0, y + 12.5}, fmt::format("{}{:g} %", sign, 100.0 * share), number);
    canvas.text({at.x + 118.0, y + 12.5}, label_number(share * peak * unit.per_cd), number);
  }
}

/// Direction of H and V (degrees) about the axis: +V is C0; +H is C270 below, C90 above.
Direction direction_of(double h_deg, double v_deg, bool up) {
  const double h = radians(h_deg), v = radians(v_deg);
  const double across = std::sin(h), forward = std::cos(h) * std::cos(v);
  return Direction::from_unit({std::cos(h) * std::sin(v), up ? across : -across, up ? forward : -forward});
}

SampledField isocandela_field(const IntensityDistribution& d, const PlotAxis& h, const PlotAxis& v, bool up) {
  SampledField field;
  const auto value = [](const PlotAxis& axis, int i) {
    return axis.first + (axis.last - axis.first) * i / (kSamples - 1);
  };
  for (int i = 0; i < kSamples; ++i) {
    field.x.push_back(h.at(value(h, i)));
    field.y.push_back(v.at(value(v, i)));
  }
  for (int iv = 0; iv < kSamples; ++iv) {
    for (int ih = 0; ih < kSamples; ++ih)
      field.value.push_back(intensity_in(d, direction_of(value(h, ih), value(v, iv), up)));
  }
  return field;
}

/// The disc of one hemisphere: unit circle = horizon.
SampledField hemisphere_field(const IntensityDistribution& d, SvgPoint centre, double radius, bool up) {
  SampledField field;
  for (int i = 0; i < kSamples; ++i) {
    const double share = 2.0 * i / (kSamples - 1) - 1.0;
    field.x.push_back(centre.x + radius * share);
    field.y.push_back(centre.y + radius * share);
  }
  for (int iy = 0; iy < kSamples; ++iy) {
    for (int ix = 0; ix < kSamples; ++ix) {
      const double x = 2.0 * ix / (kSamples - 1) - 1.0, y = 1.0 - 2.0 * iy / (kSamples - 1);
      // Beyond the horizon (covered later) the value of the horizon keeps the bands straight there.
      const double r = std::min(1.0, std::hypot(x, y));
      const double angle = 2.0 * degrees(std::asin(r / std::numbers::sqrt2));
      field.value.push_back(intensity_at(d, degrees(std::atan2(y, x)), up ? 180.0 - angle : angle));
    }
  }
  return field;
}

std::vector<SvgPoint> ring(SvgPoint centre, double radius) {
  std::vector<SvgPoint> points;
  for (int i = 0; i < 180; ++i) {
    const double a = 2.0 * std::numbers::pi * i / 180.0;
    points.push_back({centre.x + radius * std::cos(a), centre.y - radius * std::sin(a)});
  }
  return points;
}

void draw_hemisphere(SvgCanvas& canvas, const IntensityDistribution& d, SvgPoint centre, double radius,
                     bool up, double peak) {
  canvas.area({ring(centre, radius)}, {.fill = band_color(kBands)});
  draw_bands(canvas, hemisphere_field(d, centre, radius, up), peak);
  const double out = radius + 2.0;
  canvas.area({{{centre.x - out, centre.y - out},
                {centre.x + out, centre.y - out},
                {centre.x + out, centre.y + out},
                {centre.x - out, centre.y + out}},
               ring(centre, radius)},
              {.fill = "#fff"});
  const SvgStyle thin{.stroke = "#fff", .width = 0.7, .dash = "3 3"};
  for (const double angle : {30.0, 60.0}) {
    const double r = radius * std::numbers::sqrt2 * std::sin(radians(0.5 * angle));
    canvas.circle(centre, r, thin);
    // "white", not "#fff": a page on a dark screen changes the latter over (report.css).
    canvas.rectangle({centre.x + 1.0, centre.y - r - 13.0}, 29.0, 13.0, {.fill = "#000", .opacity = 0.45});
    canvas.text({centre.x + 3.0, centre.y - r - 3.0}, fmt::format("{:g}°", up ? 180.0 - angle : angle),
                {.size = 10.5, .fill = "white"});
  }
  canvas.line({centre.x - radius, centre.y}, {centre.x + radius, centre.y}, thin);
  canvas.line({centre.x, centre.y - radius}, {centre.x, centre.y + radius}, thin);
  canvas.circle(centre, radius, {.stroke = "#444", .width = 1.2});
  const SvgText middle{.size = 12.0, .anchor = "middle", .fill = "#444"};
  canvas.text({centre.x, centre.y - radius - 7.0}, "C90", middle);
  canvas.text({centre.x, centre.y + radius + 17.0}, "C270", middle);
  canvas.text({centre.x + radius + 5.0, centre.y + 4.0}, "C0", {.size = 12.0, .fill = "#444"});
  canvas.text({centre.x, centre.y + radius + 37.0},
              up ? "upper hemisphere, γ 180° at the centre" : "lower hemisphere, γ 0° at the centre",
              {.size = 12.5, .anchor = "middle"});
}

}  // namespace

std::string isocandela_svg(const IntensityDistribution& d, const DiagramOptions& options) {
  check_drawable(d, "isocandela diagram");
  const ShownIntensity unit = shown_intensity(d, options.lamp_flux_lm);
  const bool up = axis_gamma_deg(d) > 90.0;
  const double range =
      range_holding(d, up ? 180.0 : 0.0, kPeakShares[kBands - 1], {5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0});
  constexpr double kLeft = 74.0, kTop = 84.0, kSize = 420.0;
  const PlotAxis h{-range, range, kLeft, kLeft + kSize}, v{-range, range, kTop + kSize, kTop};
  const SampledField field = isocandela_field(d, h, v, up);
  const double peak = *std::max_element(field.value.begin(), field.value.end());

  SvgCanvas canvas(640.0, 566.0);
  canvas.data("plot", "isocandela");
  canvas.data("x", h.data());
  canvas.data("y", v.data());
  const double all = total_flux(d);
  const double shown = up ? zonal_flux(d, 90.0, 180.0) : zonal_flux(d, 0.0, 90.0);
  draw_title(canvas, options.title.empty() ? "Isocandela diagram" : options.title,
             fmt::format("H and V of type B about {}, seen along the beam – {:.1f} % of the flux is in this "
                         "hemisphere",
                         up ? "zenith" : "nadir", all > 0.0 ? 100.0 * shown / all : 0.0));
  const std::vector<double> marks = angle_ticks(-range, range);
  draw_grid(canvas, h, marks, "°", v, marks, "°");
  for (std::size_t i = 0; peak > 0.0 && i < kBands; ++i) {
    const bool quoted = kPeakShares[i] == 0.5 || kPeakShares[i] == 0.1;
    for (const auto& whole : contour_lines(field, kPeakShares[i] * peak)) {
      const std::vector<SvgPoint> line = thinned(whole);
      canvas.polyline(line, {.stroke = band_color(i), .width = 4.2});
      canvas.polyline(line, {.stroke = "#222", .width = quoted ? 2.0 : 0.8});
    }
  }
  LineLabels labels;
  for (std::size_t i = 0; peak > 0.0 && i < kBands; ++i) {
    for (const auto& line : contour_lines(field, kPeakShares[i] * peak))
      labels.write(canvas, line, fmt::format("{:g} %", 100.0 * kPeakShares[i]),
                   0.42 + 0.08 * static_cast<double>(i % 3));
  }
  canvas.text({kLeft, 76.0}, "V ↑ C0", {.size = 12.0, .fill = "#555"});
  canvas.text({kLeft + kSize, kTop + kSize + 36.0}, up ? "H → C90" : "H → C270",
              {.size = 12.0, .anchor = "end", .fill = "#555"});
  draw_scale(canvas, {kLeft + kSize + 14.0, kTop + 16.0}, peak, unit, true);
  canvas.text({kLeft, kTop + kSize + 54.0},
              fmt::format("Largest intensity shown {} {}; heavy lines: 50 % (beam) and 10 % (field)",
                          label_number(peak * unit.per_cd), unit.name));
  return canvas.str();
}

std::string sphere_svg(const IntensityDistribution& d, const DiagramOptions& options) {
  check_drawable(d, "sphere map");
  const ShownIntensity unit = shown_intensity(d, options.lamp_flux_lm);
  const PeakIntensity peak = peak_intensity(d);
  SvgCanvas canvas(824.0, 432.0);
  canvas.data("plot", "sphere");
  draw_title(
      canvas, options.title.empty() ? "Intensity in every direction" : options.title,
      fmt::format("equal areas are equal solid angles, seen from above – peak {} {} at C {:g}°, γ {:g}°",
                  label_number(peak.cd * unit.per_cd), unit.name, peak.c_deg, peak.gamma_deg));
  constexpr double kRadius = 145.0;
  // For the page's script: centres of the lower and the upper disc, and their radius.
  canvas.data("discs", fmt::format("172 232 502 232 {:g}", kRadius));
  draw_hemisphere(canvas, d, {172.0, 232.0}, kRadius, false, peak.cd);
  draw_hemisphere(canvas, d, {502.0, 232.0}, kRadius, true, peak.cd);
  draw_scale(canvas, {692.0, 130.0}, peak.cd, unit, false);
  return canvas.str();
}

}  // namespace lucerna
