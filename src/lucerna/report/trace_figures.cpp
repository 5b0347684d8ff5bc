// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/trace_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "lucerna/rayset/ray_file.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

std::vector<double> steps(std::size_t count, double step_deg) {
  std::vector<double> angles(count);
  for (std::size_t i = 0; i < count; ++i) angles[i] = static_cast<double>(i) * step_deg;
  return angles;
}

double relative_noise(const BinnedIntensity& intensity, const IntensityBins& bins) {
  double noise = 0.0, signal = 0.0;
  for (std::size_t i = 0; i < bins.solid_angle_sr.size(); ++i) {
    const double se = intensity.standard_error_cd[i], cd = intensity.distribution.cd[i];
    noise += bins.solid_angle_sr[i] * se * se;
    signal += bins.solid_angle_sr[i] * cd * cd;
  }
  return signal > 0.0 ? std::sqrt(noise / signal) : std::nan("");
}

FarFieldFigures far_field_figures(FarField field, const Estimate& flux) {
  FarFieldFigures f;
  const auto c = steps(field.c_count, field.c_step_deg),
             gamma = steps(field.gamma_count, field.gamma_step_deg);
  const bool error_known = std::none_of(field.standard_error.begin(), field.standard_error.end(),
                                        [](double se) { return std::isnan(se); });
  const auto intensity_from = field.tent ? intensity_from_tents : intensity_from_bins;
  f.intensity = intensity_from(c, gamma, field.flux,
                               error_known ? field.standard_error : std::vector<double>(), field.unit);
  f.beam = beam_figures(f.intensity.distribution);
  f.flux = flux;
  f.centre_standard_error_cd = std::nan("");
  f.noise = std::nan("");
  if (error_known) {
    const Direction axis = direction_from_type_c({0.0, radians(f.beam.axis_gamma_deg)});
    f.centre_standard_error_cd = cone_mean_error_cd(f.intensity.distribution, f.intensity.standard_error_cd,
                                                    axis, f.beam.centre_cone_deg);
    f.noise = relative_noise(f.intensity, intensity_bins(c, gamma));
  }
  f.field = std::move(field);
  return f;
}

PlaneFigures plane_figures(PlaneImage image, std::optional<LuminanceDetector> view) {
  PlaneFigures f;
  double sum = 0.0, noise = 0.0, signal = 0.0;
  std::size_t best = 0;
  f.least = image.value.front();
  for (std::size_t i = 0; i < image.value.size(); ++i) {
    sum += image.value[i];
    noise += image.standard_error[i] * image.standard_error[i];
    signal += image.value[i] * image.value[i];
    f.least = std::min(f.least, image.value[i]);
    if (image.value[i] > image.value[best]) best = i;
  }
  f.mean.mean = sum / static_cast<double>(image.value.size());
  f.mean.standard_error =
      f.mean.mean * (image.flux.mean > 0.0 ? image.flux.standard_error / image.flux.mean : 0.0);
  f.peak = {image.value[best], image.standard_error[best]};
  f.peak_x_mm = image.grid.cell_x_mm(best);
  f.peak_y_mm = image.grid.cell_y_mm(best);
  f.noise = signal > 0.0 ? std::sqrt(noise / signal) : std::nan("");
  f.image = std::move(image);
  f.view = std::move(view);
  return f;
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }
Json number(const std::optional<double>& value) { return value ? number(*value) : Json(); }

Json ledger_json(const Ledger& l) {
  Json out, errors, absorbed = Json::object(), absorbed_error = Json::object(), causes = Json::object();
  double lost = 0.0;
  for (const auto& [cause, estimate] : l.absorbed) {
    absorbed[cause] = estimate.mean;
    absorbed_error[cause] = number(estimate.standard_error);
  }
  for (const auto& [cause, estimate] : l.lost) {
    causes[cause] = estimate.mean;
    lost += estimate.mean;
  }
  out["unit"] = std::string(symbol(l.unit));
  out["emitted"] = l.emitted;
  out["out_direct"] = l.out_direct.mean;
  out["out_reflected"] = l.out_reflected.mean;
  out["absorbed"] = absorbed;
  out["lost"] = lost;
  out["lost_by_cause"] = causes;
  out["standard_error"] = {{"out_direct", number(l.out_direct.standard_error)},
                           {"out_reflected", number(l.out_reflected.standard_error)},
                           {"absorbed", absorbed_error}};
  out["rays"] = l.rays;
  out["lost_rays"] = l.lost_rays;
  out["reflections_per_ray"] = l.reflections_per_ray;
  return out;
}

Json plane_json(const BeamFigures::Plane& plane) {
  return {{"c_deg", plane.c_deg},
          {"beam_angle_of_maximum_deg", number(plane.beam_of_maximum)},
          {"field_angle_of_maximum_deg", number(plane.field_of_maximum)},
          {"beam_angle_of_centre_deg", number(plane.beam_of_centre)},
          {"field_angle_of_centre_deg", number(plane.field_of_centre)}};
}

Json far_field_json(const FarFieldFigures& f) {
  return {
      {"name", f.field.name},
      {"kind", "far-field"},
      {"unit", f.field.unit == FluxUnit::lumen ? "cd" : "W/sr"},
      {"c_step_deg", f.field.c_step_deg},
      {"gamma_step_deg", f.field.gamma_step_deg},
      {"bins", f.field.tent ? "tent" : "hard"},
      {"flux", f.flux.mean},
      {"flux_standard_error", number(f.flux.standard_error)},
      {"peak",
       {{"intensity", f.beam.peak.cd}, {"c_deg", f.beam.peak.c_deg}, {"gamma_deg", f.beam.peak.gamma_deg}}},
      {"centre",
       {{"intensity", f.beam.centre_cd},
        {"standard_error", number(f.centre_standard_error_cd)},
        {"gamma_deg", f.beam.axis_gamma_deg},
        {"cone_half_angle_deg", f.beam.centre_cone_deg}}},
      {"planes", beam_planes_json(f.beam)},
      {"noise", number(f.noise)}};
}

Json estimate_json(const Estimate& e) {
  return {{"value", e.mean}, {"standard_error", number(e.standard_error)}};
}

Json vector_json(const Vec3& v) { return {v.x, v.y, v.z}; }

Json plane_json(const PlaneFigures& f) {
  const PlaneGrid& grid = f.image.grid;
  const Frame& frame = grid.world_from_plane;
  Json peak = estimate_json(f.peak);
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
  json["flux"] = f.image.flux.mean;
  json["flux_standard_error"] = number(f.image.flux.standard_error);
  json["mean"] = estimate_json(f.mean);
  json["least"] = f.least;
  json["peak"] = peak;
  json["noise"] = number(f.noise);
  return json;
}

Json rays_json(const RayFigures& f, FluxUnit unit) {
  return {{"name", f.detector.name},
          {"kind", "rays"},
          {"unit", std::string(symbol(unit))},
          {"format", f.detector.format},
          {"file", ray_file_name(f.detector)},
          {"rays", f.rays},
          {"flux", f.flux.mean},
          {"flux_standard_error", number(f.flux.standard_error)}};
}

std::string with_error(const Estimate& e) {
  return std::isfinite(e.standard_error) ? fmt::format("{:.5g} +- {:.2g}", e.mean, e.standard_error)
                                         : fmt::format("{:.5g}", e.mean);
}

std::string angle_text(const std::optional<double>& angle) {
  return angle ? fmt::format("{:.1f}", *angle) : std::string("-");
}

std::string plane_line(const PlaneFigures& f, std::string_view flux_unit) {
  const std::string noise =
      std::isfinite(f.noise) ? fmt::format("; noise {:.2g} %", 100.0 * f.noise) : std::string();
  return fmt::format("  {}: mean {} {}, peak {} at x {:g}, y {:g} mm, least {:.4g}; flux {} {}{}",
                     f.image.name, with_error(f.mean), plane_unit(f), with_error(f.peak), f.peak_x_mm,
                     f.peak_y_mm, f.least, with_error(f.image.flux), flux_unit, noise);
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

Json beam_planes_json(const BeamFigures& beam) {
  Json planes = Json::array();
  for (const auto& plane : beam.planes) planes.push_back(plane_json(plane));
  return planes;
}

TraceFigures trace_figures(const TraceResult& result) {
  TraceFigures figures{ledger(result), {}, {}, {}, {}};
  const Ledger& l = figures.ledger;
  // Everything that leaves is in the far field, in every direction. The two shares come from the same rays,
  // so their errors may add up in full.
  const Estimate out{l.out_direct.mean + l.out_reflected.mean,
                     l.out_direct.standard_error + l.out_reflected.standard_error};
  for (std::size_t i = 0; i < result.far_fields.size(); ++i) {
    figures.far_fields.push_back(far_field_figures(far_field(result, i), out));
  }
  for (std::size_t i = 0; i < result.planes.size(); ++i)
    figures.planes.push_back(plane_figures(illuminance(result, i), std::nullopt));
  for (std::size_t i = 0; i < result.luminances.size(); ++i)
    figures.luminances.push_back(plane_figures(luminance(result, i), result.luminances[i]));
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

std::vector<std::string> trace_summary(const TraceFigures& figures) {
  const Ledger& l = figures.ledger;
  const std::string_view unit = symbol(l.unit);
  std::vector<std::string> lines;
  const auto share = [&](double part) { return l.emitted > 0.0 ? 100.0 * part / l.emitted : 0.0; };
  const auto line = [&](std::string_view what, const Estimate& e) {
    lines.push_back(fmt::format("  {:<22}{:>24} {}  {:7.3f} %", what, with_error(e), unit, share(e.mean)));
  };
  lines.push_back(fmt::format("  {:<22}{:>24.6g} {}  {} rays, {:.3g} reflections a ray",
                              "flux of the sources", l.emitted, unit, l.rays, l.reflections_per_ray));
  line("out, direct", l.out_direct);
  line("out, reflected", l.out_reflected);
  for (const auto& [cause, e] : l.absorbed) line("absorbed: " + cause, e);
  for (const auto& [cause, e] : l.lost) {
    if (e.mean > 0.0) line("lost: " + cause, e);
  }
  for (const FarFieldFigures& f : figures.far_fields) {
    const char* intensity_unit = l.unit == FluxUnit::lumen ? "cd" : "W/sr";
    lines.push_back(fmt::format(
        "  {}: peak {:.5g} {} at C {:g}, gamma {:g}; axis {} {} within {:g} deg", f.field.name,
        f.beam.peak.cd, intensity_unit, f.beam.peak.c_deg, f.beam.peak.gamma_deg,
        with_error({f.beam.centre_cd, f.centre_standard_error_cd}), intensity_unit, f.beam.centre_cone_deg));
    for (const auto& plane : f.beam.planes) {
      if (plane.c_deg != 0.0 && plane.c_deg != 90.0) continue;
      lines.push_back(fmt::format(
          "  {}: C{:g}-C{:g}: beam angle {} deg, field angle {} deg (50 % and 10 % of the maximum)",
          f.field.name, plane.c_deg, plane.c_deg + 180.0, angle_text(plane.beam_of_maximum),
          angle_text(plane.field_of_maximum)));
    }
    if (std::isfinite(f.noise)) {
      lines.push_back(fmt::format("  {}: noise {:.2g} % of the distribution (relative RMS)", f.field.name,
                                  100.0 * f.noise));
    }
  }
  for (const auto* images : {&figures.planes, &figures.luminances}) {
    for (const auto& f : *images) lines.push_back(plane_line(f, unit));
  }
  for (const auto& f : figures.rays) {
    lines.push_back(fmt::format("  {}: {} rays, {} {}", f.detector.name, f.rays, with_error(f.flux), unit));
  }
  return lines;
}

}  // namespace lucerna
