// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_far_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/photometric_metrics.h"
#include "lucerna/report/html/html_assets.h"
#include "lucerna/results/json/trace_json.h"
#include "lucerna/results/metrics/figure_text.h"
#include "lucerna/results/svg/html_escaped.h"
#include "lucerna/results/svg/svg_cartesian.h"
#include "lucerna/results/svg/svg_cone.h"
#include "lucerna/results/svg/svg_isocandela.h"
#include "lucerna/results/svg/svg_isolux.h"
#include "lucerna/results/svg/svg_polar.h"
#include "lucerna/results/svg/svg_zonal.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

/// 2.5 by 1 degree, whole.
constexpr std::size_t kMaxCells = 27'000;
/// Where cone and isolux diagrams are drawn to.
constexpr double kConeDistance_m = 5.0, kPlaneDistance_m = 3.0;

/// A row's flux and its share of all.
std::vector<std::string> zone_row(const ResultFigures& result, const std::string& name,
                                  const std::string& key, double all) {
  return {name, result.figure(key), percent_text(result.number(key + "/value"), all)};
}

std::string zone_table(const ResultFigures& result, const std::string& detector, const std::string& name) {
  const double all = result.number(detector + "/flux/value");
  HtmlTable table{
      "Flux by zone, " + name, {"γ", "Flux, " + result.text("/ledger/unit"), "Share", "0° to here"}, {}};
  double up_to = 0.0;
  for (std::size_t i = 0; i < result.at(detector + "/zones/zonal").size(); ++i) {
    const std::string key = fmt::format("{}/zones/zonal/{}", detector, i);
    up_to += result.number(key + "/value");
    table.rows.push_back(zone_row(result, fmt::format("{}°–{}°", 10 * i, 10 * (i + 1)), key, all));
    table.rows.back().push_back(percent_text(up_to, all));
  }
  return html_table(table);
}

/// N1 to N3: shares of the light below in three cones, N4: that light's share of all, N5: what leaves.
std::string flux_code(const ResultFigures& result, const std::string& detector) {
  const std::string key = detector + "/zones/cie_flux_code";
  if (!(result.number(detector + "/zones/flux_0_90/value") > 0.0)) return {};
  std::string out = "<p>CIE flux code (N1 N2 N3 N4 N5): <b>";
  for (std::size_t i = 0; i < result.at(key).size(); ++i)
    out += result.fixed(fmt::format("{}/{}/value", key, i), 0) + " ";
  const double leaves = result.number(detector + "/flux/value") / result.number("/ledger/emitted");
  return out + fmt::format("{:.0f}</b></p>\n", 100.0 * leaves);
}

std::string sum_table(const ResultFigures& result, const std::string& detector, const std::string& name) {
  const double all = result.number(detector + "/flux/value");
  HtmlTable table{"Summed zones, " + name, {"γ", "Flux, " + result.text("/ledger/unit"), "Share"}, {}};
  for (const auto& [from, to] : {std::pair{0, 30}, {0, 40}, {0, 60}, {60, 90}, {0, 90}, {90, 180}}) {
    table.rows.push_back(zone_row(result, fmt::format("{}°–{}°", from, to),
                                  fmt::format("{}/zones/flux_{}_{}", detector, from, to), all));
  }
  return html_table(table) + flux_code(result, detector);
}

std::string plane_table(const ResultFigures& result, const std::string& detector, const std::string& name) {
  HtmlTable table{"Beam and field angles by pair of planes, degrees, " + name,
                  {"Planes", "50 % of maximum", "10 % of maximum", "50 % of centre", "10 % of centre"},
                  {}};
  const Json& planes = result.at(detector + "/planes");
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::string key = fmt::format("{}/planes/{}", detector, i);
    const double c = result.number(key + "/c_deg");
    table.rows.push_back(
        {fmt::format("C{:g}–C{:g}", c, c + 180.0), result.figure(key + "/beam_angle_of_maximum_deg"),
         result.figure(key + "/field_angle_of_maximum_deg"), result.figure(key + "/beam_angle_of_centre_deg"),
         result.figure(key + "/field_angle_of_centre_deg")});
  }
  return fmt::format("<details><summary>Beam and field angles of all planes</summary>\n{}</details>\n",
                     html_table(table));
}

/// The values for the page's script, thinned to kMaxCells.
Json far_field_json(const FarFieldTable& field) {
  const IntensityDistribution& d = field.distribution;
  std::size_t skip_c = 1, skip_g = 1;
  const auto count_after = [](std::size_t n, std::size_t skip) { return (n + skip - 1) / skip; };
  while (count_after(d.c_deg.size(), skip_c) * count_after(d.gamma_deg.size(), skip_g) > kMaxCells) {
    // The denser axis is thinned first; gamma keeps its last angle only when the steps divide it.
    (count_after(d.c_deg.size(), skip_c) > count_after(d.gamma_deg.size(), skip_g) ? skip_c : skip_g) *= 2;
  }
  Json c = Json::array(), gamma = Json::array();
  std::vector<double> cd, se;
  for (std::size_t i = 0; i < d.c_deg.size(); i += skip_c) c.push_back(d.c_deg[i]);
  for (std::size_t g = 0; g < d.gamma_deg.size(); g += skip_g) gamma.push_back(d.gamma_deg[g]);
  for (std::size_t i = 0; i < d.c_deg.size(); i += skip_c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); g += skip_g) {
      cd.push_back(d.at(i, g));
      if (!field.standard_error.empty()) se.push_back(field.standard_error[i * d.gamma_deg.size() + g]);
    }
  }
  return {{"name", field.name},
          {"unit", intensity_symbol(d.unit)},
          {"c_deg", c},
          {"gamma_deg", gamma},
          {"intensity", base64_floats(cd)},
          {"standard_error", base64_floats(se)},
          {"thinned", skip_c * skip_g > 1}};
}

/// Chooses a further plane for the polar diagram; nothing where one plane says all.
std::string plane_slider(const IntensityDistribution& d) {
  if (d.c_deg.size() < 3) return "";
  return fmt::format(
      "<label class=\"control\">Further plane <input type=\"range\" min=\"0\" max=\"{:g}\" step=\"{:g}\" "
      "value=\"0\"><output>C0 – C180</output></label>\n",
      180.0 - d.c_deg[1], d.c_deg[1]);
}

/// The false-colour map that assets/far_field_map.js draws; with the field that is its target, if any.
std::string map_figure(const std::string& name, const FarFieldFigure& f) {
  const std::string target = f.target ? fmt::format(" data-target=\"{}\"", *f.target) : "";
  const std::string shown = f.target ? "<label>Show <select class=\"shown\"><option>result</option>"
                                       "<option>target</option><option>difference</option></select></label> "
                                     : "";
  return fmt::format(
      "<figure class=\"map\" data-detector=\"{1}\"{2} data-file=\"{0}-map\">\n<div class=\"stage\" "
      "tabindex=\"0\" role=\"group\" aria-label=\"False-colour map of {0}: left and right arrow keys turn C, "
      "up and down move gamma\"><canvas width=\"560\" height=\"560\" role=\"img\" aria-label=\"Intensity of "
      "{0} by direction\"></canvas></div>\n<div class=\"ramp\"></div><div class=\"ends\"></div>\n"
      "<output class=\"cursor\" aria-live=\"polite\">Point at the map to read values.</output>\n"
      "<div class=\"control\">{3}<label>Out to <select class=\"reach\"></select></label> <label>Colours "
      "<select "
      "class=\"colours\"><option>viridis</option><option>cividis</option></select></label> <label><input "
      "type=\"checkbox\" class=\"log\"> logarithmic</label></div>\n"
      "<figcaption>{0} by direction: γ outward, C around; lines at 1, 3, 10, 30, 50, 70 and 90 % of the "
      "maximum{4}</figcaption>\n</figure>\n",
      html_escaped(name), f.index, target, shown, save_buttons(name + "-map", {"svg", "png", "csv"}));
}

/// C0 or C90 among a detector's planes.
std::optional<std::string> plane_key(const ResultFigures& result, const std::string& detector, double c_deg) {
  const Json& planes = result.at(detector + "/planes");
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::string key = fmt::format("{}/planes/{}", detector, i);
    if (result.number(key + "/c_deg") == c_deg) return key;
  }
  return std::nullopt;
}

/// An angle with its error, or that it is not determined.
std::string angle_metric(const ResultFigures& result, const std::string& key) {
  return result.at(key).is_null() ? "not determined" : result.figure(key);
}

std::string angle_cards(const ResultFigures& result, const std::string& detector) {
  std::string out;
  for (const double c : {0.0, 90.0}) {
    const auto key = plane_key(result, detector, c);
    if (!key) continue;
    out += card(fmt::format("Beam angle C{:g}", c), angle_metric(result, *key + "/beam_angle_of_maximum_deg"),
                "°",
                fmt::format("50 % of the maximum; field angle (10 %) {}°",
                            angle_metric(result, *key + "/field_angle_of_maximum_deg")));
  }
  return out;
}

}  // namespace

FarFieldFigure add_far_field(HtmlPage& page, const FarFieldTable& field) {
  page.script(assets::far_field_map_js);
  Json data = far_field_json(field);
  const bool thinned = data["thinned"].get<bool>();
  return {page.append("far-fields", std::move(data)), thinned, std::nullopt};
}

std::string intensity_plots(const FarFieldTable& field, const FarFieldFigure& f, const DrawnFigures& drawn) {
  const IntensityDistribution& d = field.distribution;
  const std::string attributes = fmt::format("data-detector=\"{}\"", f.index);
  const DiagramOptions title{.title = field.name};
  const auto figure = [&](const std::string& svg, const std::string& kind, const std::string& caption,
                          const std::string& more = "", const std::string& controls = "") {
    return plot_figure(svg, field.name + "-" + kind, caption + " of " + field.name, attributes + more,
                       controls);
  };
  std::string out = "<div class=\"plots\">\n";
  out += figure(polar_svg(d, {.title = field.name, .standard_error = field.standard_error, .figures = drawn}),
                "polar", "Polar diagram", "", plane_slider(d));
  out += map_figure(field.name, f);
  out += figure(
      cartesian_svg(d, {.title = field.name, .standard_error = field.standard_error, .figures = drawn}),
      "cartesian", "Cartesian diagram");
  out += figure(isocandela_svg(d, title), "isocandela", "Isocandela diagram");
  out += figure(sphere_svg(d, title), "sphere", "All directions");
  out += figure(zonal_svg(d, title), "zonal", "Zonal flux");
  out += figure(cone_svg(d, {.diagram = title, .last_distance_m = kConeDistance_m}), "cone", "Cone diagram");
  out += figure(isolux_svg(d, {.diagram = title, .distance_m = kPlaneDistance_m}), "isolux", "Isolux diagram",
                fmt::format(" data-distance=\"{:g}\"", kPlaneDistance_m));
  out += "</div>\n";
  if (f.thinned) {
    out += fmt::format(
        "<p>Cursor values and saved tables use every second, fourth, ... direction of the grid; "
        "{}.csv has them all.</p>\n",
        html_escaped(field.name));
  }
  return out;
}

std::string direction_map(const std::string& name, const FarFieldFigure& f) { return map_figure(name, f); }

std::string first_far_field_key(const ResultFigures& result) {
  for (std::size_t i = 0; i < result.at("/detectors").size(); ++i) {
    std::string key = fmt::format("/detectors/{}", i);
    if (result.text(key + "/kind") == "far-field") return key;
  }
  return "";
}

std::string peak_card(const ResultFigures& result, const std::string& d) {
  const auto angle = [&](const std::string& name, const std::string& key) {
    return result.at(d + key).is_null() ? name + " not determined"
                                        : name + " " + result.figure(d + key) + "°";
  };
  return card("Peak intensity", result.figure(d + "/peak/intensity"), result.text(d + "/unit"),
              fmt::format("at {}, {}", angle("C", "/peak/c_deg"), angle("γ", "/peak/gamma_deg")));
}

std::string far_field_cards(const ResultFigures& result, const std::string& d) {
  std::string out;
  const double emitted = result.number("/ledger/emitted");
  const std::string unit = result.text("/ledger/unit");
  const double flux = result.number(d + "/flux"), error = result.number(d + "/flux/standard_error");
  out += card("Flux that leaves", result.figure(d + "/flux"), unit, "all directions");
  out += card("Optical efficiency", figure_text(100.0 * flux / emitted, 100.0 * error / emitted), "%",
              "flux that leaves over flux of the sources");
  const std::string cd = result.text(d + "/unit");
  out += peak_card(result, d);
  const std::string fit = result.number(d + "/centre/fit_radius_deg") > 0.0
                              ? fmt::format("a fit within {}°", result.figure(d + "/centre/fit_radius_deg"))
                              : std::string("exactly there, by light followed backward");
  out += card("Intensity on the axis", result.figure(d + "/centre/intensity"), cd,
              fmt::format("at γ {}°, {}", result.figure(d + "/centre/gamma_deg"), fit));
  out += angle_cards(result, d);
  out += card("Noise of the distribution", fmt::format("{:.2g}", 100.0 * result.number(d + "/noise")), "%",
              fmt::format("relative RMS, from the spread of 16 independent parts of the run; {:.2g} % of the "
                          "peak at the noisiest angle",
                          100.0 * result.number(d + "/node_noise")));
  return out;
}

void add_far_field_sections(HtmlPage& page, const ResultFigures& result,
                            const std::vector<FarFieldTable>& fields) {
  std::size_t number = 0;
  for (std::size_t i = 0; i < result.at("/detectors").size(); ++i) {
    const std::string key = fmt::format("/detectors/{}", i);
    if (result.text(key + "/kind") != "far-field") continue;
    const FarFieldTable& field = fields[number];
    const std::string suffix = fields.size() > 1 ? " of " + field.name : "";
    page.section(fmt::format("intensity-{}", number), "Intensity" + suffix,
                 intensity_plots(field, add_far_field(page, field), drawn_figures(result.at(key))) +
                     plane_table(result, key, field.name));
    page.section(fmt::format("zones-{}", number), "Zonal flux" + suffix,
                 "<div class=\"pair\"><div>" + zone_table(result, key, field.name) + "</div>\n<div>" +
                     sum_table(result, key, field.name) + "</div></div>\n");
    ++number;
  }
}

}  // namespace lucerna
