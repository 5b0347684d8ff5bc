// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/far_field_metrics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/parallel.h"
#include "lucerna/photometry/peak_estimate.h"
#include "lucerna/photometry/section_estimate.h"

namespace lucerna {

namespace {

constexpr double kDark = 0.002;    // far below every threshold
constexpr double kCutOff = 0.025;  // photometric practice: less than 2.5 % of the maximum
/// A section is smoothed by no more than this share of the lobe's half width.
constexpr double kSmoothing = 0.25;
/// Of intensities that are read at fixed directions; a goniophotometer's detector has half of it.
constexpr double kGlareRadius_deg = 2.5;
/// Narrower than the beam is wide, wide enough for its axis where no peak was found.
constexpr double kAxisRadius_deg = 2.5;

Jackknife share(const Jackknife& x, double factor) {
  return x.map([factor](double v) { return factor * v; });
}

/// The angles of one pair of planes, and how far 2.5 % of the peak reach.
struct PlaneResult {
  FarFieldMetrics::Plane plane;
  std::optional<Jackknife> reach;
};

PlaneResult measure_plane(const CountedSphere& sphere, double c_deg, double widest_deg, bool up,
                          const Jackknife& maximum, const Jackknife& centre) {
  Section section(sphere, c_deg, widest_deg, kDark * std::min(maximum.all(), centre.all()));
  PlaneResult r;
  r.plane.c_deg = c_deg;
  r.plane.beam_of_maximum = section.arc_deg(share(maximum, 0.5));
  r.plane.field_of_maximum = section.arc_deg(share(maximum, 0.1));
  r.plane.beam_of_centre = section.arc_deg(share(centre, 0.5));
  r.plane.field_of_centre = section.arc_deg(share(centre, 0.1));
  r.reach = section.reach_deg(share(maximum, kCutOff), up);
  return r;
}

void measure_zones(const CountedSphere& sphere, FarFieldMetrics& m) {
  for (std::size_t zone = 0; zone < m.zonal.size(); ++zone) {
    const double from = 10.0 * static_cast<double>(zone);
    m.zonal[zone] = sphere.zone_flux(from, from + 10.0).estimate();
  }
  const Jackknife all = sphere.zone_flux(0.0, 180.0), down = sphere.zone_flux(0.0, 90.0);
  const Jackknife below_60 = sphere.zone_flux(0.0, 60.0);
  m.flux = all.estimate();
  m.flux_0_30 = sphere.zone_flux(0.0, 30.0).estimate();
  m.flux_0_40 = sphere.zone_flux(0.0, 40.0).estimate();
  m.flux_0_60 = below_60.estimate();
  m.flux_60_90 = sphere.zone_flux(60.0, 90.0).estimate();
  m.flux_0_90 = down.estimate();
  m.flux_90_180 = sphere.zone_flux(90.0, 180.0).estimate();
  const auto percent = [](const Jackknife& a, const Jackknife& b) {
    return share(ratio(a, b), 100.0).estimate();
  };
  m.cie_flux_code = {percent(sphere.zone_flux(0.0, 41.4), down), percent(below_60, down),
                     percent(sphere.zone_flux(0.0, 75.5), down), percent(down, all)};
  constexpr double kBounds[5] = {0.0, 30.0, 60.0, 80.0, 90.0};
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t k = 0; k < 4; ++k) {
      const double street = side == 0 ? 90.0 : 270.0;
      m.bug_zones[4 * side + k] = sphere.half_zone_flux(kBounds[k], kBounds[k + 1], street).estimate();
    }
  }
  m.bug_zones[8] = sphere.zone_flux(90.0, 100.0).estimate();
  m.bug_zones[9] = sphere.zone_flux(100.0, 180.0).estimate();
}

void measure_glare(const CountedSphere& sphere, FarFieldMetrics& m) {
  m.glare_radius_deg = kGlareRadius_deg;
  for (std::size_t i = 0; i < m.glare_cd.size(); ++i) {
    const Direction d = direction_from_type_c(
        {radians(i < 5 ? 0.0 : 90.0), radians(45.0 + 10.0 * static_cast<double>(i % 5))});
    m.glare_cd[i] = sphere.mean_cd(d, Kernel(kGlareRadius_deg)).estimate();
  }
}

/// The reach of the plane where the light reaches furthest.
std::optional<Estimate> furthest(const std::vector<PlaneResult>& results) {
  std::vector<Jackknife> reaches;
  for (const PlaneResult& r : results) {
    if (r.reach) reaches.push_back(*r.reach);
  }
  return reaches.empty() ? std::nullopt : std::optional(largest(reaches).estimate);
}

}  // namespace

FarFieldMetrics far_field_metrics(const CountedSphere& sphere, std::span<const double> planes_deg) {
  FarFieldMetrics m;
  measure_zones(sphere, m);
  measure_glare(sphere, m);
  const std::optional<FoundPeak> peak = peak_estimate(sphere);
  m.peak = peak;
  m.axis_gamma_deg = m.flux_90_180.mean > m.flux_0_90.mean ? 180.0 : 0.0;
  const Direction axis = Direction::from_unit({0.0, 0.0, m.axis_gamma_deg == 0.0 ? -1.0 : 1.0});
  const double finest = sphere.resolution_deg();
  // As wide as the peak's, but never so wide that what a parabola leaves out of the lobe shows.
  const double wanted =
      m.peak ? std::min(m.peak->radius_deg, kSmoothing * m.peak->half_width_deg) : kAxisRadius_deg;
  m.axis_radius_deg = std::max(finest, wanted);
  const Jackknife centre = sphere.fit(axis, Kernel(m.axis_radius_deg)).coefficients[0];
  m.axis_cd = centre.estimate();
  std::vector<double> planes{0.0, 90.0};
  for (const double c : planes_deg) {
    if (c < 180.0) planes.push_back(c);
  }
  std::sort(planes.begin(), planes.end());
  planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
  const double widest = m.peak ? kSmoothing * m.peak->half_width_deg : kAxisRadius_deg;
  const Jackknife maximum = peak ? peak->values : Jackknife(sphere.replicates());
  std::vector<PlaneResult> results(planes.size());
  parallel_blocks(planes.size(), 1, [&](std::size_t i, std::size_t) {
    results[i] = measure_plane(sphere, planes[i], widest, m.axis_gamma_deg == 180.0, maximum, centre);
  });
  for (const PlaneResult& r : results) m.planes.push_back(r.plane);
  m.cut_off_deg = furthest(results);
  return m;
}

}  // namespace lucerna
