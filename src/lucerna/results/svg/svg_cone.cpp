// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/svg/svg_cone.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {

namespace {

constexpr double kWidest = 80.0;  // at 80 degrees a plane is 11 times as wide as it is far
constexpr int kRows = 5;

/// The light about the axis: angle from it to either side of a plane pair.
struct Beam {
  const IntensityDistribution& d;
  double axis_gamma = 0.0;

  double at(double c_deg, double angle_deg) const {
    return intensity_at(d, angle_deg < 0.0 ? c_deg + 180.0 : c_deg,
                        std::abs(axis_gamma - std::abs(angle_deg)));
  }
};

/// The beam's edges in one plane pair, degrees from the axis, the first towards C + 180 negative.
struct Edges {
  bool any = false;
  double from = 0.0, to = 0.0;
  bool open() const { return from <= -kWidest || to >= kWidest; }
  double width(double distance) const { return distance * (std::tan(radians(to)) - std::tan(radians(from))); }
};

Edges edges_of(const Beam& beam, double c_deg, double level) {
  constexpr int kParts = 3200;  // 0.05 degrees
  const double step = 2.0 * kWidest / kParts;
  Edges edges;
  double before = 0.0;
  for (int i = 0; i <= kParts; ++i) {
    const double angle = i * step - kWidest, cd = beam.at(c_deg, angle);
    const double crossing = i > 0 && cd != before ? angle - step * (cd - level) / (cd - before) : angle;
    if (cd >= level) {
      if (!edges.any) edges.from = i > 0 ? crossing : angle;
      edges.any = true;
      edges.to = angle;
    } else if (i > 0 && before >= level) {
      edges.to = crossing;
    }
    before = cd;
  }
  return edges;
}

/// Largest I cos^3 within `kWidest` of the axis: over the distance squared the largest illuminance.
double strongest_on_plane(const Beam& beam) {
  double best = 0.0;
  for (std::size_t i = 0; i < beam.d.cd.size(); ++i) {
    const double angle = std::abs(beam.d.gamma_deg[i % beam.d.gamma_deg.size()] - beam.axis_gamma);
    if (angle < kWidest) best = std::max(best, beam.d.cd[i] * std::pow(std::cos(radians(angle)), 3.0));
  }
  return best;
}

double strongest(const Beam& beam) {
  double best = 0.0;
  for (std::size_t i = 0; i < beam.d.cd.size(); ++i) {
    if (std::abs(beam.d.gamma_deg[i % beam.d.gamma_deg.size()] - beam.axis_gamma) <= kWidest)
      best = std::max(best, beam.d.cd[i]);
  }
  return best;
}

/// Where a cone is drawn: apex, and drawing units per metre along and across the axis.
struct ConePlot {
  SvgPoint apex;
  double per_m = 1.0, across_per_m = 1.0, half_width = 1.0;
  double sign = 1.0;  ///< -1: the axis goes up
};

void draw_cone(SvgCanvas& canvas, const ConePlot& plot, const Edges& edges, double last_m,
               const std::string& name, const std::string& color) {
  const double height = plot.per_m * last_m;
  const SvgPoint left{plot.apex.x - plot.half_width, std::min(plot.apex.y, plot.apex.y + plot.sign * height)};
  canvas.begin_clip(left, 2.0 * plot.half_width, height);
  if (edges.any) {
    const auto edge = [&](double angle) {
      return SvgPoint{plot.apex.x + plot.across_per_m * last_m * std::tan(radians(angle)),
                      plot.apex.y + plot.sign * height};
    };
    canvas.polyline({plot.apex, edge(edges.from), edge(edges.to)},
                    {.stroke = color, .width = 2.0, .fill = color, .opacity = 0.22}, true);
    canvas.line(plot.apex, edge(edges.from), {.stroke = color, .width = 2.2});
    canvas.line(plot.apex, edge(edges.to), {.stroke = color, .width = 2.2});
  }
  canvas.line(plot.apex, {plot.apex.x, plot.apex.y + plot.sign * height},
              {.stroke = "#777", .width = 0.8, .dash = "6 3 1 3"});
  canvas.end_clip();
  for (int row = 1; row <= kRows; ++row) {
    const double y = plot.apex.y + plot.sign * height * row / kRows;
    canvas.line({plot.apex.x - plot.half_width, y}, {plot.apex.x + plot.half_width, y},
                {.stroke = "#999", .width = 0.7});
  }
  canvas.circle(plot.apex, 4.0, {.fill = "#222"});
  const double below = std::max(plot.apex.y, plot.apex.y + plot.sign * height) + 22.0;
  canvas.text({plot.apex.x, below}, name, {.size = 12.5, .anchor = "middle", .bold = true});
  canvas.text({plot.apex.x, below + 17.0},
              edges.any ? fmt::format("{}{:.1f}° to {}{:.1f}°", edges.from <= -kWidest ? "≤ " : "",
                                      edges.from, edges.to >= kWidest ? "≥ " : "", edges.to)
                        : std::string("not reached"),
              {.size = 12.0, .anchor = "middle", .fill = "#444"});
}

std::string width_text(const Edges& edges, double distance_m) {
  if (!edges.any) return "–";
  return (edges.open() ? "> " : "") + fmt::format("{:.2f}", edges.width(distance_m));
}

void draw_table(SvgCanvas& canvas, const Beam& beam, const ConePlot& plot, const Edges& across,
                const Edges& along, double last_m) {
  const std::string lux = beam.d.unit == FluxUnit::lumen ? "lx" : "W/m²";
  const double columns[] = {452.0, 532.0, 612.0, 690.0, 768.0};
  const SvgText number{.size = 12.5, .anchor = "end"}, head{.size = 12.0, .anchor = "end", .fill = "#444"};
  const double height = plot.per_m * last_m;
  const double head_y = std::min(plot.apex.y, plot.apex.y + plot.sign * height) - 20.0;
  const char* names[] = {"distance", "C0–C180", "C90–C270", "on axis", "largest"};
  const std::string units[] = {"m", "width m", "width m", "E " + lux, "E " + lux};
  for (std::size_t i = 0; i < 5; ++i) {
    canvas.text({columns[i], head_y}, names[i], head);
    canvas.text({columns[i], head_y + 15.0}, units[i], head);
  }
  for (int row = 1; row <= kRows; ++row) {
    const double distance = last_m * row / kRows;
    const double y = plot.apex.y + plot.sign * height * row / kRows + (plot.sign > 0.0 ? -4.0 : 15.0);
    canvas.text({columns[0], y}, label_number(distance), number);
    canvas.text({columns[1], y}, width_text(across, distance), number);
    canvas.text({columns[2], y}, width_text(along, distance), number);
    canvas.text({columns[3], y}, label_number(beam.at(0.0, 0.0) / (distance * distance)), number);
    canvas.text({columns[4], y}, label_number(strongest_on_plane(beam) / (distance * distance)), number);
  }
}

}  // namespace

std::string cone_svg(const IntensityDistribution& d, const ConeOptions& options) {
  check_drawable(d, "cone diagram");
  if (!(options.fraction > 0.0 && options.fraction <= 1.0))
    throw InputError(fmt::format("cone diagram: fraction {} is not in (0, 1]", options.fraction));
  if (!(options.last_distance_m > 0.0) || !std::isfinite(options.last_distance_m))
    throw InputError(fmt::format("cone diagram: distance {} m is not above 0", options.last_distance_m));
  const Beam beam{d, axis_gamma_deg(d)};
  const bool up = beam.axis_gamma > 90.0;
  const double peak = strongest(beam);
  Edges across, along;
  if (peak > 0.0) {
    across = edges_of(beam, 0.0, options.fraction * peak);
    along = edges_of(beam, 90.0, options.fraction * peak);
  }
  constexpr double kHeight = 300.0, kHalf = 84.0;
  // Angles are true as long as both cones fit; wide ones are drawn narrower, by the same factor.
  double reach = kHalf / kHeight;
  for (const Edges& edges : {across, along})
    reach = std::max(reach, std::tan(radians(std::max(-edges.from, edges.to))));
  const double squeeze = kHalf / (kHeight * reach);
  SvgCanvas canvas(790.0, 470.0);
  canvas.data("plot", "cone");
  draw_title(
      canvas, options.diagram.title.empty() ? "Cone diagram" : options.diagram.title,
      fmt::format("edges at {:g} % of the largest intensity within 80° of {}; planes square to it{}",
                  100.0 * options.fraction, up ? "zenith" : "nadir",
                  squeeze < 1.0 - 1e-9 ? fmt::format(" (widths drawn x {:.2g})", squeeze) : std::string()));
  ConePlot plot{{100.0, up ? 410.0 : 110.0},
                kHeight / options.last_distance_m,
                squeeze * kHeight / options.last_distance_m,
                kHalf,
                up ? -1.0 : 1.0};
  // For the page's script: place of the apex and of the last plane, its distance; edges of both pairs of
  // planes (degrees); illuminances on the axis and largest at 1 m.
  canvas.data("cone", fmt::format("{:g} {:g} {:g}", plot.apex.y, plot.apex.y + plot.sign * kHeight,
                                  options.last_distance_m));
  if (across.any && along.any)
    canvas.data("edges",
                fmt::format("{:.4f} {:.4f} {:.4f} {:.4f}", across.from, across.to, along.from, along.to));
  canvas.data("lux", fmt::format("{:.6g} {:.6g}", beam.at(0.0, 0.0), strongest_on_plane(beam)));
  draw_cone(canvas, plot, across, options.last_distance_m, "C180 ← → C0", std::string(kCurveColors[0]));
  plot.apex.x = 290.0;
  draw_cone(canvas, plot, along, options.last_distance_m, "C270 ← → C90", std::string(kCurveColors[1]));
  for (int row = 1; row <= kRows; ++row) {
    const double y = plot.apex.y + plot.sign * kHeight * row / kRows;
    canvas.line({290.0 + kHalf, y}, {768.0, y}, {.stroke = "#bbb", .width = 0.7});
  }
  draw_table(canvas, beam, plot, across, along, options.last_distance_m);
  return canvas.str();
}

}  // namespace lucerna
