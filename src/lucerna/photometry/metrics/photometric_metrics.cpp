// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometric_metrics.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr double kCutOffShare = 0.025;  // photometric-formats 3.1: less than 2.5 % of the maximum

double cut_off_of(const IntensityDistribution& d, const BeamMetrics& beam) {
  const double threshold = kCutOffShare * beam.peak.cd;
  double widest = 0.0;
  for (std::size_t i = 0; i < d.cd.size(); ++i) {
    if (threshold > 0.0 && d.cd[i] >= threshold) {
      widest = std::max(widest, std::abs(d.gamma_deg[i % d.gamma_deg.size()] - beam.axis_gamma_deg));
    }
  }
  return widest;
}

}  // namespace

int nema_type(std::optional<double> field_angle_deg) {
  if (!field_angle_deg || *field_angle_deg < 10.0) return 0;
  int type = 1;
  for (const double upper : {18.0, 29.0, 46.0, 70.0, 100.0, 130.0}) {
    if (*field_angle_deg <= upper) return type;
    ++type;
  }
  return type;
}

PhotometricMetrics photometric_metrics(const PhotometricFile& file) {
  const IntensityDistribution& d = file.distribution;
  if (const std::string fault = grid_fault(d); !fault.empty())
    throw InputError("photometric figures: " + fault);
  PhotometricMetrics f;
  f.beam = beam_metrics(d);
  for (std::size_t zone = 0; zone < f.zonal.size(); ++zone) {
    const double from = 10.0 * static_cast<double>(zone);
    f.zonal[zone] = zonal_flux(d, from, from + 10.0);
  }
  f.flux_0_30 = zonal_flux(d, 0.0, 30.0);
  f.flux_0_40 = zonal_flux(d, 0.0, 40.0);
  f.flux_0_60 = zonal_flux(d, 0.0, 60.0);
  f.flux_60_90 = zonal_flux(d, 60.0, 90.0);
  f.flux_0_90 = zonal_flux(d, 0.0, 90.0);
  f.flux_90_180 = zonal_flux(d, 90.0, 180.0);
  if (const auto lamp = lamp_flux_lm(file.luminaire)) f.light_output_ratio = f.beam.flux / *lamp;
  const double down = f.flux_0_90;
  if (down > 0.0) {
    f.cie_flux_code = {100.0 * zonal_flux(d, 0.0, 41.4) / down, 100.0 * f.flux_0_60 / down,
                       100.0 * zonal_flux(d, 0.0, 75.5) / down, 0.0, 0.0};
  }
  if (f.beam.flux > 0.0) f.cie_flux_code[3] = 100.0 * down / f.beam.flux;
  f.cie_flux_code[4] = 100.0 * f.light_output_ratio.value_or(1.0);
  f.cut_off_deg = cut_off_of(d, f.beam);
  f.nema_horizontal = nema_type(beam_angle_deg(d, 90.0, 0.1, BeamReference::maximum));
  f.nema_vertical = nema_type(beam_angle_deg(d, 0.0, 0.1, BeamReference::maximum));
  return f;
}

}  // namespace lucerna
