// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lucerna/design/problem/design_detectors.h"
#include "lucerna/intensity_comparison.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/report/html/grid_map.h"
#include "lucerna/report/html/html_text.h"
#include "lucerna/report/html/report_far_field.h"
#include "lucerna/report/html/report_parts.h"
#include "lucerna/results/metrics/figure_text.h"
#include "lucerna/results/svg/svg_curves.h"
#include "lucerna/results/svg/svg_polar.h"

namespace lucerna {

namespace {

/// What the design scaled the target by, 1 in absolute mode.
double target_factor(const ResultFigures& result) {
  return result.has("/target/factor") ? result.number("/target/factor") : 1.0;
}

/// The target as the result was compared with it, in the result's unit.
IntensityDistribution scaled_target(const DesignTarget& target, double factor, FluxUnit unit) {
  IntensityDistribution out = target.distribution;
  scale(out, factor);
  out.unit = unit;
  return out;
}

/// That on the result's grid.
FarFieldTable on_grid_of(const FarFieldTable& result, const IntensityDistribution& target) {
  FarFieldTable out{"target", result.distribution, {}};
  IntensityDistribution& d = out.distribution;
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g)
      d.at(c, g) = intensity_at(target, d.c_deg[c], d.gamma_deg[g]);
  }
  return out;
}

std::string sections_plot(HtmlPage& page, const FarFieldTable& result, const FarFieldTable& target) {
  const IntensityDistribution& d = result.distribution;
  const bool up = axis_gamma_deg(d) > 90.0;
  CurvePlot plot{.title = "Sections through the beam",
                 .below = up ? "angle from zenith" : "angle from nadir",
                 .x = {.label = "angle, °"},
                 .y = {.label = d.unit == FluxUnit::lumen ? "intensity, cd" : "intensity, W/sr"}};
  const double peak = *std::ranges::max_element(d.cd);
  double reach = 5.0;
  for (std::size_t i = 0; i < d.cd.size(); ++i) {
    const double gamma = d.gamma_deg[i % d.gamma_deg.size()];
    if (d.cd[i] >= 0.01 * peak) reach = std::max(reach, up ? 180.0 - gamma : gamma);
  }
  for (const double c : {0.0, 90.0}) {
    for (const auto* table : {&result, &target}) {
      Curve curve{.name = fmt::format("{} C{:g}", table == &result ? "result" : "target", c),
                  .dashed = table == &target};
      for (int i = -200; i <= 200; ++i) {
        const double angle = std::min(90.0, 1.1 * reach) * i / 200.0;
        curve.x.push_back(angle);
        curve.y.push_back(intensity_at(table->distribution, angle < 0.0 ? c + 180.0 : c,
                                       up ? 180.0 - std::abs(angle) : std::abs(angle)));
      }
      plot.curves.push_back(std::move(curve));
    }
  }
  const std::size_t index = page.append("curves", curves_json(plot));
  return plot_figure(curves_svg(plot), "target-sections", "Target and result in C0–C180 and C90–C270",
                     fmt::format("data-curves=\"{}\"", index));
}

std::string peak_ratio(const ResultFigures& figures) {
  if (!figures.has("/peak/intensity/value") || !figures.has("/target/peak/intensity")) return kNoFigure;
  const double wanted = figures.number("/target/peak/intensity");
  return figure_text(figures.number("/peak/intensity/value") / wanted,
                     figures.number("/peak/intensity/standard_error") / wanted);
}

std::string comparison_table(const ResultFigures& figures, const FarFieldTable& result,
                             const IntensityDistribution& target) {
  const DistributionComparison c = compare_distributions(target, result.distribution,
                                                         {.test_error_cd = result.standard_error,
                                                          .test_flux_error = result.flux_standard_error,
                                                          .align = false});
  HtmlTable table{"Result against target over all directions", {"Figure", "Value", "Meaning"}, {}};
  const auto row = [&](const char* name, const std::string& value, const char* meaning) {
    table.rows.push_back({name, value, meaning});
  };
  const auto percent = [](const Estimate& e) {
    return figure_text(100.0 * e.mean, 100.0 * e.standard_error) + " %";
  };
  row("Relative RMS", percent(c.relative_rms), "weighted by solid angle");
  row("Noise floor", fmt::format("{:.2f} %", 100.0 * c.noise_floor),
      "what the trace's noise alone would give");
  row("Bergen fit", figure_text(c.bergen_fit.mean, c.bergen_fit.standard_error), "100 = equal");
  row("Overlap", percent(c.overlap), "of the light in the right place");
  row("Wasserstein-1", figure_text(c.wasserstein_deg.mean, c.wasserstein_deg.standard_error) + "°",
      "mean angle that light would have to move");
  // Of the peaks as the summary has them: the largest value of a table is its noisiest.
  row("Peak", peak_ratio(figures), "result over target");
  row("Flux", figure_text(c.flux_ratio.mean, c.flux_ratio.standard_error), "result over target");
  return html_table(table);
}

void directions_section(HtmlPage& page, const DesignTarget& wanted, const ResultFigures& figures,
                        const FarFieldTable& result) {
  const IntensityDistribution expected =
      scaled_target(wanted, target_factor(figures), result.distribution.unit);
  const FarFieldTable target = on_grid_of(result, expected);
  FarFieldFigure figure = add_far_field(page, result);
  figure.target = add_far_field(page, target).index;
  const std::string attributes =
      fmt::format("data-detector=\"{}\" data-target=\"{}\"", figure.index, *figure.target);
  std::string out = wanted.mode == TargetMode::shape
                        ? "<p>The target's shape counts: it is scaled to fit best.</p>\n"
                        : "<p>The target counts as it is, in absolute figures.</p>\n";
  out += "<div class=\"plots\">\n";
  out += plot_figure(polar_svg(result.distribution, {.title = "Target and result",
                                                     .reference = &target.distribution,
                                                     .standard_error = result.standard_error}),
                     "target-polar", "Polar diagram of result and target", attributes);
  out += direction_map("target-and-result", figure);
  out += sections_plot(page, result, target);
  out += "</div>\n" + comparison_table(figures, result, expected);
  page.section("target", "Target and result", out);
}

/// Null where the folder has none.
const PlaneTable* target_plane(const TraceFolder& folder) {
  const auto at = std::ranges::find(folder.planes, kTargetPlane, &PlaneTable::name);
  return at == folder.planes.end() ? nullptr : &*at;
}

void plane_section(HtmlPage& page, const DesignTarget& prescribed, const PlaneTable& found, double factor) {
  const PlaneTarget& wanted = *prescribed.plane;
  std::vector<double> target;
  for (const double y : found.y_mm) {
    for (const double x : found.x_mm) target.push_back(factor * wanted.at(x, y));
  }

  GridMap map;
  map.x_label = "x, mm", map.y_label = "y, mm";
  map.x_first = -0.5 * wanted.size_x_mm, map.x_last = -map.x_first;
  map.y_first = -0.5 * wanted.size_y_mm, map.y_last = -map.y_first;
  map.nx = found.x_mm.size(), map.ny = found.y_mm.size();
  map.unit = found.unit == FluxUnit::lumen ? "lx" : "W/m²";
  map.size = 250.0;
  map.range = {0.0, std::max(*std::ranges::max_element(found.value), *std::ranges::max_element(target))};
  std::string out = fmt::format(
      "<p>{} What was found is the plane {} of the final trace, noise included.</p>\n<div "
      "class=\"trio\">\n",
      prescribed.mode == TargetMode::shape ? "The target's shape counts: it is scaled to fit best."
                                           : "The target counts as it is, in absolute figures.",
      found.name);
  map.title = "target";
  map.value = target;
  out += grid_figure(page, map, "plane-target", "Target illuminance");
  map.title = "result";
  map.value = found.value;
  map.standard_error = found.standard_error;
  out += grid_figure(page, map, "plane-result", "Illuminance found");
  map.title = "difference";
  map.standard_error.clear();
  for (std::size_t i = 0; i < target.size(); ++i) map.value[i] = found.value[i] - target[i];
  map.range.reset();
  map.diverging = true;
  out += grid_figure(page, map, "plane-difference", "Illuminance found less target");
  page.section("target", "Target and result", out + "</div>\n");
}

}  // namespace

void add_target_section(HtmlPage& page, const DesignTarget& target, const ResultFigures& result,
                        const TraceFolder& folder) {
  const PlaneTable* plane = target_plane(folder);
  if (target.plane && plane != nullptr) {
    plane_section(page, target, *plane, target_factor(result));
  } else if (target.plane || folder.far_fields.empty()) {
    page.section("target", "Target and result",
                 "<p>There is no comparison: the project has no detector for it.</p>\n");
  } else {
    directions_section(page, target, result, folder.far_fields.front());
  }
}

}  // namespace lucerna
