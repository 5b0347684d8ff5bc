// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_polar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/estimate.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/results/svg/svg_axes.h"
#include "lucerna/results/svg/svg_canvas.h"

namespace lucerna {

namespace {

constexpr double kPolarWidth = 640.0, kPolarRadius = 250.0, kPolarTop = 62.0, kPolarMargin = 34.0;

/// Where the disc lies and how long a candela is.
struct PolarFrame {
  SvgPoint centre;
  double unit_per_cd = 1.0;
  bool down = true, up = true;  ///< the halves that are drawn
  double bottom = 0.0;          ///< y below the disc

  SvgPoint at(double gamma_deg, double side, double radius) const {
    const double g = radians(gamma_deg);
    return {centre.x + side * radius * std::sin(g), centre.y + radius * std::cos(g)};
  }
};

double peak_within(const IntensityDistribution& d, double from_deg, double to_deg) {
  double peak = 0.0;
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      if (d.gamma_deg[g] >= from_deg && d.gamma_deg[g] <= to_deg) peak = std::max(peak, d.at(c, g));
    }
  }
  return peak;
}

PolarFrame frame_for(const IntensityDistribution& d, const IntensityDistribution* reference,
                     double ring_cd_end) {
  PolarFrame frame;
  double down = peak_within(d, 0.0, 89.0), up = peak_within(d, 91.0, 180.0);
  if (reference != nullptr) {
    down = std::max(down, peak_within(*reference, 0.0, 89.0));
    up = std::max(up, peak_within(*reference, 91.0, 180.0));
  }
  // Less than half a percent is not visible in the drawing.
  frame.down = down >= 0.005 * up || up == 0.0;
  frame.up = up > 0.005 * down;
  frame.unit_per_cd = kPolarRadius / ring_cd_end;
  frame.centre = {0.5 * kPolarWidth, kPolarTop + kPolarMargin + (frame.up ? kPolarRadius : 0.0)};
  frame.bottom = frame.centre.y + (frame.down ? kPolarRadius : 0.0) + kPolarMargin;
  return frame;
}

/// One half of a plane pair: the curve of plane C on one side.
std::vector<SvgPoint> half_curve(const IntensityDistribution& d, const PolarFrame& frame, double c_deg,
                                 double side) {
  std::vector<SvgPoint> points;
  const double first = d.gamma_deg.front(), last = d.gamma_deg.back();
  if (first > 0.0) points.push_back(frame.centre);
  for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
    // Steps of at most 1 degree keep coarse grids round: between grid angles the intensity is linear, the
    // line is not.
    const double from = d.gamma_deg[g];
    const double to = g + 1 < d.gamma_deg.size() ? d.gamma_deg[g + 1] : from;
    const int parts = std::max(1, static_cast<int>(std::ceil(to - from)));
    for (int i = 0; i < parts; ++i) {
      const double gamma = from + (to - from) * i / parts;
      points.push_back(frame.at(gamma, side, frame.unit_per_cd * intensity_at(d, c_deg, gamma)));
    }
  }
  if (last < 180.0) points.push_back(frame.centre);
  return points;
}

/// The curve of the planes C and C + 180, from zenith to zenith.
std::vector<SvgPoint> pair_curve(const IntensityDistribution& d, const PolarFrame& frame, double c_deg) {
  std::vector<SvgPoint> points = half_curve(d, frame, c_deg + 180.0, -1.0);
  std::reverse(points.begin(), points.end());
  const std::vector<SvgPoint> right = half_curve(d, frame, c_deg, 1.0);
  points.insert(points.end(), right.begin(), right.end());
  return points;
}

/// The 95 % intervals about both pairs of planes.
void draw_bands(SvgCanvas& canvas, const IntensityDistribution& d, const PolarFrame& frame,
                std::span<const double> standard_error) {
  if (standard_error.empty()) return;
  const IntensityDistribution low = moved_by_errors(d, standard_error, -kIntervalErrors),
                              high = moved_by_errors(d, standard_error, kIntervalErrors);
  for (const double c : {0.0, 90.0}) {
    std::vector<SvgPoint> ring = pair_curve(high, frame, c);
    const std::vector<SvgPoint> inner = pair_curve(low, frame, c);
    ring.insert(ring.end(), inner.rbegin(), inner.rend());
    canvas.area({ring}, {.fill = std::string(kCurveColors[c == 0.0 ? 0 : 1]), .opacity = 0.25});
  }
}

void draw_pair(SvgCanvas& canvas, const IntensityDistribution& d, const PolarFrame& frame, double c_deg,
               const SvgStyle& style) {
  canvas.polyline(pair_curve(d, frame, c_deg), style);
}

void draw_spokes(SvgCanvas& canvas, const PolarFrame& frame) {
  const SvgStyle thin{.stroke = "#c8c8c8", .width = 0.8};
  for (int gamma = 0; gamma <= 180; gamma += 15) {
    if ((gamma < 90 && !frame.down) || (gamma > 90 && !frame.up)) continue;
    for (const double side : {1.0, -1.0}) {
      if (side < 0.0 && gamma % 180 == 0) continue;
      canvas.line(frame.centre, frame.at(gamma, side, kPolarRadius), thin);
      if (gamma % 30 != 0) continue;
      const SvgPoint label = frame.at(gamma, side, kPolarRadius + 16.0);
      const bool middle = gamma % 180 == 0;
      canvas.text({label.x, label.y + 5.0}, fmt::format("{}°", gamma),
                  {.size = 13.0,
                   .anchor = middle       ? "middle"
                             : side > 0.0 ? "start"
                                          : "end"});
    }
  }
}

/// Rings with labels along the spoke between 0 and the horizontal where curves are rarest.
void draw_rings(SvgCanvas& canvas, const PolarFrame& frame, double step, int rings, double shown_per_cd) {
  const SvgStyle thin{.stroke = "#c8c8c8", .width = 0.8}, edge{.stroke = "#777", .width = 1.1};
  const double from = frame.down ? 0.0 : 90.0, to = frame.up ? 180.0 : 90.0;
  for (int i = 1; i <= rings; ++i) {
    const double radius = frame.unit_per_cd * step * i;
    std::vector<SvgPoint> arc;
    for (double g = to; g >= from - 1e-9; g -= 2.0) arc.push_back(frame.at(g, -1.0, radius));
    for (double g = from; g <= to + 1e-9; g += 2.0) arc.push_back(frame.at(g, 1.0, radius));
    canvas.polyline(arc, i == rings ? edge : thin, false);
  }
  for (int i = 1; i <= rings; ++i) {
    const double radius = frame.unit_per_cd * step * i;
    const SvgPoint at = frame.at(frame.down ? 82.5 : 97.5, 1.0, radius);
    const std::string label = label_number(step * i * shown_per_cd);
    const double width = 6.6 * static_cast<double>(label.size()) + 4.0;
    canvas.rectangle({at.x - 0.5 * width, at.y - 8.5}, width, 14.0, {.fill = "#fff", .opacity = 0.8});
    canvas.text({at.x, at.y + 3.0}, label, {.size = 11.5, .anchor = "middle", .fill = "#444"});
  }
}

void draw_legend(SvgCanvas& canvas, const PolarFrame& frame, const PolarOptions& options,
                 const SvgStyle& across, const SvgStyle& along, const SvgStyle& reference) {
  const double y = frame.bottom + 14.0;
  double x = 60.0;
  const auto entry = [&](const SvgStyle& style, const std::string& name) {
    canvas.line({x, y}, {x + 42.0, y}, style);
    canvas.text({x + 50.0, y + 4.5}, name);
    x += 80.0 + 7.4 * static_cast<double>(name.size());
  };
  entry(across, "C0 – C180");
  entry(along, "C90 – C270");
  if (options.reference != nullptr) entry(reference, options.reference_name);
}

void draw_figures(SvgCanvas& canvas, const IntensityDistribution& d, const std::optional<DrawnFigures>& drawn,
                  double y, double shown_per_cd, const std::string& unit) {
  if (drawn) {
    canvas.text({60.0, y}, drawn->peak);
    canvas.text({60.0, y + 19.0}, "C0 – C180: " + drawn->c0);
    canvas.text({60.0, y + 38.0}, "C90 – C270: " + drawn->c90);
    return;
  }
  const BeamMetrics f = beam_metrics(d);
  const auto plane = [&](double c) {
    return *std::find_if(f.planes.begin(), f.planes.end(), [&](const auto& p) { return p.c_deg == c; });
  };
  canvas.text({60.0, y},
              fmt::format("Flux {} {} · peak {} {} at C {:g}°, γ {:g}°", label_number(f.flux), symbol(d.unit),
                          label_number(f.peak.cd * shown_per_cd), unit, f.peak.c_deg, f.peak.gamma_deg));
  const auto p0 = plane(0.0), p90 = plane(90.0);
  canvas.text({60.0, y + 19.0},
              fmt::format("Beam 50 % of maximum: C0 {}, C90 {} · field 10 %: C0 {}, C90 {}",
                          degrees_text(p0.beam_of_maximum), degrees_text(p90.beam_of_maximum),
                          degrees_text(p0.field_of_maximum), degrees_text(p90.field_of_maximum)));
}

}  // namespace

std::string polar_svg(const IntensityDistribution& d, const PolarOptions& options) {
  for (const IntensityDistribution* each : {&d, options.reference}) {
    if (each == nullptr) continue;
    if (const std::string fault = grid_fault(*each); !fault.empty())
      throw InputError("polar diagram: " + fault);
  }
  const auto [shown_per_cd, unit] = shown_intensity(d, options.lamp_flux_lm);
  double peak = peak_within(d, 0.0, 180.0);
  if (options.reference != nullptr) peak = std::max(peak, peak_within(*options.reference, 0.0, 180.0));
  const double step = nice_step(peak * shown_per_cd, 5) / shown_per_cd;
  const int rings = std::max(1, static_cast<int>(std::ceil(peak / step - 1e-9)));
  const PolarFrame frame = frame_for(d, options.reference, step * rings);

  SvgCanvas canvas(kPolarWidth, frame.bottom + (options.figures ? 95.0 : 76.0));
  canvas.data("plot", "polar");
  canvas.data("polar", fmt::format("{:g} {:g} {:.9g}", frame.centre.x, frame.centre.y, frame.unit_per_cd));
  canvas.text({0.5 * kPolarWidth, 28.0}, options.title.empty() ? "Luminous intensity" : options.title,
              {.size = 17.0, .anchor = "middle", .bold = true});
  canvas.text({0.5 * kPolarWidth, 48.0},
              fmt::format("{}  –  rings every {} {}", unit, label_number(step * shown_per_cd), unit),
              {.size = 12.5, .anchor = "middle", .fill = "#444"});
  draw_spokes(canvas, frame);
  draw_rings(canvas, frame, step, rings, shown_per_cd);
  canvas.text({40.0, 72.0}, "← C180, C270", {.size = 12.0, .fill = "#555"});
  canvas.text({kPolarWidth - 40.0, 72.0}, "C0, C90 →", {.size = 12.0, .anchor = "end", .fill = "#555"});
  const SvgStyle across{.stroke = std::string(kCurveColors[0]), .width = 2.4};
  const SvgStyle along{.stroke = std::string(kCurveColors[1]), .width = 2.4, .dash = "9 5"};
  const SvgStyle behind{.stroke = "#999", .width = 3.4};
  if (options.reference != nullptr) {
    draw_pair(canvas, *options.reference, frame, 0.0, behind);
    draw_pair(canvas, *options.reference, frame, 90.0, {.stroke = "#999", .width = 3.4, .dash = "9 5"});
  }
  draw_bands(canvas, d, frame, options.standard_error);
  draw_pair(canvas, d, frame, 0.0, across);
  draw_pair(canvas, d, frame, 90.0, along);
  draw_legend(canvas, frame, options, across, along, behind);
  draw_figures(canvas, d, options.figures, frame.bottom + 43.0, shown_per_cd, unit);
  return canvas.str();
}

}  // namespace lucerna
