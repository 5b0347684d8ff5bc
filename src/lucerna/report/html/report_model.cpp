// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_model.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/ray_statistics.h"
#include "lucerna/report/html/html_assets.h"
#include "lucerna/report/html/html_page.h"
#include "lucerna/report/html/model_arrays.h"
#include "lucerna/report/html/report_parts.h"
#include "lucerna/report/html/view_maps.h"
#include "lucerna/results/json/views_json.h"
#include "lucerna/results/svg/html_escaped.h"
#include "lucerna/results/svg/svg_curves.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/clusters/cluster_model.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source/model/model_etendue.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

Json etendue_json(const EtendueCurve& curve) {
  return {{"p50", curve.at(0.5)}, {"p90", curve.at(0.9)}, {"p99", curve.at(0.99)}};
}

Curve curve_of(const std::string& name, const EtendueCurve& curve, bool dashed) {
  Curve c{.name = name, .dashed = dashed};
  for (int i = 1; i < 200; ++i) {
    c.x.push_back(0.5 * i);
    c.y.push_back(curve.at(0.005 * i));
  }
  return c;
}

std::string summary(const ResultFigures& result, const std::string& unit, const Json& json) {
  const std::string flux_key = json.contains("flux_lm") ? "/flux_lm" : "/flux_w";
  std::string out = "<dl class=\"cards\">\n";
  out += card("Flux", result.figure(flux_key), unit, "of the whole model, exact");
  const double rays = result.number("/rays"), bytes = result.number("/bytes");
  out += card("Made from", result.figure("/rays"), "rays",
              rays > 0.0 ? fmt::format("{:.3g} times as large as the model", 28.0 * rays / bytes)
                         : "the file does not say");
  out += card("Model file", result.figure("/bytes"), "bytes", "method " + result.text("/method"));
  out += card("Leaves", result.figure("/leaves"), "",
              fmt::format("pieces of constant density on {} support(s)", result.figure("/layers")));
  for (const char* share : {"50", "90"}) {
    const std::string key = fmt::format("/etendue_mm2sr/model/p{}", share);
    out += card(fmt::format("Étendue of {} %", share), result.figure(key), "mm² sr",
                "of the flux, brightest first");
  }
  return out + "</dl>\n";
}

std::string luminance_figure(const std::string& title) {
  return fmt::format(
      "<figure id=\"luminance\" class=\"luminance\" data-file=\"{0}-luminance\">\n<div class=\"stage\" "
      "tabindex=\"0\" "
      "role=\"group\" aria-label=\"Luminance of the source: arrow keys turn it, plus and minus "
      "zoom\"><canvas "
      "width=\"560\" height=\"560\" role=\"img\" aria-label=\"Luminance of the source\"></canvas></div>\n"
      "<div class=\"side\">\n<div class=\"ramp\"></div><div class=\"ends\"></div>\n"
      "<output class=\"cursor\" aria-live=\"polite\">Point at the picture to read values.</output>\n"
      "<label>Azimuth <input type=\"range\" class=\"azimuth\" min=\"-180\" max=\"180\" value=\"0\"></label>\n"
      "<label>Height above the xy plane <input type=\"range\" class=\"height\" min=\"-90\" max=\"90\" "
      "value=\"90\"></label>\n"
      "<label>Seen from <select class=\"from\"><option value=\"\">any</option><option value=\"0 "
      "90\">+z</option><option value=\"0 -90\">-z"
      "</option><option value=\"0 0\">+x</option><option value=\"180 0\">-x</option><option value=\"90 0\">+y"
      "</option><option value=\"-90 0\">-y</option></select></label>\n"
      "<label>Colours <select "
      "class=\"colours\"><option>viridis</option><option>cividis</option></select></label>\n"
      "<label><input type=\"checkbox\" class=\"log\"> logarithmic</label>\n"
      "<label><input type=\"checkbox\" class=\"own\"> scale of this picture alone</label>\n"
      "<label><input type=\"checkbox\" class=\"borders\"> borders of leaves or clusters</label>\n"
      "<div class=\"tools\"><button type=\"button\" class=\"again\">Reset view</button></div>\n</div>\n"
      "<figcaption>Luminance by place across the line of sight, evaluated from the model itself: no rays, no "
      "noise{1}</figcaption>\n</figure>\n",
      html_escaped(title), save_buttons(title + "-luminance", {"svg", "png", "csv"}));
}

void add_luminance(HtmlPage& page, const SourceModel& model, const std::string& title) {
  const auto arrays = model_arrays_json(model);
  if (!arrays) {
    page.section("look", "Luminance",
                 "<p>This source's rays fill no étendue (all on one point or line, or parallel): it has no "
                 "luminance to draw.</p>\n");
    return;
  }
  page.section("look", "Luminance from any direction", luminance_figure(title));
  page.data("model", *arrays);
  page.script(assets::model_view_js);
}

std::vector<std::string> difference_row(const ResultFigures& result, const std::string& name,
                                        const std::string& key) {
  return {name, result.percent(key + "/error"), result.percent(key + "/floor"),
          result.percent(key + "/excess") + " ± " + result.percent(key + "/standard_error"),
          result.percent(key + "/raw")};
}

/// The five views below `key` of the result.
std::string view_table(const ResultFigures& result, const std::string& key, const std::string& title) {
  HtmlTable table{title, {"View", "error", "floor", "excess", "raw"}, {}};
  for (const ViewKind kind : kViewKinds) {
    const std::string name(to_string(kind));
    table.rows.push_back(difference_row(result, name, key + "/" + name));
  }
  return html_table(table);
}

std::string own_rays_table(const ResultFigures& result, bool rays_are_all) {
  return view_table(result, "/views",
                    fmt::format("Model against the rays {}, per cent of the rays' l2 norm in each view",
                                rays_are_all ? "it was made from" : "shown")) +
         "<p>error: what is seen; floor: the counting noise of both; excess: the model's own error; raw: the "
         "noise that the rays themselves have in that view. An excess below raw is a model nearer to the "
         "source than its rays.</p>\n";
}

/// What `compress` found with rays that a model had not seen.
std::string held_out_tables(const ResultFigures& result, const Json& json) {
  if (!json.contains("held_out")) return "";
  HtmlTable scales{"The same of illuminance on the focus plane, in cells of five sizes",
                   {"Cells", "error", "floor", "excess", "raw"},
                   {}};
  for (std::size_t k = 0; k < json["held_out"]["scales"].size(); ++k) {
    const std::string key = fmt::format("/held_out/scales/{}", k);
    scales.rows.push_back(difference_row(result, result.figure(key + "/cell_mm") + " mm", key));
  }
  return view_table(result, "/held_out/views",
                    fmt::format("A model of {} rays against {} others, which it has not seen, per cent",
                                result.figure("/held_out/training_rays"), result.figure("/held_out/rays"))) +
         html_table(scales);
}

std::string layer_table(const SourceModel& model) {
  if (const auto* clusters = dynamic_cast<const ClusterModel*>(&model)) {
    const ClusterData& data = clusters->data();
    HtmlTable table{"The mesh of clusters", {"Surface", "Clusters", "Triangles", "Directional pieces"}, {}};
    table.rows.push_back({std::string(to_string(data.surface.kind)), fmt::format("{}", data.clusters()),
                          fmt::format("{}", clusters->triangles()), fmt::format("{}", data.leaf.size())});
    return html_table(table);
  }
  const auto& data = dynamic_cast<const AdaptiveModel&>(model).data();
  HtmlTable table{"Supports that the light is written down on, and why these",
                  {"Support", "Share of the flux", "Charts", "Trees", "Leaves", "Why"},
                  {}};
  for (const AdaptiveLayer& layer : data.layers) {
    std::size_t trees = 0, leaves = 0;
    for (const AdaptiveChart& chart : layer.charts) {
      trees += chart.trees.size();
      for (const DensityTree& tree : chart.trees) leaves += tree.leaves();
    }
    table.rows.push_back(
        {std::string(to_string(layer.support.kind)), fmt::format("{:.2f} %", 100.0 * layer.share),
         fmt::format("{}", layer.charts.size()), fmt::format("{}", trees), fmt::format("{}", leaves),
         "<span>" + html_escaped(layer.why.empty() ? "–" : layer.why) + "</span>"});
  }
  return html_table(table);
}

/// Views and étendue of model and rays; what they add to `result`.
struct Compared {
  EtendueCurve model_curve, rays_curve;
  std::string view_plots;
};

Compared compare(HtmlPage& page, const SourceModel& model, Json& result, const ModelReportOptions& options,
                 Progress& progress) {
  progress.step("report", 0, 3);
  Compared out;
  out.model_curve = etendue_curve(model);
  result["etendue_mm2sr"]["model"] = etendue_json(out.model_curve);
  progress.step("report", 1, 3);
  if (options.rays == nullptr) return out;
  out.rays_curve = searched_etendue_curve(*options.rays);
  result["etendue_mm2sr"]["rays"] = etendue_json(out.rays_curve);
  progress.step("report", 2, 3);
  const RayBlock drawn = draw_rays(model, Sequence(SequenceKind::random, 1), options.model_rays);
  const Views views(*options.rays);
  ViewCounts reference(views), test(views);
  reference.add(*options.rays);
  test.add(drawn);
  result["views"] = views_json(compare_view_counts(reference, test));
  for (const ViewKind kind : kViewKinds) out.view_plots += view_metrics(page, kind, reference, test);
  return out;
}

void add_etendue(HtmlPage& page, const Compared& compared, bool with_rays) {
  if (compared.model_curve.degenerate()) {
    page.section("etendue", "Étendue", "<p>The rays fill no étendue.</p>\n");
    return;
  }
  CurvePlot plot{.title = "Étendue of the brightest part of the flux",
                 .below = "regions of phase space in the order of falling luminance",
                 .x = {.label = "flux, %", .first = 0.0, .last = 100.0},
                 .y = {.label = "étendue, mm² sr", .log = true}};
  plot.curves.push_back(curve_of("model", compared.model_curve, false));
  if (with_rays && !compared.rays_curve.degenerate())
    plot.curves.push_back(curve_of("rays", compared.rays_curve, true));
  const std::size_t index = page.append("curves", curves_json(plot));
  page.section(
      "etendue", "Étendue",
      plot_figure(curves_svg(plot), "etendue", "Étendue curve", fmt::format("data-curves=\"{}\"", index)));
}

}  // namespace

std::string model_report_html(const SourceModel& model, Json json, const ModelReportOptions& options,
                              Progress& progress) {
  HtmlPage page("Source model", options.title);
  const Compared compared = compare(page, model, json, options, progress);
  const ResultFigures result(json, options.title);
  const std::string unit(symbol(model.flux_unit()));
  page.section("summary", "Summary", summary(result, unit, json));
  add_luminance(page, model, options.title);
  if (options.rays != nullptr) {
    const bool all = options.rays_in_files == 0 || options.rays_in_files == options.rays->size();
    const std::string of = all ? fmt::format("all {} rays", options.rays->size())
                               : fmt::format("{} of {} rays, spread over the files", options.rays->size(),
                                             options.rays_in_files);
    page.section(
        "views", "Rays and model in five views",
        fmt::format("<p>Left {}, at the centre {} rays drawn from the model.</p>\n", of, options.model_rays) +
            held_out_tables(result, json) + own_rays_table(result, all) + compared.view_plots);
  } else {
    page.section("views", "Rays and model in five views",
                 "<p>The rays that the model was made from were not given, so "
                 "there is no comparison.</p>\n");
  }
  add_etendue(page, compared, options.rays != nullptr);
  page.section("layers", "What the model is made of", layer_table(model));
  page.section(
      "provenance", "Where this comes from",
      provenance_html(result, result.at("/seed").is_null() ? "" : fact("Seed", result.figure("/seed")), ""));
  page.data("result", json);
  return page.str();
}

}  // namespace lucerna
