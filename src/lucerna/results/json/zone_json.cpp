// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/zone_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/results/json/error_json.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

Json bound_json(const ZoneBoundCheck& b) {
  Json out{{"bound", b.key},
           {"allowed", b.allowed},
           {"found", estimate_json(b.found)},
           {"reference", b.reference},
           {"place", b.place},
           {"missing", b.missing},
           {"verdict", std::string(to_string(b.verdict))}};
  if (b.direct) {
    out["direct"] = estimate_json(*b.direct);
    out["broken_by_direct"] = b.broken_by_direct;
  }
  return out;
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
      if (b.broken_by_direct)
        lines.push_back(
            fmt::format("    {} of {}: {} leave without meeting the mirror, {:.4g} are allowed; "
                        "no mirror with this rim keeps that",
                        b.key, z.name, estimate_text(*b.direct, u), b.allowed));
    }
  }
  const ZoneCheck& z = zones.front();
  lines.push_back(
      fmt::format("    each figure is the mean over a measuring cell ({:g} {} for {}); a verdict "
                  "needs {:g} standard errors",
                  z.cell, z.on_plane ? "mm" : "deg", z.name, kZoneErrors));
  return lines;
}

}  // namespace lucerna
