// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_variants.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/report/html/html_text.h"
#include "lucerna/results/svg/html_escaped.h"

namespace lucerna {

namespace {

/// The number of entries below `key`; 0 where there is no such key.
std::size_t entries(const ResultFigures& result, const std::string& key) {
  return result.has(key) ? result.at(key).size() : 0;
}

/// Error in 48 x 48 boxes and light in the rectangle of what stands below `key`, a cell each.
std::vector<std::string> error_and_light(const ResultFigures& result, const std::string& key) {
  const std::string error = key + "/error/c48", light = key + "/in_rectangle";
  return {result.percent(error + "/excess") + " ± " + result.percent(error + "/standard_error"),
          result.percent(light + "/value", 1) + " ± " + result.percent(light + "/standard_error", 1)};
}

std::vector<std::string> row(std::vector<std::string> begin, const std::vector<std::string>& end) {
  begin.insert(begin.end(), end.begin(), end.end());
  return begin;
}

std::string trade_html(const ResultFigures& result) {
  if (entries(result, "/pareto") == 0) return {};
  HtmlTable table{"Trade between error and light",
                  {"Vertex moved, mm", "light_weight", "Error, %", "Light in the rectangle, %"},
                  {}};
  for (std::size_t i = 0; i < entries(result, "/pareto"); ++i) {
    const std::string key = fmt::format("/pareto/{}", i);
    table.rows.push_back(
        row({result.fixed(key + "/vertex_moved_mm", 1), result.figure(key + "/light_weight")},
            error_and_light(result, key)));
  }
  return "<h3>Trade between error and light</h3>\n<p>Other mirrors for the same target, each fitted with "
         "another weight of light.</p>\n" +
         html_table(table);
}

std::string advice_html(const ResultFigures& result) {
  if (entries(result, "/advice") == 0) return {};
  HtmlTable table{"Advice", {"Change", "Error, %", "Light in the rectangle, %", "Verdict"}, {}};
  if (result.has("/error/c48")) table.rows.push_back(row(row({"none"}, error_and_light(result, "")), {"–"}));
  for (std::size_t i = 0; i < entries(result, "/advice"); ++i) {
    const std::string key = fmt::format("/advice/{}", i);
    const bool helps = result.at(key + "/helps").get<bool>();
    table.rows.push_back(row(row({result.text(key + "/change")}, error_and_light(result, key)),
                             {helps ? "<strong>helps</strong>" : "does not help"}));
  }
  return "<h3>Advice</h3>\n<p>Designs with one thing changed, each in the same time. One helps if it is "
         "better by more than three standard errors without loss of light.</p>\n" +
         html_table(table);
}

std::string tolerances_html(const ResultFigures& result) {
  if (!result.has("/tolerances")) return {};
  HtmlTable table{"Tolerances", {"Figure", "Nominal", "Minimum", "Maximum", "Standard deviation"}, {}};
  for (const auto& [name, spread] : result.at("/tolerances/spread").items()) {
    const std::string key = "/tolerances/spread/" + pointer_word(name);
    table.rows.push_back({html_escaped(name), result.figure(key + "/nominal"), result.figure(key + "/min"),
                          result.figure(key + "/max"), result.figure(key + "/standard_deviation")});
  }
  const auto range = [&](const char* key) { return result.figure(std::string("/tolerances/") + key); };
  return "<h3>Tolerances</h3>\n" +
         fmt::format(
             "<p>{} combined cases: the source moved by up to {} mm and tilted by up to {}°, slope errors up "
             "to {} mrad, reflectance changed by up to {}.</p>\n",
             range("samples"), range("source_shift_mm"), range("source_tilt_deg"), range("slope_error_mrad"),
             range("reflectance")) +
         html_table(table);
}

}  // namespace

std::string warnings_html(const ResultFigures& result) {
  std::string out;
  for (std::size_t i = 0; i < entries(result, "/warnings"); ++i) {
    out += fmt::format("<p class=\"remark\"><strong>Warning:</strong> {}</p>\n",
                       result.text(fmt::format("/warnings/{}", i)));
  }
  return out;
}

std::string variants_html(const ResultFigures& result) {
  return trade_html(result) + advice_html(result) + tolerances_html(result);
}

}  // namespace lucerna
