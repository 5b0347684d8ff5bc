// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/metrics/trace_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna {

namespace {

/// The largest value of a grid may be this share below the exact peak, or so many errors.
constexpr double kMaxShare = 0.05, kMaxErrors = 4.0;
/// A cell as wide as a third of the lobe's half width has a mean of 1 % below the peak of a round top:
/// I = I0 (1 - (t / w)^2 / 2) over a disk of radius w / 6 is I0 (1 - 1 / 144).
constexpr double kStepOfHalfWidth = 1.0 / 3.0;

/// The widest usual step that resolves a lobe; they divide 180 and 360.
double resolving_step_deg(double half_width_deg) {
  constexpr std::array kSteps{5.0, 2.5, 2.0, 1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.02};
  for (const double step : kSteps) {
    if (step <= kStepOfHalfWidth * half_width_deg) return step;
  }
  return 0.01;
}

/// "gamma_step_deg = 0.2 (now 1)", of the steps that are wider than what resolves the lobe; empty if none is.
std::string finer_steps(const FarField& field, const PeakEstimate& peak) {
  const double step = resolving_step_deg(peak.half_width_deg);
  std::string text;
  if (step < field.gamma_step_deg)
    text = fmt::format("gamma_step_deg = {:g} (now {:g})", step, field.gamma_step_deg);
  // Near the poles all planes are near each other.
  const double sine = std::sin(type_c_angles(peak.direction).gamma_rad);
  const double c_step = sine > 0.0 ? resolving_step_deg(peak.half_width_deg / sine) : 360.0;
  if (field.c_count > 1 && c_step < field.c_step_deg) {
    text += fmt::format("{}c_step_deg = {:g} (now {:g})", text.empty() ? "" : ", ", c_step, field.c_step_deg);
  }
  return text;
}

/// Of single directions, by backward light; else of counted light.
bool is_exact(const PeakEstimate& peak) { return peak.radius_deg == 0.0 && peak.c_radius_deg == 0.0; }

std::string coarse_grid(const FarFieldResult& f) {
  const auto& peak = f.metrics.peak;
  const std::vector<double>& cd = f.intensity.distribution.cd;
  const std::vector<double>& errors = f.intensity.standard_error_cd;
  if (!peak || !is_exact(*peak) || cd.empty()) return "";
  const auto largest = std::max_element(cd.begin(), cd.end());
  const double error = errors.empty() ? 0.0 : errors[static_cast<std::size_t>(largest - cd.begin())];
  const double gap = peak->cd.mean - *largest;
  const double noise = std::hypot(peak->cd.standard_error, std::isfinite(error) ? error : 0.0);
  if (!(gap > kMaxShare * peak->cd.mean && gap > kMaxErrors * noise)) return "";
  const std::string finer = finer_steps(f.field, *peak);
  if (finer.empty()) return "";
  const std::string_view unit = intensity_symbol(f.field.unit);
  return fmt::format(
      "{}: its files are on a grid that is too coarse for the beam: their largest value is {:.5g} {}, the "
      "peak "
      "is {}; a finer grid: {} of the detector",
      f.field.name, *largest, unit, estimate_text(peak->cd, unit), finer);
}

/// Counted light knows a lobe that is narrow for its cells only blurred, and not by how much.
std::string coarse_cells(const FarFieldResult& f) {
  const auto& peak = f.metrics.peak;
  if (!peak || is_exact(*peak) || !(f.field.gamma_step_deg > kStepOfHalfWidth * peak->half_width_deg))
    return "";
  return fmt::format(
      "{}: peak, axis and angles are of light counted in cells of {:g} deg, which are wide for a lobe whose "
      "half "
      "width is {:.2g} deg: what they blur is not in all of the errors; a finer grid: gamma_step_deg = {:g} "
      "of the detector",
      f.field.name, f.field.gamma_step_deg, peak->half_width_deg, resolving_step_deg(peak->half_width_deg));
}

std::string dark_mirrors(const Ledger& ledger, const Scene& scene) {
  if (scene.reflectors.empty() || ledger.rays == 0 || ledger.reflections_per_ray.mean > 0.0) return "";
  const auto absorbed = [&](std::string_view cause) {
    const auto found = std::ranges::find(ledger.absorbed, cause, [](const auto& a) { return a.first; });
    return found != ledger.absorbed.end() && found->second.mean > 0.0;
  };
  if (absorbed("mirror")) return "";  // and reflects nothing
  const char* what =
      absorbed("mirror_back") ? "light reaches only the back of the mirrors" : "no light reaches a mirror";
  return fmt::format("{}: of {} rays none is reflected; check position_mm and axis of source and reflector",
                     what, ledger.rays);
}

/// Errors are those of the replicates.
std::string too_few_rays(const Ledger& ledger) {
  if (!std::isnan(ledger.out_direct.standard_error)) return "";
  return fmt::format("{} rays are too few for any error: the figures stand without", ledger.rays);
}

}  // namespace

std::vector<std::string> trace_warnings(const TraceMetrics& figures) {
  std::vector<std::string> warnings;
  for (const FarFieldResult& f : figures.far_fields) {
    for (std::string warning : {coarse_grid(f), coarse_cells(f)}) {
      if (!warning.empty()) warnings.push_back(std::move(warning));
    }
  }
  return warnings;
}

std::vector<std::string> trace_warnings(const TraceMetrics& figures, const Scene& scene,
                                        std::vector<std::string> of_project) {
  std::vector<std::string> warnings = std::move(of_project);
  for (std::string warning : {dark_mirrors(figures.ledger, scene), too_few_rays(figures.ledger)}) {
    if (!warning.empty()) warnings.push_back(std::move(warning));
  }
  for (std::string& warning : trace_warnings(figures)) warnings.push_back(std::move(warning));
  return warnings;
}

}  // namespace lucerna
