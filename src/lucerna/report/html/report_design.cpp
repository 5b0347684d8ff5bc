// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/lens/lens_problem.h"
#include "lucerna/design/run/design_problem.h"
#include "lucerna/report/html/report_far_field.h"
#include "lucerna/report/html/report_planes.h"
#include "lucerna/report/html/report_sections.h"
#include "lucerna/report/html/report_target.h"
#include "lucerna/report/html/report_variants.h"
#include "lucerna/report/html/zones_html.h"
#include "lucerna/results/svg/html_escaped.h"
#include "lucerna/results/svg/svg_curves.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kMaxHistoryBytes = std::uint64_t{64} << 20;

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0;;) {
    const std::size_t comma = std::min(line.find(',', at), line.size());
    words.push_back(line.substr(at, comma - at));
    if (comma == line.size()) return words;
    at = comma + 1;
  }
}

/// A share with its error, in per cent.
std::string percent_with_error(const ResultFigures& result, const std::string& key) {
  return result.percent(key + "/value", key + "/standard_error");
}

/// The same of an error in boxes, less its noise.
std::string box_error_text(const ResultFigures& result, const std::string& key) {
  return result.percent(key + "/excess", key + "/standard_error");
}

/// Against the target: not where zones are all there is.
std::string error_cards(const ResultFigures& result) {
  if (!result.has("/error/c48")) return {};
  std::string out =
      card("Error", box_error_text(result, "/error/c48"), "%",
           fmt::format("l2 in 48 × 48 boxes over the target's rectangle, noise of {} % taken out; {} % in "
                       "24 × 24, {} % in 12 × 12",
                       result.percent("/error/c48/floor"), box_error_text(result, "/error/c24"),
                       box_error_text(result, "/error/c12")));
  out += card("It began at", box_error_text(result, "/start/error/c48"), "%",
              "error of what the search began with");
  out += card("Error outside", box_error_text(result, "/outside/error"), "%",
              "l2 over what lies beside the target's rectangle, relative to the target in it");
  return out + card("Worst box", percent_with_error(result, "/worst_cell"), "%",
                    "largest deviation of a 48th box, of the target's peak; noise raises it");
}

std::string zones_card(const ResultFigures& result) {
  if (!result.has("/zones")) return {};
  std::size_t met = 0;
  const std::size_t all = result.at("/zones").size();
  for (std::size_t i = 0; i < all; ++i) met += result.text(fmt::format("/zones/{}/verdict", i)) == "met";
  return card("Zones met", fmt::format("{} of {}", met, all), "",
              "bounds on the light of the target's zones");
}

std::string summary(const ResultFigures& result) {
  std::string out = "<dl class=\"cards\">\n" + zones_card(result) + error_cards(result);
  out += card(
      "In the target's rectangle", percent_with_error(result, "/in_rectangle"), "%",
      fmt::format("of the sources' flux; {} % leaves the luminaire, {} % goes elsewhere, {} % directly",
                  percent_with_error(result, "/efficiency"), percent_with_error(result, "/outside/share"),
                  percent_with_error(result, "/outside/direct")));
  out += card(
      "Parameters", result.figure("/parameters"), "",
      fmt::format("{} {} mm high", result.has("/lens") ? "lens" : "mirror", result.figure("/height_mm")));
  out += card("Evaluations", result.figure("/evaluations"), "",
              fmt::format("{} rays; ended: {}", result.figure("/rays"), result.text("/end")));
  if (const std::string key = first_far_field_key(result); !key.empty()) {
    out += peak_card(result, key);
  }
  out += "</dl>\n";
  return out;
}

/// The error that no mirror of this aperture and height can fall below, and why; nothing for lenses.
std::string bound_html(const ResultFigures& result) {
  if (!result.has("/bound/reason")) return {};
  const std::string reason = result.text("/bound/reason");
  if (!(result.number("/bound/error") > 0.0)) return fmt::format("<p>Bound: {}.</p>\n", reason);
  return fmt::format(
      "<p>Bound: no mirror of this aperture and height has an error below {} %, because of {}.</p>\n",
      result.percent("/bound/error"), reason);
}

/// Remarks, and what result.json says of limits, whatever its shape.
std::string project_limits_html(const ResultFigures& result) {
  std::string out = zones_html(result);
  if (result.has("/limits") && !result.at("/limits").empty()) {
    HtmlTable table{"Limits", {"Limit", "Found", "Allowed", "Verdict"}, {}};
    for (std::size_t i = 0; i < result.at("/limits").size(); ++i) {
      const std::string key = fmt::format("/limits/{}", i);
      table.rows.push_back({result.text(key + "/limit"), result.figure(key + "/found"),
                            result.figure(key + "/allowed"),
                            result.at(key + "/held").get<bool>() ? "held" : "<strong>not held</strong>"});
    }
    out += html_table(table);
  }
  if (result.has("/remarks")) {
    for (std::size_t i = 0; i < result.at("/remarks").size(); ++i)
      out += fmt::format("<p class=\"remark\">{}</p>\n", result.text(fmt::format("/remarks/{}", i)));
  }
  return out.empty() ? "<p>No limit of the project stood in the way.</p>\n" : out;
}

std::string convergence(HtmlPage& page, const std::vector<HistoryLine>& history) {
  if (history.empty()) return "<p>The history is empty: the design ended before its first step.</p>\n";
  Curve best{.name = "accepted"}, floor{.name = "noise", .dashed = true},
      tried{.name = "rejected", .dots = true};
  for (const HistoryLine& line : history) {
    Curve& curve = line.accepted ? best : tried;
    curve.x.push_back(line.total_rays * 1e-6);
    curve.y.push_back(100.0 * line.relative_rms);
    floor.x.push_back(line.total_rays * 1e-6);
    floor.y.push_back(100.0 * line.floor);
  }
  CurvePlot plot{
      .title = "Convergence",
      .below = "relative RMS in the bins of each stage; finer bins and more rays from stage to stage",
      .x = {.label = "rays so far, million"},
      .y = {.label = "relative RMS, %", .log = true},
      .curves = {best, floor}};
  if (!tried.x.empty()) plot.curves.push_back(tried);
  const std::size_t index = page.append("curves", curves_json(plot));
  HtmlTable stages{"Stages", {"Stage", "Steps", "Rays", "RMS at its end", "Noise"}, {}};
  for (std::size_t i = 0; i < history.size();) {
    std::size_t j = i;
    double last = history[i].relative_rms;
    for (; j < history.size() && history[j].stage == history[i].stage; ++j) {
      if (history[j].accepted) last = history[j].relative_rms;
    }
    const double before = i > 0 ? history[i - 1].total_rays : 0.0;
    stages.rows.push_back({fmt::format("{:g}", history[i].stage), fmt::format("{}", j - i),
                           fmt::format("{:.3g} M", 1e-6 * (history[j - 1].total_rays - before)),
                           fmt::format("{:.3g} %", 100.0 * last),
                           fmt::format("{:.2g} %", 100.0 * history[j - 1].floor)});
    i = j;
  }
  return plot_figure(curves_svg(plot), "convergence", "Convergence of the design",
                     fmt::format("data-curves=\"{}\"", index)) +
         html_table(stages);
}

std::string design_facts(const ResultFigures& result) {
  return fact("Seed", result.figure("/seed")) +
         fact("Target's factor", result.has("/target/factor") ? result.figure("/target/factor") : "–");
}

}  // namespace

std::vector<HistoryLine> read_history(std::string_view csv, const std::string& file) {
  std::map<std::string_view, std::size_t> column;
  std::vector<HistoryLine> history;
  for (std::size_t line = 1; !csv.empty(); ++line) {
    const std::size_t end = std::min(csv.find('\n'), csv.size());
    std::string_view text = csv.substr(0, end);
    csv.remove_prefix(std::min(end + 1, csv.size()));
    if (text.ends_with('\r')) text.remove_suffix(1);
    const auto words = words_of(text);
    if (line == 1) {
      for (std::size_t i = 0; i < words.size(); ++i) column[words[i]] = i;
      continue;
    }
    const auto number = [&](std::string_view name) {
      const auto found = column.find(name);
      double value = 0.0;
      if (found == column.end() || found->second >= words.size())
        throw_input_error(file, fmt::format("line {}", line), "has no column '{}'", name);
      const std::string_view word = words[found->second];
      const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc() || stop != word.data() + word.size())
        throw_input_error(file, fmt::format("line {}", line), "found '{}', expected a number as '{}'", word,
                          name);
      return value;
    };
    history.push_back({number("evaluations"), number("stage"), number("total_rays"), number("relative_rms"),
                       number("floor"), number("efficiency"), number("accepted") != 0.0});
  }
  return history;
}

std::string design_report_html(const TraceFolder& folder, const std::vector<HistoryLine>& history,
                               const DesignReportOptions& options) {
  const ResultFigures result(folder.result, (folder.path / "result.json").string());
  HtmlPage page(result.has("/lens") ? "Lens design" : "Reflector design", folder_title(folder.path));
  page.section("summary", "Summary", warnings_html(result) + summary(result));
  page.section("limits", "What limits it", bound_html(result) + project_limits_html(result));
  const bool zones_only = options.target != nullptr && options.target->zones_only;
  if (zones_only) {
    page.section("target", "Target and result",
                 "<p>The target is its zones: see the table above. There is no light to compare with.</p>\n");
  } else if (options.target != nullptr) {
    add_target_section(page, *options.target, result, folder);
  } else {
    page.section("target", "Target and result",
                 fmt::format("<p>There is no comparison: {}.</p>\n", html_escaped(options.no_problem)));
  }
  if (const std::string variants = variants_html(result); !variants.empty())
    page.section("variants", "Variants", variants);
  page.section("convergence", "Convergence", convergence(page, history));
  page.section("energy", "Efficiency and losses", energy_balance_html(result));
  ViewSource view{.no_scene = options.no_problem, .options = {.seed = result.count("/seed") + 1}};
  view.scene = options.scene;
  add_view_section(page, view);
  add_far_field_sections(page, result, folder.far_fields);
  add_plane_sections(page, result, folder.planes);
  page.section("provenance", "Where this comes from",
               provenance_html(result, design_facts(result), folder.project));
  page.data("result", folder.result);
  return page.str();
}

bool is_design_folder(const std::filesystem::path& folder) {
  return std::filesystem::exists(folder / "history.csv") && std::filesystem::exists(folder / "result.json");
}

void write_design_report(const std::filesystem::path& folder, const std::filesystem::path& output) {
  const TraceFolder read = read_trace_folder(folder);
  const std::filesystem::path csv = folder / "history.csv", project = folder / "project.toml";
  const auto history = read_history(read_file(csv, kMaxHistoryBytes), csv.string());
  std::optional<DesignProblem> mirror;
  std::optional<LensProblem> lens;
  std::optional<Project> finished;
  std::optional<DesignTarget> target;
  DesignReportOptions options;
  try {
    Project given = read_project(project);
    if (is_finished_lens(given)) {
      finished.emplace(std::move(given));
      options.target = &target.emplace(finished_lens_target(*finished, project));
      options.scene = &finished->scene;
    } else if (is_lens_design(given)) {
      lens.emplace(lens_problem(std::move(given), project));
      options.target = &lens->target;
      options.scene = &lens->project.scene;
    } else {
      mirror.emplace(design_problem(std::move(given), project));
      options.target = &mirror->target;
      options.scene = &mirror->project.scene;
    }
  } catch (const InputError& e) {
    options.no_problem = e.what();
  }
  write_file(output, design_report_html(read, history, options));
}

}  // namespace lucerna
