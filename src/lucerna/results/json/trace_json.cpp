// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/trace_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "lucerna/results/json/error_json.h"
#include "lucerna/results/metrics/figure_text.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

Json ledger_json(const Ledger& l) {
  Json out, absorbed = Json::object(), causes = Json::object();
  for (const auto& [cause, estimate] : l.absorbed) absorbed[cause] = estimate_json(estimate);
  for (const auto& [cause, estimate] : l.lost) causes[cause] = estimate_json(estimate);
  out["unit"] = std::string(symbol(l.unit));
  out["emitted"] = l.emitted;
  out["out_direct"] = estimate_json(l.out_direct);
  out["out_reflected"] = estimate_json(l.out_reflected);
  out["absorbed"] = absorbed;
  out["lost"] = estimate_json(l.all_lost);
  out["lost_by_cause"] = causes;
  out["rays"] = l.rays;
  out["lost_rays"] = l.lost_rays;
  out["reflections_per_ray"] = estimate_json(l.reflections_per_ray);
  return out;
}

template <class Angle>
Json plane_angles_json(double c_deg, const Angle& beam_of_maximum, const Angle& field_of_maximum,
                       const Angle& beam_of_centre, const Angle& field_of_centre) {
  const auto json = [](const Angle& a) {
    if constexpr (std::is_same_v<Angle, std::optional<Estimate>>) {
      return estimate_json(a);
    } else {
      return number_json(a);
    }
  };
  return {{"c_deg", c_deg},
          {"beam_angle_of_maximum_deg", json(beam_of_maximum)},
          {"field_angle_of_maximum_deg", json(field_of_maximum)},
          {"beam_angle_of_centre_deg", json(beam_of_centre)},
          {"field_angle_of_centre_deg", json(field_of_centre)}};
}

template <class Planes>
Json planes_json(const Planes& planes) {
  Json out = Json::array();
  for (const auto& p : planes) {
    out.push_back(plane_angles_json(p.c_deg, p.beam_of_maximum, p.field_of_maximum, p.beam_of_centre,
                                    p.field_of_centre));
  }
  return out;
}

Json peak_json(const std::optional<PeakEstimate>& peak) {
  if (!peak)
    return {{"intensity", {{"value", 0.0}, {"standard_error", nullptr}}},
            {"c_deg", nullptr},
            {"gamma_deg", nullptr}};
  return {{"intensity", estimate_json(peak->cd)},
          {"c_deg", estimate_json(peak->c_deg)},
          {"gamma_deg", estimate_json(peak->gamma_deg)},
          {"direction_error_deg", number_json(peak->direction_error_deg)},
          {"half_width_deg", peak->half_width_deg},
          {"fit_radius_deg", peak->radius_deg},
          {"fit_radius_along_c_deg", peak->c_radius_deg}};
}

template <class Estimates>
Json list_json(const Estimates& estimates) {
  Json out = Json::array();
  for (const Estimate& e : estimates) out.push_back(estimate_json(e));
  return out;
}

Json zones_json(const FarFieldMetrics& m) {
  return {{"zonal", list_json(m.zonal)},
          {"flux_0_30", estimate_json(m.flux_0_30)},
          {"flux_0_40", estimate_json(m.flux_0_40)},
          {"flux_0_60", estimate_json(m.flux_0_60)},
          {"flux_60_90", estimate_json(m.flux_60_90)},
          {"flux_0_90", estimate_json(m.flux_0_90)},
          {"flux_90_180", estimate_json(m.flux_90_180)},
          {"cie_flux_code", list_json(m.cie_flux_code)},
          {"bug", list_json(m.bug_zones)}};
}

Json far_field_json(const FarFieldResult& f) {
  Json json{{"name", f.field.name},
            {"kind", "far-field"},
            {"unit", intensity_symbol(f.field.unit)},
            {"c_step_deg", f.field.c_step_deg},
            {"gamma_step_deg", f.field.gamma_step_deg},
            {"bins", f.field.tent ? "tent" : "hard"},
            {"flux", estimate_json(f.metrics.flux)}};
  json.update(beam_json(f.metrics));
  json["cut_off_deg"] = estimate_json(f.metrics.cut_off_deg);
  json["zones"] = zones_json(f.metrics);
  json["glare"] = {{"radius_deg", f.metrics.glare_radius_deg}, {"intensity", list_json(f.metrics.glare_cd)}};
  json["closure"] = f.intensity.closure;
  json["noise"] = number_json(f.noise);
  json["node_noise"] = number_json(f.node_noise);
  return json;
}

Json vector_json(const Vec3& v) { return {v.x, v.y, v.z}; }

Json plane_json(const PlaneMetrics& f) {
  const PlaneGrid& grid = f.image.grid;
  const Frame& frame = grid.world_from_plane;
  Json peak = estimate_json(f.extremes.max);
  peak["x_mm"] = f.peak_x_mm;
  peak["y_mm"] = f.peak_y_mm;
  Json json{{"name", f.image.name},
            {"kind", f.view ? "luminance" : "plane"},
            {"unit", plane_unit(f)},
            {"position_mm", vector_json(frame.origin_mm())},
            {"normal", vector_json(frame.ez())},
            {"up", vector_json(frame.ey())},
            {"size_mm", {grid.size_x_mm, grid.size_y_mm}},
            {"cells", {grid.nx, grid.ny}}};
  if (f.view && f.view->distance_mm > 0.0) {
    json["from_mm"] = vector_json(frame.point({0, 0, f.view->distance_mm}));
    json["pupil_radius_mm"] = f.view->pupil_radius_mm;
  } else if (f.view) {
    json["half_angle_deg"] = f.view->half_angle_deg;
  }
  json["flux"] = estimate_json(f.image.flux);
  json["mean"] = estimate_json(f.extremes.mean);
  json["min"] = estimate_json(f.extremes.min);
  json["uniformity"] = estimate_json(f.extremes.uniformity);
  json["peak"] = peak;
  json["noise"] = number_json(f.noise);
  return json;
}

Json rays_json(const RayOutputMetrics& f, FluxUnit unit) {
  return {{"name", f.detector.name},           {"kind", "rays"},
          {"unit", std::string(symbol(unit))}, {"format", f.detector.format},
          {"file", ray_file_name(f.detector)}, {"rays", f.rays},
          {"flux", estimate_json(f.flux)}};
}

}  // namespace

Json estimate_json(const std::optional<Estimate>& e) { return e ? estimate_json(*e) : Json(); }

Json beam_json(const FarFieldMetrics& m) {
  return {{"peak", peak_json(m.peak)},
          {"centre",
           {{"intensity", estimate_json(m.axis_cd)},
            {"gamma_deg", m.axis_gamma_deg},
            {"fit_radius_deg", m.axis_radius_deg}}},
          {"planes", planes_json(m.planes)}};
}

Json beam_json(const BeamMetrics& beam) {
  return {
      {"peak", {{"intensity", beam.peak.cd}, {"c_deg", beam.peak.c_deg}, {"gamma_deg", beam.peak.gamma_deg}}},
      {"centre", {{"intensity", beam.centre_cd}, {"gamma_deg", beam.axis_gamma_deg}}},
      {"planes", planes_json(beam.planes)}};
}

DrawnFigures drawn_figures(const Json& f) {
  const auto text = [](const Json& e, const char* unit) {
    if (!e.is_object() || !e["value"].is_number()) return std::string("not determined");
    const double error = e["standard_error"].is_number() ? e["standard_error"].get<double>() : std::nan("");
    return figure_text(e["value"].get<double>(), error) + unit;
  };
  const std::string unit = f["unit"].get<std::string>();
  const Json& peak = f["peak"];
  DrawnFigures d;
  d.peak = fmt::format("Flux {} {} · peak {} at C {}, γ {}", text(f["flux"], ""), unit == "cd" ? "lm" : "W",
                       text(peak["intensity"], (" " + unit).c_str()), text(peak["c_deg"], "°"),
                       text(peak["gamma_deg"], "°"));
  for (const Json& plane : f["planes"]) {
    std::string* const line = plane["c_deg"] == 0.0 ? &d.c0 : (plane["c_deg"] == 90.0 ? &d.c90 : nullptr);
    if (line == nullptr) continue;
    *line = fmt::format("beam 50 % {}, field 10 % {}", text(plane["beam_angle_of_maximum_deg"], "°"),
                        text(plane["field_angle_of_maximum_deg"], "°"));
  }
  return d;
}

DrawnFigures drawn_figures(const FarFieldResult& f) { return drawn_figures(far_field_json(f)); }

Json trace_json(const TraceMetrics& figures) {
  Json out;
  out["ledger"] = ledger_json(figures.ledger);
  out["detectors"] = Json::array();
  for (const auto& f : figures.far_fields) out["detectors"].push_back(far_field_json(f));
  for (const auto* images : {&figures.planes, &figures.luminances}) {
    for (const auto& f : *images) out["detectors"].push_back(plane_json(f));
  }
  for (const auto& f : figures.rays) out["detectors"].push_back(rays_json(f, figures.ledger.unit));
  return out;
}

}  // namespace lucerna
