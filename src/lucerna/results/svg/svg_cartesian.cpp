// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_cartesian.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lucerna/estimate.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {

namespace {

constexpr double kCartesianWidth = 640.0, kCartesianLeft = 78.0, kCartesianRight = 606.0,
                 kCartesianTop = 84.0, kCartesianBottom = 424.0;
constexpr double kDecades = 1e-4;

/// The curve of the great circle through C and C + 180, from -range to +range about the axis.
std::vector<SvgPoint> curve(const IntensityDistribution& d, double c_deg, double axis_gamma,
                            const PlotAxis& x, const PlotAxis& y, double per_cd) {
  constexpr int kParts = 1440;
  std::vector<SvgPoint> points;
  for (int i = 0; i <= kParts; ++i) {
    const double angle = x.first + (x.last - x.first) * i / kParts;
    const double gamma = std::abs(axis_gamma - std::abs(angle));
    const double cd = intensity_at(d, angle < 0.0 ? c_deg + 180.0 : c_deg, gamma);
    points.push_back({x.at(angle), y.at(cd * per_cd)});
  }
  return points;
}

void draw_legend(SvgCanvas& canvas, const IntensityDistribution& d, const std::optional<DrawnFigures>& drawn,
                 const SvgStyle& across, const SvgStyle& along) {
  const auto angles = [&](double c) {
    if (drawn) return c == 0.0 ? drawn->c0 : drawn->c90;
    return fmt::format("beam 50 % {}, field 10 % {}",
                       degrees_text(beam_angle_deg(d, c, 0.5, BeamReference::maximum)),
                       degrees_text(beam_angle_deg(d, c, 0.1, BeamReference::maximum)));
  };
  canvas.line({kCartesianLeft, 482.0}, {kCartesianLeft + 42.0, 482.0}, across);
  canvas.text({kCartesianLeft + 50.0, 486.5}, "C0 – C180: " + angles(0.0));
  canvas.line({kCartesianLeft, 502.0}, {kCartesianLeft + 42.0, 502.0}, along);
  canvas.text({kCartesianLeft + 50.0, 506.5}, "C90 – C270: " + angles(90.0));
}

}  // namespace

std::string cartesian_svg(const IntensityDistribution& d, const DiagramOptions& options, bool log_scale) {
  check_drawable(d, "Cartesian diagram");
  const ShownIntensity unit = shown_intensity(d, options.lamp_flux_lm);
  const double axis = axis_gamma_deg(d);
  const PeakIntensity peak = peak_intensity(d);
  const double range =
      range_holding(d, axis, log_scale ? 1e-3 : 1e-2, {5.0, 10.0, 20.0, 30.0, 45.0, 60.0, 90.0, 180.0});
  const PlotAxis x{-range, range, kCartesianLeft, kCartesianRight};
  const double top = peak.cd > 0.0 ? peak.cd * unit.per_cd : 1.0;
  PlotAxis y{0.0, 1.0, kCartesianBottom, kCartesianTop, log_scale};
  if (log_scale) {
    y.last = 1.2 * top;
    y.first = kDecades * top;
  } else {
    const double step = nice_step(top, 6);
    y.last = step * std::ceil(1.02 * top / step);
  }

  SvgCanvas canvas(kCartesianWidth, 524.0);
  canvas.data("plot", "cartesian");
  canvas.data("x", x.data());
  canvas.data("y", y.data());
  draw_title(canvas, options.title.empty() ? "Luminous intensity" : options.title,
             fmt::format("{}{} over the angle from {} – {}", unit.name, log_scale ? ", logarithmic," : "",
                         axis > 90.0 ? "zenith" : "nadir",
                         options.figures ? options.figures->peak
                                         : fmt::format("peak {} {} at C {:g}°, γ {:g}°", label_number(top),
                                                       unit.name, peak.c_deg, peak.gamma_deg)));
  draw_grid(canvas, x, angle_ticks(-range, range), "°", y, ticks(y, 6), "");
  canvas.text({kCartesianLeft, 76.0}, "← C180, C270", {.size = 12.0, .fill = "#555"});
  canvas.text({kCartesianRight, 76.0}, "C0, C90 →", {.size = 12.0, .anchor = "end", .fill = "#555"});
  for (const double share : {0.5, 0.1}) {
    const double at = y.at(share * top);
    canvas.line({kCartesianLeft, at}, {kCartesianRight, at}, {.stroke = "#888", .width = 1.0, .dash = "2 3"});
    canvas.text({kCartesianRight + 3.0, at + 4.0}, fmt::format("{:g} %", 100.0 * share),
                {.size = 11.0, .fill = "#555"});
  }
  const SvgStyle across{.stroke = std::string(kCurveColors[0]), .width = 2.4};
  const SvgStyle along{.stroke = std::string(kCurveColors[1]), .width = 2.4, .dash = "9 5"};
  canvas.begin_clip({kCartesianLeft, kCartesianTop}, kCartesianRight - kCartesianLeft,
                    kCartesianBottom - kCartesianTop + 1.5);
  if (!options.standard_error.empty()) {
    const IntensityDistribution low = moved_by_errors(d, options.standard_error, -kIntervalErrors),
                                high = moved_by_errors(d, options.standard_error, kIntervalErrors);
    for (const double c : {0.0, 90.0}) {
      std::vector<SvgPoint> ring = curve(high, c, axis, x, y, unit.per_cd);
      const std::vector<SvgPoint> below = curve(low, c, axis, x, y, unit.per_cd);
      ring.insert(ring.end(), below.rbegin(), below.rend());
      canvas.area({ring}, {.fill = c == 0.0 ? across.stroke : along.stroke, .opacity = 0.25});
    }
  }
  canvas.polyline(curve(d, 0.0, axis, x, y, unit.per_cd), across);
  canvas.polyline(curve(d, 90.0, axis, x, y, unit.per_cd), along);
  canvas.end_clip();
  canvas.text({0.5 * (kCartesianLeft + kCartesianRight), kCartesianBottom + 38.0},
              fmt::format("angle from {}", axis > 90.0 ? "zenith" : "nadir (γ)"),
              {.size = 12.5, .anchor = "middle", .fill = "#444"});
  draw_legend(canvas, d, options.figures, across, along);
  return canvas.str();
}

}  // namespace lucerna
