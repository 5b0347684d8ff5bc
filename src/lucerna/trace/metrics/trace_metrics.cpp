// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lucerna/photometry/binning/binned_intensity.h"
#include "lucerna/photometry/metrics/far_field_metrics.h"
#include "lucerna/ray_file.h"
#include "lucerna/trace/metrics/backward_blend.h"
#include "lucerna/trace/metrics/backward_intensity.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "lucerna/trace/result/node_noise.h"
#include "lucerna/trace/result/plane_extremes.h"

namespace lucerna {

namespace {

double relative_noise(const BinnedIntensity& intensity, const IntensityBins& bins) {
  double noise = 0.0, signal = 0.0;
  for (std::size_t i = 0; i < bins.solid_angle_sr.size(); ++i) {
    const double se = intensity.standard_error_cd[i], cd = intensity.distribution.cd[i];
    noise += bins.solid_angle_sr[i] * se * se;
    signal += bins.solid_angle_sr[i] * cd * cd;
  }
  return signal > 0.0 ? std::sqrt(noise / signal) : std::nan("");
}

FarFieldResult far_field_result(const TraceResult& result, std::size_t index, const Scene* scene,
                                const StopCheck& stop) {
  FarFieldResult f;
  CountedFarField field = far_field(result, index);
  f.intensity = node_intensity(field);
  const PointIntensity exact = scene != nullptr
                                   ? backward_intensity(*scene, result.max_bounces, result.seed, field, stop)
                                   : PointIntensity();
  f.field = std::move(field);
  f.metrics = far_field_metrics(counted_far_field(result, index), f.intensity.distribution.c_deg, exact);
  f.noise = f.node_noise = std::nan("");
  if (!f.intensity.standard_error_cd.empty()) {
    const IntensityDistribution& d = f.intensity.distribution;
    f.noise = relative_noise(f.intensity, intensity_bins(d.c_deg, d.gamma_deg));
    f.node_noise = node_noise(f.intensity);
  }
  return f;
}

PlaneMetrics plane_metrics(PlaneImage image, const PlaneExtremes& extremes) {
  PlaneMetrics f;
  double noise = 0.0, signal = 0.0;
  for (std::size_t i = 0; i < image.value.size(); ++i) {
    noise += image.standard_error[i] * image.standard_error[i];
    signal += image.value[i] * image.value[i];
  }
  f.peak_x_mm = image.grid.cell_x_mm(extremes.max_cell);
  f.peak_y_mm = image.grid.cell_y_mm(extremes.max_cell);
  f.noise = signal > 0.0 ? std::sqrt(noise / signal) : std::nan("");
  f.image = std::move(image);
  f.extremes = extremes;
  return f;
}

/// Of a counted image and what it is averaged with, if with anything.
template <class Extremes>
PlaneMetrics image_metrics(const TraceResult& result, std::size_t index, PlaneImage counted,
                           const ImageBlend& blend, const Extremes& extremes) {
  if (!(blend.weight > 0.0)) {
    const PlaneExtremes e = extremes(result, index, {counted, blend, counted});
    return plane_metrics(std::move(counted), e);
  }
  PlaneImage average = blended(counted, blend);
  const PlaneExtremes e = extremes(result, index, {counted, blend, average});
  return plane_metrics(std::move(average), e);
}

}  // namespace

std::string plane_unit(const PlaneMetrics& f) {
  const bool lumen = f.image.unit == FluxUnit::lumen;
  if (f.view) return lumen ? "cd/m2" : "W/(m2 sr)";
  return lumen ? "lx" : "W/m2";
}

std::string ray_file_name(const RayDetector& detector) {
  return detector.name + std::string(ray_file_ending(detector.format));
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
    return fmt::format("within {:.2g} deg of the axis", std::max(off, p.direction_error_deg));
  if (p.gamma_deg) return fmt::format("gamma {} deg, C not determined", estimate_text(*p.gamma_deg));
  if (p.c_deg) return fmt::format("C {} deg, gamma not determined", estimate_text(*p.c_deg));
  return "direction not determined";
}

namespace {

TraceMetrics figures_of(const TraceResult& result, const Scene* scene, const BackwardLight& wanted,
                        const StopCheck& stop) {
  TraceMetrics figures{ledger(result), {}, {}, {}, {}};
  if (figures.ledger.reflections_per_ray.mean > kMaxBackwardReflections) scene = nullptr;
  // Everything that leaves is in the far field, in every direction.
  const Estimate out = out_flux(result).estimate();
  for (std::size_t i = 0; i < result.far_fields.size(); ++i)
    figures.far_fields.push_back(far_field_result(result, i, wanted.far_fields ? scene : nullptr, stop));
  std::optional<BackwardImage> backward;
  const bool images = wanted.images && (!result.planes.empty() || !result.luminances.empty());
  if (images && scene != nullptr && no_backward_image_reason(*scene).empty())
    backward.emplace(*scene, result.max_bounces);
  for (std::size_t i = 0; i < result.planes.size(); ++i) {
    PlaneImage counted = illuminance(result, i);
    const ImageBlend blend =
        backward ? backward_illuminance(*backward, result, i, counted, stop) : ImageBlend();
    figures.planes.push_back(image_metrics(result, i, std::move(counted), blend, illuminance_extremes));
  }
  for (std::size_t i = 0; i < result.luminances.size(); ++i) {
    PlaneImage counted = luminance(result, i);
    const ImageBlend blend =
        backward ? backward_luminance(*backward, result, i, counted, stop) : ImageBlend();
    figures.luminances.push_back(image_metrics(result, i, std::move(counted), blend, luminance_extremes));
    figures.luminances.back().view = result.luminances[i];
  }
  for (const RayDetector& d : result.ray_detectors) figures.rays.push_back({d, result.out_rays.size(), out});
  return figures;
}

std::string plane_line(const PlaneMetrics& f, std::string_view flux_unit) {
  const std::string noise =
      std::isfinite(f.noise) ? fmt::format("; noise {:.2g} %", 100.0 * f.noise) : std::string();
  return fmt::format("  {}: mean {} {}, peak {} at x {:g}, y {:g} mm, min {}; flux {} {}{}", f.image.name,
                     estimate_text(f.extremes.mean), plane_unit(f), estimate_text(f.extremes.max),
                     f.peak_x_mm, f.peak_y_mm, estimate_text(f.extremes.min), estimate_text(f.image.flux),
                     flux_unit, noise);
}

void far_field_lines(const FarFieldResult& f, std::vector<std::string>& lines) {
  const std::string_view unit = intensity_symbol(f.field.unit);
  const FarFieldMetrics& m = f.metrics;
  const std::string peak =
      m.peak ? fmt::format("{}, {}", estimate_text(m.peak->cd, unit), peak_place_text(*m.peak))
             : std::string("not determined");
  lines.push_back(fmt::format("  {}: peak {}; axis {}", f.field.name, peak, estimate_text(m.axis_cd, unit)));
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

TraceMetrics trace_metrics(const TraceResult& result) { return figures_of(result, nullptr, {}, no_stop()); }

TraceMetrics trace_metrics(const TraceResult& result, const Scene& scene, BackwardLight backward,
                           const Progress& progress) {
  if (progress.stop_requested()) return trace_metrics(result);
  try {
    return figures_of(result, &scene, backward, StopCheck(progress));
  } catch (const Interrupted&) {
    return trace_metrics(result);
  }
}

std::vector<std::string> trace_summary(const TraceMetrics& figures) {
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
  for (const FarFieldResult& f : figures.far_fields) far_field_lines(f, lines);
  for (const auto* images : {&figures.planes, &figures.luminances}) {
    for (const auto& f : *images) lines.push_back(plane_line(f, unit));
  }
  for (const auto& f : figures.rays) {
    lines.push_back(fmt::format("  {}: {} rays, {}", f.detector.name, f.rays, estimate_text(f.flux, unit)));
  }
  return lines;
}

}  // namespace lucerna
