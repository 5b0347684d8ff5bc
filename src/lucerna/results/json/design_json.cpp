// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/design_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lucerna/results/json/error_json.h"
#include "lucerna/results/json/trace_json.h"
#include "lucerna/results/json/zone_json.h"
#include "lucerna/results/metrics/trace_warnings.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

template <class Plane>
const Plane* plane_at(const std::vector<Plane>& planes, double c_deg) {
  for (const Plane& plane : planes) {
    if (plane.c_deg == c_deg) return &plane;
  }
  return nullptr;
}

Json plane_json(const PlaneSummary& s) {
  return {{"mean", estimate_json(s.mean)},
          {"min", estimate_json(s.min)},
          {"max", estimate_json(s.max)},
          {"uniformity", estimate_json(s.uniformity)}};
}

Json tolerances_json(const ToleranceSweep& sweep) {
  const ToleranceRanges& r = sweep.ranges;
  Json out{{"source_shift_mm", r.source_shift_mm},
           {"source_tilt_deg", r.source_tilt_deg},
           {"slope_error_mrad", r.slope_error_mrad},
           {"reflectance", r.reflectance},
           {"samples", r.samples},
           {"rays", r.rays}};
  out["spread"] = Json::object();
  for (const ToleranceSpread& s : sweep.spread) {
    out["spread"][s.figure] = {{"nominal", estimate_json(s.nominal)},
                               {"mean", estimate_json(s.mean)},
                               {"standard_deviation", estimate_json(s.standard_deviation)},
                               {"min", estimate_json(s.min)},
                               {"max", estimate_json(s.max)},
                               {"cases", s.cases}};
  }
  out["cases"] = Json::array();
  for (std::size_t i = 0; i < sweep.cases.size(); ++i) {
    const ToleranceCase& c = sweep.cases[i];
    const ToleranceMetrics& f = sweep.figures[i];
    out["cases"].push_back({{"name", c.name},
                            {"shift_mm", {c.shift_mm.x, c.shift_mm.y, c.shift_mm.z}},
                            {"tilt_deg", {c.tilt_x_deg, c.tilt_y_deg}},
                            {"slope_error_mrad", c.slope_error_mrad},
                            {"reflectance", c.reflectance},
                            {"efficiency", estimate_json(f.efficiency)},
                            {"peak", estimate_json(f.peak)},
                            {"centre", estimate_json(f.centre)},
                            {"beam_c0_deg", estimate_json(f.beam_c0_deg)},
                            {"beam_c90_deg", estimate_json(f.beam_c90_deg)}});
  }
  return out;
}

std::string angle(const std::optional<double>& a) {
  return a ? fmt::format("{:.1f} deg", *a) : std::string("-");
}

/// Lines of two columns.
struct Table {
  std::vector<std::string> lines;
  void row(const std::string& what, const std::string& target, const std::string& result) {
    lines.push_back(
        fmt::format("  {:<26}{:>18}{:>30}", what, target, result.size() < 30 ? result : "  " + result));
  }
};

void far_field_rows(const DesignMetrics& f, Table& table) {
  if (!f.target_beam || f.trace.far_fields.empty()) return;
  const BeamMetrics& want = *f.target_beam;
  const FarFieldMetrics& obtained = f.trace.far_fields.front().metrics;
  const std::string_view unit = intensity_symbol(f.trace.ledger.unit);
  const auto amount = [&](double x) { return fmt::format("{:.5g} {}", x, unit); };
  if (obtained.peak) {
    table.row("peak", amount(want.peak.cd), estimate_text(obtained.peak->cd, unit));
    table.row("peak at", fmt::format("C {:g}, {:g} deg", want.peak.c_deg, want.peak.gamma_deg),
              peak_place_text(*obtained.peak));
  }
  table.row("on the axis", amount(want.centre_cd), estimate_text(obtained.axis_cd, unit));
  for (const double c : {0.0, 90.0}) {
    const auto* a = plane_at(want.planes, c);
    const auto* b = plane_at(obtained.planes, c);
    if (a == nullptr || b == nullptr) continue;
    table.row(fmt::format("beam angle C{:g}-C{:g}", c, c + 180.0), angle(a->beam_of_maximum),
              angle_text(b->beam_of_maximum));
    table.row(fmt::format("field angle C{:g}-C{:g}", c, c + 180.0), angle(a->field_of_maximum),
              angle_text(b->field_of_maximum));
  }
}

void plane_rows(const DesignMetrics& f, Table& table) {
  if (!f.target_plane || !f.result_plane) return;
  const char* unit = f.trace.ledger.unit == FluxUnit::lumen ? "lx" : "W/m2";
  const auto amount = [&](const Estimate& x) { return estimate_text(x, unit); };
  const auto share = [](const std::optional<Estimate>& x) {
    return x ? estimate_text(*x) : std::string("-");
  };
  const PlaneSummary &want = *f.target_plane, &obtained = *f.result_plane;
  table.row("mean illuminance", amount(want.mean), amount(obtained.mean));
  table.row("min", amount(want.min), amount(obtained.min));
  table.row("max", amount(want.max), amount(obtained.max));
  table.row("uniformity (min / mean)", share(want.uniformity), share(obtained.uniformity));
}

void tolerance_rows(const ToleranceSweep& sweep, std::vector<std::string>& lines) {
  const ToleranceRanges& r = sweep.ranges;
  lines.push_back(
      fmt::format("  tolerances: source +-{:g} mm, +-{:g} deg; slope error to {:g} mrad; reflectance +-{:g}; "
                  "{} combined cases",
                  r.source_shift_mm, r.source_tilt_deg, r.slope_error_mrad, r.reflectance, r.samples));
  lines.push_back(fmt::format("  {:<16}{:>24}{:>24}{:>24}{:>20}", "", "nominal", "min", "max", "std. dev."));
  const auto text = [](const Estimate& e) {
    return std::isfinite(e.mean) ? estimate_text(e) : std::string("not determined");
  };
  for (const ToleranceSpread& s : sweep.spread) {
    const bool known = std::isfinite(s.standard_deviation.mean);
    lines.push_back(fmt::format("  {:<16}{:>24}{:>24}{:>24}{:>20}", s.figure, text(s.nominal), text(s.min),
                                text(s.max), known ? estimate_text(s.standard_deviation) : "-"));
    if (s.cases < r.samples)
      lines.back() += fmt::format("  (determined in {} of {} cases)", s.cases, r.samples);
  }
}

/// What the bound stands on.
std::string bound_text(const DesignBound& bound) {
  if (!(bound.error > 0.0)) return "neither etendue nor direct light forbids the target";
  if (bound.direct_error >= bound.etendue_error) return "the light that passes the mirror unreflected";
  return fmt::format(
      "the {:.0f} % of the target's light in its brightest boxes: {:.3g} mm2 sr of this aperture and "
      "height hold at most {:.0f} % of the sources' light",
      100.0 * bound.target_share, bound.etendue_mm2sr, 100.0 * bound.max_share);
}

/// The error, headline first, and where the light is.
void error_lines(const DesignFindings& result, bool with_bound, std::vector<std::string>& lines) {
  const DesignError& e = result.error;
  lines.push_back(
      fmt::format("  error {:.2f} +- {:.2f} % in 48 x 48 boxes (24: {:.2f}, 12: {:.2f}); the start had "
                  "{:.1f} %",
                  100.0 * e.c48.excess, 100.0 * e.c48.standard_error, 100.0 * e.c24.excess,
                  100.0 * e.c12.excess, 100.0 * result.start_error.c48.excess));
  if (with_bound)
    lines.push_back(fmt::format("    bound {:.2f} %, reached {:.2f} %: {}", 100.0 * result.bound.error,
                                100.0 * e.c48.excess, bound_text(result.bound)));
  lines.push_back(fmt::format(
      "    noise of {:.3g} M rays, taken out: {:.2f} %; worst box {:.1f} +- {:.1f} % of the target's peak",
      1e-6 * static_cast<double>(e.rays), 100.0 * e.c48.floor, 100.0 * e.worst_cell.mean,
      100.0 * e.worst_cell.standard_error));
}

void light_line(const DesignFindings& result, bool is_lens, bool with_error,
                std::vector<std::string>& lines) {
  const DesignError& e = result.error;
  std::string line =
      fmt::format("  light: {} leaves; {} in the target's rectangle, {} outside ({} {})",
                  share_text(result.efficiency), share_text(e.in_rectangle), share_text(e.outside_share),
                  share_text(e.outside_direct), is_lens ? "past the lens" : "directly");
  if (with_error) {
    line += fmt::format(", where the error is {:.2f} +- {:.2f} %", 100.0 * e.outside.excess,
                        100.0 * e.outside.standard_error);
  }
  lines.push_back(std::move(line));
}

/// The trade between error and light, one line a weight.
void pareto_lines(const DesignFindings& result, std::vector<std::string>& lines) {
  if (result.pareto.empty()) return;
  lines.push_back("  trade: vertex moved   light_weight   error in 48 x 48 boxes   light in the rectangle");
  for (const ParetoPoint& p : result.pareto) {
    lines.push_back(fmt::format(
        "         {:7.1f} mm     {:<12.4g}   {:5.2f} +- {:.2f} %          {:.1f} +- {:.1f} %", p.vertex_mm,
        p.light_weight, 100.0 * p.error.c48.excess, 100.0 * p.error.c48.standard_error,
        100.0 * p.error.in_rectangle.mean, 100.0 * p.error.in_rectangle.standard_error));
  }
}

/// What was tried, beside what it has to beat.
void advice_lines(const DesignFindings& result, std::vector<std::string>& lines) {
  if (result.advice.empty()) return;
  const auto line = [](const std::string& what, const DesignError& e, const char* verdict) {
    return fmt::format("         {:<34} {:5.2f} +- {:.2f} %          {:.1f} +- {:.1f} %  {}", what,
                       100.0 * e.c48.excess, 100.0 * e.c48.standard_error, 100.0 * e.in_rectangle.mean,
                       100.0 * e.in_rectangle.standard_error, verdict);
  };
  lines.push_back("  tried: change                      error in 48 x 48 boxes   light in the rectangle");
  lines.push_back(line("none", result.error, ""));
  for (const AdviceTrial& t : result.advice) {
    lines.push_back(line(t.change, t.error, t.helps ? "helps" : "does not help"));
  }
}

nlohmann::ordered_json advice_json(const std::vector<AdviceTrial>& trials) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const AdviceTrial& t : trials) {
    out.push_back({{"change", t.change},
                   {"error", error_json(t.error)},
                   {"in_rectangle", estimate_json(t.error.in_rectangle)},
                   {"helps", t.helps}});
  }
  return out;
}

nlohmann::ordered_json pareto_json(const std::vector<ParetoPoint>& points) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const ParetoPoint& p : points) {
    out.push_back({{"light_weight", p.light_weight},
                   {"vertex_moved_mm", p.vertex_mm},
                   {"error", error_json(p.error)},
                   {"in_rectangle", estimate_json(p.error.in_rectangle)}});
  }
  return out;
}

/// Errors against the target; of zones alone there is no other target, so only where the light is.
Json error_metrics(const DesignTarget& target, const DesignFindings& result, bool with_bound) {
  Json start{{"in_rectangle", estimate_json(result.start_error.in_rectangle)}};
  if (target.zones != nullptr) start["zones"] = zones_json(result.start_zones);
  if (target.zones_only) {
    return {{"outside",
             {{"share", estimate_json(result.error.outside_share)},
              {"direct", estimate_json(result.error.outside_direct)}}},
            {"start", start}};
  }
  start["error"] = error_json(result.start_error);
  start["outside"] = outside_json(result.start_error);
  Json out{{"error", error_json(result.error)},
           {"outside", outside_json(result.error)},
           {"worst_cell", estimate_json(result.error.worst_cell)}};
  if (with_bound) {
    out["bound"] = {{"error", result.bound.error},
                    {"etendue_error", result.bound.etendue_error},
                    {"direct_error", result.bound.direct_error},
                    {"target_share", result.bound.target_share},
                    {"max_share", result.bound.max_share},
                    {"etendue_mm2sr", result.bound.etendue_mm2sr},
                    {"reason", bound_text(result.bound)}};
  }
  out["start"] = start;
  return out;
}

}  // namespace

DesignForm design_form(const DesignResult& result) {
  return {result.shape.parameter_count(), result.shape.height_mm(), result.validation_s, false};
}

DesignForm design_form(const LensResult& result) {
  return {result.lens.parameter_count(), result.lens.height_mm(), result.validation_s, true};
}

Json design_json(const DesignTarget& target, const DesignFindings& result, const DesignForm& form,
                 const DesignMetrics& f) {
  Json json = error_metrics(target, result, !form.is_lens);
  if (form.is_lens) json["lens"] = true;
  if (target.zones != nullptr) json["zones"] = zones_json(result.zones);
  if (!result.pareto.empty()) json["pareto"] = pareto_json(result.pareto);
  if (!result.advice.empty()) json["advice"] = advice_json(result.advice);
  json["in_rectangle"] = estimate_json(result.error.in_rectangle);
  json["validation"] = {{"rays", result.error.rays}, {"seconds", form.validation_s}};
  json["bergen_fit"] = f.comparison ? estimate_json(f.comparison->bergen_fit) : Json();
  json["wasserstein_deg"] = f.comparison ? estimate_json(f.comparison->wasserstein_deg) : Json();
  json["target"] = {{"file", target.file},
                    {"mode", target.zones_only                  ? "zones"
                             : target.mode == TargetMode::shape ? "shape"
                                                                : "absolute"},
                    {"factor", f.target_factor}};
  if (f.target_beam) json["target"].update(beam_json(*f.target_beam));
  if (f.target_plane) json["target"]["plane"] = plane_json(*f.target_plane);
  if (!f.trace.far_fields.empty()) json.update(beam_json(f.trace.far_fields.front().metrics));
  if (f.result_plane) json["plane"] = plane_json(*f.result_plane);
  json["scale"] = result.error.scale;
  json["efficiency"] = estimate_json(result.efficiency);
  json["losses"] = Json::object();
  if (!form.is_lens) {
    json["losses"] = {{"mirror", estimate_json(result.absorbed)},
                      {"mirror_back", estimate_json(result.back)}};
  }
  json["losses"]["bodies"] = estimate_json(result.bodies);
  json["losses"]["lost"] = estimate_json(result.lost);
  json["evaluations"] = result.evaluations;
  json["rays"] = result.rays;
  json["parameters"] = form.parameters;
  json["height_mm"] = form.height_mm;
  json["limits"] = Json::array();
  for (const LimitCheck& c : result.limits) {
    json["limits"].push_back(
        {{"limit", c.limit}, {"allowed", c.allowed}, {"found", estimate_json(c.found)}, {"held", c.held}});
  }
  if (f.tolerances) json["tolerances"] = tolerances_json(*f.tolerances);
  json["end"] = std::string(to_string(result.end));
  json["remarks"] = result.remarks;
  return json;
}

Json finished_design_json(const std::string& device, const DesignTarget& target, const DesignFindings& result,
                          const DesignForm& form, const DesignMetrics& figures, const Scene& scene,
                          std::vector<std::string> of_project) {
  Json json{{"device", device}};
  json.update(design_json(target, result, form, figures));
  json.update(trace_json(figures.trace));
  json["warnings"] = trace_warnings(figures.trace, scene, std::move(of_project));
  return json;
}

std::vector<std::string> design_summary(const DesignTarget& target, const DesignFindings& result,
                                        const DesignForm& form, const DesignMetrics& f) {
  Table table;
  const bool zones_only = target.zones_only;
  const bool absolute = target.mode == TargetMode::absolute;
  if (!zones_only) {
    table.row("", absolute ? "target" : fmt::format("target x {:.4g}", f.target_factor), "result");
  }
  far_field_rows(f, table);
  plane_rows(f, table);
  std::vector<std::string>& lines = table.lines;
  if (!zones_only) error_lines(result, !form.is_lens, lines);
  light_line(result, form.is_lens, !zones_only, lines);
  for (std::string& line : zones_summary(result.zones, f.trace.ledger.unit)) lines.push_back(std::move(line));
  pareto_lines(result, lines);
  advice_lines(result, lines);
  if (f.comparison) {
    lines.push_back(fmt::format("  all directions: Bergen fit {} of 100, Wasserstein {}",
                                estimate_text(f.comparison->bergen_fit),
                                estimate_text(f.comparison->wasserstein_deg, "deg")));
  }
  lines.push_back(form.is_lens ? fmt::format("  losses: medium {}, lost rays {}", share_text(result.bodies),
                                             share_text(result.lost))
                               : fmt::format("  losses: mirror {}, its back {}, bodies {}, lost rays {}",
                                             share_text(result.absorbed), share_text(result.back),
                                             share_text(result.bodies), share_text(result.lost)));
  for (const LimitCheck& c : result.limits) {
    lines.push_back(fmt::format("  limit {}: {} found, {:.6g} allowed: {}", c.limit, estimate_text(c.found),
                                c.allowed, c.held ? "held" : "NOT HELD"));
  }
  if (f.tolerances) tolerance_rows(*f.tolerances, lines);
  for (const std::string& remark : result.remarks) lines.push_back("  " + remark);
  return lines;
}

}  // namespace lucerna
