// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/cli/output/compare_parts.h"
#include "lucerna/cli/output/describe.h"
#include "lucerna/results/json/views_json.h"

namespace lucerna::cli {

namespace {

Json etendue_json(const EtendueShares& e) {
  return {{"p50", to_json(e.p50_mm2sr)}, {"p90", to_json(e.p90_mm2sr)}, {"p99", to_json(e.p99_mm2sr)}};
}

Json correlation_json(const std::optional<CrossCorrelation>& c) {
  if (!c) return nullptr;
  return {{"value", to_json(c->value)}, {"noise_limit", to_json(c->noise_limit)}};
}

void print_fields(const RayFileComparison& r, Session& session) {
  session.print_line(
      "  illuminance on the focus plane: sum of |differences| of the cells' shares (noise alone)");
  for (const PlaneDifference& d : r.focus_plane) {
    session.print_line(fmt::format("  {:>6g} um {:>9.4f} ({:.4f})", d.cell_um, d.l1, d.floor));
  }
  session.print_line("  normalised cross-correlation (what noise leaves of 1)");
  const auto line = [&](const char* name, const std::optional<CrossCorrelation>& c) {
    if (c) session.print_line(fmt::format("  {:<8}{:>10.5f} ({:.5f})", name, c->value, c->noise_limit));
  };
  line("near", r.fields.near);
  line("mid", r.fields.mid);
  line("far", r.fields.far);
  session.print_line("  etendue of the brightest 50 / 90 / 99 % of the flux, mm2 sr");
  for (const auto& [name, e] : {std::pair{"A", r.reference_etendue}, std::pair{"B", r.test_etendue}}) {
    session.print_line(
        fmt::format("  {:<8}{:>10.4g}{:>10.4g}{:>10.4g}", name, e.p50_mm2sr, e.p90_mm2sr, e.p99_mm2sr));
  }
  for (const LuminancePicture& p : r.pictures) {
    session.print_line(
        fmt::format("  {}: A, B, B - A; {:.4g} mm wide, white = {:.4g} of the flux a mm2 sr, full red or "
                    "blue = {:.4g} more or less",
                    p.file, 2.0 * p.half_width_mm, p.white_per_mm2sr, p.full_colour_per_mm2sr));
  }
}

void print_difference(const std::string& name, const ViewDifference& d, Session& session) {
  session.print_line(fmt::format("  {:<8}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.3f}{:>10.3f}", name,
                                 100.0 * d.error, 100.0 * d.floor, 100.0 * d.excess, 100.0 * d.standard_error,
                                 100.0 * d.raw));
}

void print_views(const RaySetComparison& views, Session& session) {
  session.print_line(
      fmt::format("  {:<8}{:>10}{:>10}{:>10}{:>10}{:>10}", "view", "error", "floor", "excess", "+-", "raw"));
  for (const ViewKind kind : kViewKinds) print_difference(std::string(to_string(kind)), views[kind], session);
}

}  // namespace

Json rays_json(const RayFileComparison& r) {
  Json json;
  json["rays"] = {r.reference_rays, r.test_rays};
  json["views"] = views_json(r.views);
  json["focus_plane"] = Json::array();
  for (const PlaneDifference& d : r.focus_plane) {
    json["focus_plane"].push_back(
        {{"cell_um", to_json(d.cell_um)}, {"l1", to_json(d.l1)}, {"floor", to_json(d.floor)}});
  }
  json["cross_correlation"] = {{"near", correlation_json(r.fields.near)},
                               {"mid", correlation_json(r.fields.mid)},
                               {"far", correlation_json(r.fields.far)}};
  json["etendue_mm2sr"] = {{"reference", etendue_json(r.reference_etendue)},
                           {"test", etendue_json(r.test_etendue)}};
  if (!r.pictures.empty()) json["pictures"] = Json::array();
  for (const LuminancePicture& p : r.pictures) {
    json["pictures"].push_back({{"file", p.file},
                                {"half_width_mm", to_json(p.half_width_mm)},
                                {"white_per_mm2sr", to_json(p.white_per_mm2sr)},
                                {"full_colour_per_mm2sr", to_json(p.full_colour_per_mm2sr)}});
  }
  return json;
}

void print_held_out(const HeldOutComparison& h, Session& session) {
  session.print_line(
      fmt::format("  held out: a model of {} rays against {} others; shares of the l2 norm, in per cent",
                  h.training_rays, h.held_out_rays));
  print_views(h.views, session);
  session.print_line("  the same of illuminance on the focus plane, by size of the cells");
  for (const ScaleDifference& s : h.scales)
    print_difference(fmt::format("{:.3g} mm", s.cell_mm), s.difference, session);
}

void say_rays(const CompareArguments& a, const RayFileComparison& r, Session& session) {
  session.print_line(fmt::format("{} ({} rays) against {} ({} rays); shares of the l2 norm, in per cent",
                                 a.test, r.test_rays, a.reference, r.reference_rays));
  print_views(r.views, session);
  print_fields(r, session);
}

}  // namespace lucerna::cli
