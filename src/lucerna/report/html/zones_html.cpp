// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/zones_html.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/design/validation/zone_check.h"
#include "lucerna/report/html/html_text.h"

namespace lucerna {

namespace {

std::string verdict_html(const ResultFigures& result, const std::string& bound) {
  const std::string verdict = result.text(bound + "/verdict");
  if (verdict == "met") return verdict;
  const bool by_direct = result.has(bound + "/broken_by_direct") && result.at(bound + "/broken_by_direct");
  return "<strong>" + verdict + "</strong>" +
         (by_direct ? " by direct light alone: " + result.figure(bound + "/direct") : "");
}

}  // namespace

std::string zones_html(const ResultFigures& result) {
  if (!result.has("/zones") || result.at("/zones").empty()) return {};
  HtmlTable table{"Zones",
                  {"Zone", "Darkest cell", "Brightest cell", "Mean", "Bound", "Allowed", "Nearest to it",
                   "Where", "Verdict"},
                  {}};
  for (std::size_t i = 0; i < result.at("/zones").size(); ++i) {
    const std::string zone = fmt::format("/zones/{}", i);
    for (std::size_t k = 0; k < result.at(zone + "/bounds").size(); ++k) {
      const std::string bound = fmt::format("{}/bounds/{}", zone, k);
      table.rows.push_back(
          {result.text(zone + "/name"), result.figure(zone + "/min"), result.figure(zone + "/max"),
           result.figure(zone + "/mean"), result.text(bound + "/bound"), result.figure(bound + "/allowed"),
           result.figure(bound + "/found"), result.text(bound + "/place"), verdict_html(result, bound)});
    }
  }
  return html_table(table) +
         fmt::format(
             "<p>Each figure is the mean over a measuring cell, found by the validation's rays; a "
             "verdict needs {:g} standard errors.</p>\n",
             kZoneErrors);
}

}  // namespace lucerna
