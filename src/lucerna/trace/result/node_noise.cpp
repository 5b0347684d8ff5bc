// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/result/node_noise.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lucerna/photometry/metrics/peak_estimate.h"

namespace lucerna {

namespace {

/// Values below this share of the largest may be noisier than what is asked for.
constexpr double kCountsFrom = 0.01;

std::vector<double> steps(std::size_t count, double step_deg) {
  std::vector<double> angles(count);
  for (std::size_t i = 0; i < count; ++i) angles[i] = static_cast<double>(i) * step_deg;
  return angles;
}

}  // namespace

BinnedIntensity node_intensity(const CountedFarField& field) {
  const auto c = steps(field.c_count, field.c_step_deg);
  auto gamma = steps(field.gamma_count, field.gamma_step_deg);
  gamma.back() = 180.0;
  const auto intensity_from = field.tent ? intensity_from_tents : intensity_from_bins;
  return intensity_from(c, gamma, field.flux, field.replicated, field.unit);
}

double node_noise(const BinnedIntensity& intensity) {
  if (intensity.standard_error_cd.empty()) return std::nan("");
  const std::vector<double>& cd = intensity.distribution.cd;
  const double peak = *std::max_element(cd.begin(), cd.end());
  double worst = 0.0;
  for (std::size_t i = 0; i < cd.size(); ++i) {
    if (cd[i] >= kCountsFrom * peak) worst = std::max(worst, intensity.standard_error_cd[i]);
  }
  return peak > 0.0 ? worst / peak : 0.0;
}

double node_noise(const TraceResult& result) {
  double worst = std::nan("");
  for (std::size_t i = 0; i < result.far_fields.size(); ++i)
    worst = std::fmax(worst, node_noise(node_intensity(far_field(result, i))));
  return worst;
}

double peak_noise(const TraceResult& result) {
  double worst = std::nan("");
  for (std::size_t i = 0; i < result.far_fields.size(); ++i) {
    const std::optional<FoundPeak> peak = peak_estimate(counted_far_field(result, i));
    if (peak) worst = std::fmax(worst, peak->noise_cd / peak->cd.mean);
  }
  return worst;
}

}  // namespace lucerna
