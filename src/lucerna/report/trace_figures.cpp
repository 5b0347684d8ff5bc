// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/trace_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

#include "lucerna/rayset/ray_file.h"
#include "lucerna/report/error_json.h"
#include "lucerna/report/html_text.h"
#include "lucerna/trace/node_noise.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

double relative_noise(const BinnedIntensity& intensity, const IntensityBins& bins) {
  double noise = 0.0, signal = 0.0;
  for (std::size_t i = 0; i < bins.solid_angle_sr.size(); ++i) {
    const double se = intensity.standard_error_cd[i], cd = intensity.distribution.cd[i];
    noise += bins.solid_angle_sr[i] * se * se;
    signal += bins.solid_angle_sr[i] * cd * cd;
  }
  return signal > 0.0 ? std::sqrt(noise / signal) : std::nan("");
}

FarFieldFigures far_field_figures(const TraceResult& result, std::size_t index) {
  FarFieldFigures f;
  f.field = far_field(result, index);
  f.intensity = node_intensity(f.field);
  f.metrics = far_field_metrics(counted_far_field(result, index), f.intensity.distribution.c_deg);
  f.noise = f.node_noise = std::nan("");
  if (!f.intensity.standard_error_cd.empty()) {
    const IntensityDistribution& d = f.intensity.distribution;
    f.noise = relative_noise(f.intensity, intensity_bins(d.c_deg, d.gamma_deg));
    f.node_noise = node_noise(f.intensity);
  }
  return f;
}

PlaneFigures plane_figures(PlaneImage image, const PlaneExtremes& extremes,
                           std::optional<LuminanceDetector> view) {
  PlaneFigures f;
  double noise = 0.0, signal = 0.0;
  for (std::size_t i = 0; i < image.value.size(); ++i) {
    noise += image.standard_error[i] * image.standard_error[i];
    signal += image.value[i] * image.value[i];
  }
  f.peak_x_mm = image.grid.cell_x_mm(extremes.greatest_cell);
  f.peak_y_mm = image.grid.cell_y_mm(extremes.greatest_cell);
  f.noise = signal > 0.0 ? std::sqrt(noise / signal) : std::nan("");
  f.image = std::move(image);
  f.extremes = extremes;
  f.view = std::move(view);
  return f;
}

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

Json far_field_json(const FarFieldFigures& f) {
  Json json{{"name", f.field.name},
            {"kind", "far-field"},
            {"unit", f.field.unit == FluxUnit::lumen ? "cd" : "W/sr"},
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

Json plane_json(const PlaneFigures& f) {
  const PlaneGrid& grid = f.image.grid;
  const Frame& frame = grid.world_from_plane;
  Json peak = estimate_json(f.extremes.greatest);
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
  json["least"] = estimate_json(f.extremes.least);
  json["uniformity"] = estimate_json(f.extremes.uniformity);
  json["peak"] = peak;
  json["noise"] = number_json(f.noise);
  return json;
}

Json rays_json(const RayFigures& f, FluxUnit unit) {
  return {{"name", f.detector.name},           {"kind", "rays"},
          {"unit", std::string(symbol(unit))}, {"format", f.detector.format},
          {"file", ray_file_name(f.detector)}, {"rays", f.rays},
          {"flux", estimate_json(f.flux)}};
}

std::string plane_line(const PlaneFigures& f, std::string_view flux_unit) {
  const std::string noise =
      std::isfinite(f.noise) ? fmt::format("; noise {:.2g} %", 100.0 * f.noise) : std::string();
  return fmt::format("  {}: mean {} {}, peak {} at x {:g}, y {:g} mm, least {}; flux {} {}{}", f.image.name,
                     estimate_text(f.extremes.mean), plane_unit(f), estimate_text(f.extremes.greatest),
                     f.peak_x_mm, f.peak_y_mm, estimate_text(f.extremes.least), estimate_text(f.image.flux),
                     flux_unit, noise);
}

}  // namespace

std::string plane_unit(const PlaneFigures& f) {
  const bool lumen = f.image.unit == FluxUnit::lumen;
  if (f.view) return lumen ? "cd/m2" : "W/(m2 sr)";
  return lumen ? "lx" : "W/m2";
}

std::string ray_file_name(const RayDetector& detector) {
  return detector.name + std::string(ray_file_ending(detector.format));
}

Json estimate_json(const std::optional<Estimate>& e) { return e ? estimate_json(*e) : Json(); }

Json beam_json(const FarFieldMetrics& m) {
  return {{"peak", peak_json(m.peak)},
          {"centre",
           {{"intensity", estimate_json(m.axis_cd)},
            {"gamma_deg", m.axis_gamma_deg},
            {"fit_radius_deg", m.axis_radius_deg}}},
          {"planes", planes_json(m.planes)}};
}

Json beam_json(const BeamFigures& beam) {
  return {
      {"peak", {{"intensity", beam.peak.cd}, {"c_deg", beam.peak.c_deg}, {"gamma_deg", beam.peak.gamma_deg}}},
      {"centre", {{"intensity", beam.centre_cd}, {"gamma_deg", beam.axis_gamma_deg}}},
      {"planes", planes_json(beam.planes)}};
}

std::string angle_text(const std::optional<Estimate>& angle) {
  return angle ? estimate_text(*angle, "deg") : std::string("not determined");
}

std::string peak_place_text(const PeakEstimate& p) {
  if (p.c_deg && p.gamma_deg)
    return fmt::format("C {}, gamma {} deg", estimate_text(*p.c_deg), estimate_text(*p.gamma_deg));
  const double gamma = degrees(type_c_angles(p.direction).gamma_rad), off = std::min(gamma, 180.0 - gamma);
  // The draws of a ring of light are far apart too, but all as far from the axis.
  if (p.gamma_deg && off <= 2.0 * std::min(p.direction_error_deg, 2.0 * p.gamma_deg->standard_error))
    return fmt::format("on the axis within {:.2g} deg", std::max(off, p.direction_error_deg));
  if (p.gamma_deg) return fmt::format("gamma {} deg, C not determined", estimate_text(*p.gamma_deg));
  if (p.c_deg) return fmt::format("C {} deg, gamma not determined", estimate_text(*p.c_deg));
  return "not determined";
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

DrawnFigures drawn_figures(const FarFieldFigures& f) { return drawn_figures(far_field_json(f)); }

TraceFigures trace_figures(const TraceResult& result) {
  TraceFigures figures{ledger(result), {}, {}, {}, {}};
  // Everything that leaves is in the far field, in every direction.
  const Estimate out = out_flux(result).estimate();
  for (std::size_t i = 0; i < result.far_fields.size(); ++i)
    figures.far_fields.push_back(far_field_figures(result, i));
  for (std::size_t i = 0; i < result.planes.size(); ++i) {
    const PlaneImage image = illuminance(result, i);
    figures.planes.push_back(plane_figures(image, illuminance_extremes(result, i, image), std::nullopt));
  }
  for (std::size_t i = 0; i < result.luminances.size(); ++i) {
    const PlaneImage image = luminance(result, i);
    figures.luminances.push_back(
        plane_figures(image, luminance_extremes(result, i, image), result.luminances[i]));
  }
  for (const RayDetector& d : result.ray_detectors) figures.rays.push_back({d, result.out_rays.size(), out});
  return figures;
}

Json trace_json(const TraceFigures& figures) {
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

namespace {

void far_field_lines(const FarFieldFigures& f, std::vector<std::string>& lines) {
  const char* unit = f.field.unit == FluxUnit::lumen ? "cd" : "W/sr";
  const FarFieldMetrics& m = f.metrics;
  if (m.peak) {
    lines.push_back(fmt::format("  {}: peak {}, {}; axis {}", f.field.name, estimate_text(m.peak->cd, unit),
                                peak_place_text(*m.peak), estimate_text(m.axis_cd, unit)));
  }
  for (const auto& plane : m.planes) {
    if (plane.c_deg != 0.0 && plane.c_deg != 90.0) continue;
    lines.push_back(
        fmt::format("  {}: C{:g}-C{:g}: beam angle {}, field angle {} (50 % and 10 % of the maximum)",
                    f.field.name, plane.c_deg, plane.c_deg + 180.0, angle_text(plane.beam_of_maximum),
                    angle_text(plane.field_of_maximum)));
  }
  if (std::isfinite(f.node_noise)) {
    lines.push_back(fmt::format(
        "  {}: noise {:.2g} % of the peak at the noisiest angle, {:.2g} % of the distribution (relative RMS)",
        f.field.name, 100.0 * f.node_noise, 100.0 * f.noise));
  }
}

}  // namespace

std::vector<std::string> trace_summary(const TraceFigures& figures) {
  const Ledger& l = figures.ledger;
  const std::string_view unit = symbol(l.unit);
  std::vector<std::string> lines;
  const auto share = [&](double part) { return l.emitted > 0.0 ? 100.0 * part / l.emitted : 0.0; };
  const auto line = [&](std::string_view what, const Estimate& e) {
    lines.push_back(fmt::format("  {:<22}{:>24} {}  {:7.3f} %", what, estimate_text(e), unit, share(e.mean)));
  };
  lines.push_back(fmt::format("  {:<22}{:>24.6g} {}  {} rays, {} reflections a ray", "flux of the sources",
                              l.emitted, unit, l.rays, estimate_text(l.reflections_per_ray)));
  line("out, direct", l.out_direct);
  line("out, reflected", l.out_reflected);
  for (const auto& [cause, e] : l.absorbed) line("absorbed: " + cause, e);
  for (const auto& [cause, e] : l.lost) {
    if (e.mean > 0.0) line("lost: " + cause, e);
  }
  for (const FarFieldFigures& f : figures.far_fields) far_field_lines(f, lines);
  for (const auto* images : {&figures.planes, &figures.luminances}) {
    for (const auto& f : *images) lines.push_back(plane_line(f, unit));
  }
  for (const auto& f : figures.rays) {
    lines.push_back(fmt::format("  {}: {} rays, {}", f.detector.name, f.rays, estimate_text(f.flux, unit)));
  }
  return lines;
}

}  // namespace lucerna
