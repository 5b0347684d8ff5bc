// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/zone_figures.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/report/error_json.h"
#include "lucerna/report/html_text.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

Json bound_json(const ZoneBoundCheck& b) {
  return {{"bound", b.key},
          {"allowed", b.allowed},
          {"found", estimate_json(b.found)},
          {"reference", b.reference},
          {"place", b.place},
          {"missing", b.missing},
          {"verdict", std::string(to_string(b.verdict))}};
}

const char* unit_text(bool on_plane, FluxUnit unit) {
  if (unit == FluxUnit::lumen) return on_plane ? "lx" : "cd";
  return on_plane ? "W/m2" : "W/sr";
}

}  // namespace

Json zones_json(const std::vector<ZoneCheck>& zones) {
  Json out = Json::array();
  for (const ZoneCheck& z : zones) {
    Json bounds = Json::array();
    for (const ZoneBoundCheck& b : z.bounds) bounds.push_back(bound_json(b));
    out.push_back({{"name", z.name},
                   {"verdict", std::string(to_string(z.verdict()))},
                   {"min", estimate_json(z.min)},
                   {"max", estimate_json(z.max)},
                   {"mean", estimate_json(z.mean)},
                   {"cells", z.cells},
                   {z.on_plane ? "cell_mm" : "cell_deg", z.cell},
                   {"bounds", std::move(bounds)}});
  }
  return out;
}

std::vector<std::string> zones_summary(const std::vector<ZoneCheck>& zones, FluxUnit unit) {
  if (zones.empty()) return {};
  std::vector<std::string> lines{"  " + zones_headline(zones)};
  lines.push_back(fmt::format("  {:<20}{:>24}{:>24}{:>10}  {:<16}{}", "zone", "darkest cell",
                              "brightest cell", "cells", "bound", "nearest to it"));
  for (const ZoneCheck& z : zones) {
    const char* u = unit_text(z.on_plane, unit);
    std::string head = fmt::format("  {:<20}{:>24}{:>24}{:>10}", z.name, estimate_text(z.min, u),
                                   estimate_text(z.max, u), z.cells);
    for (const ZoneBoundCheck& b : z.bounds) {
      lines.push_back(fmt::format("{}  {:<16}{} at {}: {}", head, fmt::format("{} {:.4g}", b.key, b.allowed),
                                  estimate_text(b.found), b.place, to_string(b.verdict)));
      head.assign(head.size(), ' ');
    }
  }
  const ZoneCheck& z = zones.front();
  lines.push_back(
      fmt::format("    each figure is the mean over a measuring cell ({:g} {} for {}); a verdict "
                  "needs {:g} standard errors",
                  z.cell, z.on_plane ? "mm" : "deg", z.name, kZoneErrors));
  return lines;
}

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
      const std::string verdict = result.text(bound + "/verdict");
      table.rows.push_back({result.text(zone + "/name"), result.figure(zone + "/min"),
                            result.figure(zone + "/max"), result.figure(zone + "/mean"),
                            result.text(bound + "/bound"), result.figure(bound + "/allowed"),
                            result.figure(bound + "/found"), result.text(bound + "/place"),
                            verdict == "met" ? verdict : "<strong>" + verdict + "</strong>"});
    }
  }
  return html_table(table) +
         fmt::format(
             "<p>Each figure is the mean over a measuring cell, found by the validation's rays; a "
             "verdict needs {:g} standard errors.</p>\n",
             kZoneErrors);
}

}  // namespace lucerna
