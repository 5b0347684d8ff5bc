// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/report_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/report/html_page.h"
#include "lucerna/report/report_zones.h"
#include "lucerna/report/scene3d.h"
#include "lucerna/report/svg_cartesian.h"
#include "lucerna/report/svg_isocandela.h"
#include "lucerna/report/svg_polar.h"
#include "lucerna/trace/project.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostCells = 40'000;

/// result.json with its figures by JSON pointer.
class Result {
 public:
  explicit Result(const TraceFolder& folder)
      : json_(folder.result), file_((folder.path / "result.json").string()) {}

  const Json& at(const std::string& key) const {
    const Json::json_pointer pointer(key);
    if (!json_.contains(pointer)) throw_input_error(file_, key, "is missing");
    return json_.at(pointer);
  }
  std::uint64_t count(const std::string& key) const {
    const Json& value = at(key);
    if (!value.is_number_unsigned())
      throw_input_error(file_, key, "found {}, expected a count", value.dump());
    return value.get<std::uint64_t>();
  }
  double number(const std::string& key) const {
    const Json& value = at(key);
    if (value.is_null()) return std::nan("");
    if (!value.is_number()) throw_input_error(file_, key, "found {}, expected a number", value.dump());
    return value.get<double>();
  }
  std::string text(const std::string& key) const {
    const Json& value = at(key);
    return html_escaped(value.is_string() ? value.get<std::string>() : value.dump());
  }
  std::string text_or_dash(const std::string& key) const {
    return json_.contains(Json::json_pointer(key)) ? text(key) : "–";
  }
  /// An angle to a tenth of a degree: finer than any grid step can say.
  std::string angle(const std::string& key) const {
    const double value = number(key);
    return fmt::format("<span data-key=\"{}\">{}</span>", html_escaped(key),
                       std::isfinite(value) ? fmt::format("{:.1f}", value) : "–");
  }
  /// The figure as an element that says where it comes from, with its error if `error_key` is given.
  std::string figure(const std::string& key, const std::string& error_key = "") const {
    const double value = number(key);
    const std::string shown = error_key.empty() ? figure_text(value) : figure_text(value, number(error_key));
    return fmt::format("<span data-key=\"{}\">{}</span>", html_escaped(key), shown);
  }

 private:
  const Json& json_;
  std::string file_;
};

/// '/' and '~' of a key, for a JSON pointer (RFC 6901, section 3).
std::string pointer_word(const std::string& key) {
  std::string out;
  for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return out;
}

std::string percent(double part, double whole) {
  return whole > 0.0 ? fmt::format("{:.2f} %", 100.0 * part / whole) : "–";
}

std::string card(const std::string& name, const std::string& value, const std::string& unit,
                 const std::string& note) {
  return fmt::format(
      "<div class=\"card\"><dt>{}</dt><dd><b>{} <small>{}</small></b><span>{}</span></dd></div>\n", name,
      value, unit, note);
}

/// C0 or C90 among a detector's planes.
std::optional<std::string> plane_key(const Result& result, const std::string& detector, double c_deg) {
  const Json& planes = result.at(detector + "/planes");
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::string key = fmt::format("{}/planes/{}", detector, i);
    if (result.number(key + "/c_deg") == c_deg) return key;
  }
  return std::nullopt;
}

std::string angle_cards(const Result& result, const std::string& detector) {
  std::string out;
  for (const double c : {0.0, 90.0}) {
    const auto key = plane_key(result, detector, c);
    if (!key) continue;
    out += card(fmt::format("Beam angle C{:g}", c), result.angle(*key + "/beam_angle_of_maximum_deg"), "°",
                fmt::format("50 % of the maximum; field angle (10 %) {}°",
                            result.angle(*key + "/field_angle_of_maximum_deg")));
  }
  return out;
}

std::string summary(const Result& result, const TraceFolder& folder) {
  const std::string unit = result.text("/ledger/unit");
  const double emitted = result.number("/ledger/emitted");
  std::string out = "<dl class=\"cards\">\n";
  out += card("Flux of the sources", result.figure("/ledger/emitted"), unit,
              fmt::format("{} rays, {} reflections a ray", result.figure("/ledger/rays"),
                          result.figure("/ledger/reflections_per_ray")));
  if (!folder.far_fields.empty()) {
    const std::string d = "/detectors/0";
    const double flux = result.number(d + "/flux"), error = result.number(d + "/flux_standard_error");
    out += card("Flux that leaves", result.figure(d + "/flux", d + "/flux_standard_error"), unit,
                "all directions");
    out += card("Optical efficiency", figure_text(100.0 * flux / emitted, 100.0 * error / emitted), "%",
                "flux that leaves over flux of the sources");
    const std::string cd = result.text(d + "/unit");
    out += card("Peak intensity", result.figure(d + "/peak/intensity"), cd,
                fmt::format("at C {}°, γ {}°; one cell, so noise raises it", result.figure(d + "/peak/c_deg"),
                            result.figure(d + "/peak/gamma_deg")));
    out += card("Intensity on the axis", result.figure(d + "/centre/intensity", d + "/centre/standard_error"),
                cd,
                fmt::format("mean within {}° of γ {}°", result.figure(d + "/centre/cone_half_angle_deg"),
                            result.figure(d + "/centre/gamma_deg")));
    out += angle_cards(result, d);
    out += card("Noise of the distribution", fmt::format("{:.2g}", 100.0 * result.number(d + "/noise")), "%",
                "relative RMS, from the spread of 16 independent parts of the run");
  }
  return out + "</dl>\n";
}

/// One entry of the energy balance.
struct Entry {
  std::string name, key, error_key;
};

std::vector<Entry> ledger_entries(const Result& result) {
  std::vector<Entry> entries{
      {"Out, direct", "/ledger/out_direct", "/ledger/standard_error/out_direct"},
      {"Out, reflected", "/ledger/out_reflected", "/ledger/standard_error/out_reflected"}};
  for (const auto& [cause, flux] : result.at("/ledger/absorbed").items()) {
    const std::string word = pointer_word(cause);
    std::string name = cause;
    std::replace(name.begin(), name.end(), '_', ' ');
    entries.push_back({"Absorbed: " + html_escaped(name), "/ledger/absorbed/" + word,
                       "/ledger/standard_error/absorbed/" + word});
  }
  entries.push_back({"Lost", "/ledger/lost", ""});
  return entries;
}

std::string energy_balance(const Result& result) {
  const double emitted = result.number("/ledger/emitted");
  const std::string unit = result.text("/ledger/unit");
  HtmlTable table{"Where the light went", {"Part", "Flux, " + unit, "Share"}, {}};
  std::string bar, described;
  double sum = 0.0;
  std::size_t index = 0;
  for (const Entry& e : ledger_entries(result)) {
    const double flux = result.number(e.key), share = emitted > 0.0 ? flux / emitted : 0.0;
    sum += flux;
    const std::size_t tone = index++ % 6;
    if (share > 0.0)
      bar += fmt::format("<span class=\"tone{}\" style=\"flex-grow:{:.6f}\"></span>", tone, share);
    described += fmt::format("{} {}; ", e.name, percent(flux, emitted));
    table.rows.push_back({fmt::format("<span class=\"swatch tone{}\"></span>{}", tone, e.name),
                          result.figure(e.key, e.error_key), percent(flux, emitted)});
  }
  table.rows.push_back({"Sum", figure_text(sum), percent(sum, emitted)});
  return fmt::format("<div class=\"bar\" role=\"img\" aria-label=\"{}\">{}</div>\n", described, bar) +
         html_table(table);
}

std::string zone_table(const FarFieldTable& field, const std::string& unit) {
  const double all = zone(field, 0.0, 180.0).flux.mean;
  double up_to = 0.0;
  HtmlTable table{"Flux by zone, " + field.name + "; errors take the cells as independent",
                  {"γ", "Flux, " + unit, "Share", "0° to here"},
                  {}};
  for (const Zone& z : ten_degree_zones(field)) {
    up_to += z.flux.mean;
    table.rows.push_back({fmt::format("{:g}°–{:g}°", z.from_deg, z.to_deg),
                          figure_text(z.flux.mean, z.flux.standard_error), percent(z.flux.mean, all),
                          percent(up_to, all)});
  }
  return html_table(table);
}

std::string sum_table(const FarFieldTable& field, const std::string& unit, double efficiency) {
  const double all = zone(field, 0.0, 180.0).flux.mean;
  HtmlTable table{"Summed zones, " + field.name, {"γ", "Flux, " + unit, "Share"}, {}};
  for (const Zone& z : summed_zones(field)) {
    table.rows.push_back({fmt::format("{:g}°–{:g}°", z.from_deg, z.to_deg),
                          figure_text(z.flux.mean, z.flux.standard_error), percent(z.flux.mean, all)});
  }
  const std::string code = cie_flux_code(field, efficiency);
  const std::string line =
      code.empty() ? "" : fmt::format("<p>CIE flux code (N1 N2 N3 N4 N5): <b>{}</b></p>\n", code);
  return html_table(table) + line;
}

std::string plane_table(const Result& result, const std::string& detector, const std::string& name) {
  HtmlTable table{"Beam and field angles by pair of planes, degrees, " + name,
                  {"Planes", "50 % of maximum", "10 % of maximum", "50 % of centre", "10 % of centre"},
                  {}};
  const Json& planes = result.at(detector + "/planes");
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::string key = fmt::format("{}/planes/{}", detector, i);
    const double c = result.number(key + "/c_deg");
    table.rows.push_back(
        {fmt::format("C{:g}–C{:g}", c, c + 180.0), result.angle(key + "/beam_angle_of_maximum_deg"),
         result.angle(key + "/field_angle_of_maximum_deg"), result.angle(key + "/beam_angle_of_centre_deg"),
         result.angle(key + "/field_angle_of_centre_deg")});
  }
  return fmt::format("<details><summary>Beam and field angles of all planes</summary>\n{}</details>\n",
                     html_table(table));
}

/// The values for the page's script, thinned to kMostCells.
Json far_field_json(const FarFieldTable& field) {
  const IntensityDistribution& d = field.distribution;
  std::size_t skip_c = 1, skip_g = 1;
  const auto kept = [](std::size_t n, std::size_t skip) { return (n + skip - 1) / skip; };
  while (kept(d.c_deg.size(), skip_c) * kept(d.gamma_deg.size(), skip_g) > kMostCells) {
    // The denser axis is thinned first; gamma keeps its last angle only when the steps divide it.
    (kept(d.c_deg.size(), skip_c) > kept(d.gamma_deg.size(), skip_g) ? skip_c : skip_g) *= 2;
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
          {"unit", d.unit == FluxUnit::lumen ? "cd" : "W/sr"},
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

/// The false-colour map that assets/far_field_map.js draws.
std::string map_figure(const FarFieldTable& field, std::size_t index) {
  return fmt::format(
      "<figure class=\"map\" data-detector=\"{1}\" data-file=\"{0}-map\">\n<div class=\"stage\" "
      "tabindex=\"0\" "
      "role=\"group\" aria-label=\"False-colour map of {0}: left and right arrow keys turn C, up and down "
      "move "
      "gamma\"><canvas width=\"560\" height=\"560\" role=\"img\" aria-label=\"Intensity of {0} by "
      "direction\">"
      "</canvas></div>\n<div class=\"ramp\"></div><div class=\"ends\"></div>\n"
      "<output class=\"cursor\" aria-live=\"polite\">Point at the map to read values.</output>\n"
      "<div class=\"control\"><label>Out to <select class=\"reach\"></select></label> <label>Colours <select "
      "class=\"colours\"><option>viridis</option><option>cividis</option></select></label> <label><input "
      "type=\"checkbox\" class=\"log\"> logarithmic</label></div>\n"
      "<figcaption>{0} by direction: γ outward, C around; lines at 1, 3, 10, 30, 50, 70 and 90 % of the "
      "maximum"
      "<span class=\"save\"><button type=\"button\" data-save=\"png\" aria-label=\"Save the map of {0} as "
      "PNG\">"
      "PNG</button><button type=\"button\" data-save=\"csv\" aria-label=\"Save the values of {0} as CSV\">CSV"
      "</button></span></figcaption>\n</figure>\n",
      html_escaped(field.name), index);
}

std::string plots(const FarFieldTable& field, std::size_t index, bool thinned) {
  const std::string attributes = fmt::format("data-detector=\"{}\"", index);
  std::string out = "<div class=\"plots\">\n";
  out += plot_figure(polar_svg(field.distribution, {.title = field.name}), field.name + "-polar",
                     "Polar diagram of " + field.name, attributes, plane_slider(field.distribution));
  out += map_figure(field, index);
  const DiagramOptions title{.title = field.name};
  out += plot_figure(cartesian_svg(field.distribution, title), field.name + "-cartesian",
                     "Cartesian diagram of " + field.name, attributes);
  out += plot_figure(isocandela_svg(field.distribution, title), field.name + "-isocandela",
                     "Isocandela diagram of " + field.name, attributes);
  out += "</div>\n";
  if (thinned) {
    out += fmt::format(
        "<p>Cursor values and saved tables use every second, fourth, ... direction of the grid; "
        "{}.csv has them all.</p>\n",
        html_escaped(field.name));
  }
  return out;
}

std::string provenance(const Result& result, const TraceFolder& folder) {
  std::string out = "<dl class=\"facts\">\n";
  const auto fact = [&](const std::string& name, const std::string& value) {
    out += fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, value);
  };
  fact("Program", "lucerna " + result.text("/program_version"));
  fact("Command", "<code>" + result.text_or_dash("/command") + "</code>");
  fact("Rays", fmt::format("{} to {}, {} sequence, seed {}", result.figure("/rays/first"),
                           result.figure("/rays/last"), result.text("/sequence"), result.figure("/seed")));
  fact("Computed with", fmt::format("{} tracer, {} threads", result.text("/isa"), result.figure("/threads")));
  std::string times;
  for (const auto& [phase, seconds] : result.at("/wall_s").items()) {
    times += fmt::format("{}{} {} s", times.empty() ? "" : ", ", html_escaped(phase),
                         result.figure("/wall_s/" + pointer_word(phase)));
  }
  fact("Wall time", times);
  out += "</dl>\n";
  HtmlTable inputs{"Input files", {"File", "SHA-256"}, {}};
  for (std::size_t i = 0; i < result.at("/inputs").size(); ++i) {
    inputs.rows.push_back({result.text(fmt::format("/inputs/{}/path", i)),
                           fmt::format("<code>{}</code>", result.text(fmt::format("/inputs/{}/sha256", i)))});
  }
  out += html_table(inputs);
  out += fmt::format(
      "<details><summary>Project file</summary>\n<pre tabindex=\"0\" aria-label=\"Project "
      "file\">{}</pre></details>\n",
      html_escaped(folder.project));
  return out;
}

Json scene_data(const Result& result, const Scene& scene) {
  Scene3dOptions options;
  options.seed = result.count("/seed");
  options.sequence = sequence_kind(result.text("/sequence"));
  options.first_ray = result.count("/rays/first");
  return scene3d_json(scene, options);
}

void far_field_sections(HtmlPage& page, const Result& result, const TraceFolder& folder) {
  Json data = Json::array();
  const double emitted = result.number("/ledger/emitted");
  const std::string unit = result.text("/ledger/unit");
  std::size_t number = 0;
  for (std::size_t i = 0; i < result.at("/detectors").size(); ++i) {
    const std::string key = fmt::format("/detectors/{}", i);
    if (result.text(key + "/kind") != "far-field") continue;
    const FarFieldTable& field = folder.far_fields[number];
    data.push_back(far_field_json(field));
    const std::string suffix = folder.far_fields.size() > 1 ? " of " + field.name : "";
    page.section(
        fmt::format("intensity-{}", number), "Intensity" + suffix,
        plots(field, number, data.back()["thinned"].get<bool>()) + plane_table(result, key, field.name));
    page.section(fmt::format("zones-{}", number), "Zonal flux" + suffix,
                 "<div class=\"pair\"><div>" + zone_table(field, unit) + "</div>\n<div>" +
                     sum_table(field, unit, result.number(key + "/flux") / emitted) + "</div></div>\n");
    ++number;
  }
  page.data("far-fields", data);
}

}  // namespace

std::string trace_report_html(const TraceFolder& folder, const TraceReportOptions& options) {
  const Result result(folder);
  const std::filesystem::path name = folder.path.lexically_normal();
  HtmlPage page("Light tracing", (name.has_filename() ? name : name.parent_path()).filename().string());
  page.section("summary", "Summary", summary(result, folder));
  page.section("energy", "Energy balance", energy_balance(result));
  if (options.scene != nullptr) {
    page.section(
        "view", "3D view",
        "<div id=\"scene3d\" class=\"scene3d\"><p class=\"wait\">The 3D view needs scripts.</p></div>\n");
    page.data("scene", scene_data(result, *options.scene));
    page.use_scene3d();
  } else {
    page.section("view", "3D view",
                 fmt::format("<p>There is no 3D view: {}.</p>\n", html_escaped(options.no_scene)));
  }
  far_field_sections(page, result, folder);
  page.section("provenance", "Where this comes from", provenance(result, folder));
  page.data("result", folder.result);
  return page.str();
}

void write_trace_report(const std::filesystem::path& folder, const std::filesystem::path& output) {
  const TraceFolder read = read_trace_folder(folder);
  std::optional<Project> project;
  TraceReportOptions options;
  try {
    project = read_project(folder / "project.toml");
    options.scene = &project->scene;
  } catch (const InputError& e) {
    options.no_scene = e.what();
  }
  write_file(output, trace_report_html(read, options));
}

}  // namespace lucerna
