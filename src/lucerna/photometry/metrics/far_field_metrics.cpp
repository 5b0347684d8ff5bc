// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/far_field_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/photometry/metrics/peak_estimate.h"
#include "lucerna/photometry/metrics/radius_choice.h"
#include "lucerna/photometry/metrics/section_estimate.h"

namespace lucerna {

namespace {

constexpr double kDark = 0.002;    // far below every threshold
constexpr double kCutOff = 0.025;  // photometric practice: less than 2.5 % of the maximum
/// What beam and field angles are measured at, of the maximum or the axis.
constexpr double kBeam = 0.5, kField = 0.1;
/// A section is smoothed by no more than this share of the lobe's half width.
constexpr double kSmoothing = 0.25;
/// Of intensities that are read at fixed directions; a goniophotometer's detector has half of it.
constexpr double kGlareRadius_deg = 2.5;
/// The brightest direction is looked for within this share of the distance between those that the cells show.
constexpr double kPeakSearch = 0.5;
/// Kernels move the ends of an arc below this by more than noise does. Those of a wider one are looked for by
/// `exact` where that knows the light about them to this share: elsewhere it may come by paths that few
/// points find.
constexpr double kNarrowArc_deg = 20.0, kWellFound = 0.025;
/// Ends of arcs are looked for by `exact` in steps of this share of the arc, and of what the cells resolve;
/// no further away than this.
constexpr double kArcStep = 0.05, kResolutionStep = 0.5, kMaxWindow_deg = 20.0;
/// `exact` looks for ends in the planes of the luminaire's axes and the diagonals: multiples of this.
constexpr double kExactPlanes_deg = 45.0;
/// Beyond this a peak's C is not determined.
constexpr double kTurned_deg = 90.0;
/// Narrower than the beam is wide, wide enough for its axis where no peak was found.
constexpr double kAxisRadius_deg = 2.5;

Jackknife share(const Jackknife& x, double factor) {
  return x.map([factor](double v) { return factor * v; });
}

/// What angles are measured by: peak and axis with their values without each replicate, and how wide kernels
/// of sections may be.
struct Light {
  Jackknife maximum, centre;
  double widest_deg;
};

/// The angles of one pair of planes, and how far 2.5 % of the peak reach.
struct PlaneResult {
  FarFieldMetrics::Plane plane;
  std::optional<Jackknife> reach;
};

/// What `exact` measures of the arc at a place.
std::optional<Estimate> exact_arc_at(const PointIntensity& exact, double resolution_deg,
                                     const Section& section, const Section::Place& place,
                                     const Estimate& threshold) {
  if (place.outward_deg > kMaxWindow_deg) return std::nullopt;
  const double size_deg = place.arc.to_deg - place.arc.from_deg;
  const ArcWindow window{place.outward_deg + resolution_deg,
                         std::min(kResolutionStep * resolution_deg, kArcStep * size_deg),
                         size_deg > kNarrowArc_deg ? kWellFound : std::numeric_limits<double>::infinity()};
  return exact_arc_deg(
      exact, [&](double angle) { return section.direction(angle); }, place.arc, window, threshold);
}

/// The arc where a share of `full` is reached. Kernels move its ends: there `exact` looks for them. Of two
/// places it is the smaller arc.
std::optional<Estimate> arc_deg(const PointIntensity& exact, double resolution_deg, Section& section,
                                const Jackknife& full, double share_of_full) {
  const Estimate threshold = share(full, share_of_full).estimate();
  const std::optional<Estimate> counted = section.arc_deg(threshold);
  if (!exact) return counted;
  std::optional<Estimate> smallest;
  for (const Section::Place& place : section.places(threshold)) {
    const auto arc = exact_arc_at(exact, resolution_deg, section, place, threshold);
    if (!arc || !is_determined(*arc)) return counted;
    if (!smallest || arc->mean < smallest->mean) smallest = arc;
  }
  return smallest ? smallest : counted;
}

/// A section of the light of a peak.
Section section_of(const CountedSphere& sphere, double c_deg, const Light& light) {
  return {sphere, c_deg, light.widest_deg, kDark * std::min(light.maximum.all(), light.centre.all())};
}

PlaneResult measure_plane(const CountedSphere& sphere, double c_deg, bool up, const Light& light,
                          const PointIntensity& exact) {
  const Jackknife &maximum = light.maximum, &centre = light.centre;
  Section section = section_of(sphere, c_deg, light);
  PlaneResult r;
  r.plane.c_deg = c_deg;
  const bool has_ends = std::fmod(c_deg, kExactPlanes_deg) == 0.0;
  const auto arc = [&](const Jackknife& full, double share_of_full) {
    return arc_deg(has_ends ? exact : PointIntensity{}, sphere.resolution_deg(), section, full,
                   share_of_full);
  };
  r.plane.beam_of_maximum = arc(maximum, kBeam);
  r.plane.field_of_maximum = arc(maximum, kField);
  const bool on_axis = centre.all() == maximum.all();
  r.plane.beam_of_centre = on_axis ? r.plane.beam_of_maximum : arc(centre, kBeam);
  r.plane.field_of_centre = on_axis ? r.plane.field_of_maximum : arc(centre, kField);
  r.reach = section.reach_deg(share(maximum, kCutOff), up);
  return r;
}

/// As at the angles of the grid.
Estimate flux_estimate(const Jackknife& flux) {
  Estimate e = flux.estimate();
  if (!(e.mean > 0.0)) return e;
  e.standard_error = error_of_rays(e.mean, e.standard_error * e.standard_error / e.mean);
  return e;
}

void measure_zones(const CountedSphere& sphere, FarFieldMetrics& m) {
  for (std::size_t zone = 0; zone < m.zonal.size(); ++zone) {
    const double from = 10.0 * static_cast<double>(zone);
    m.zonal[zone] = flux_estimate(sphere.zone_flux(from, from + 10.0));
  }
  const Jackknife all = sphere.zone_flux(0.0, 180.0), down = sphere.zone_flux(0.0, 90.0);
  const Jackknife below_60 = sphere.zone_flux(0.0, 60.0);
  m.flux = flux_estimate(all);
  m.flux_0_30 = flux_estimate(sphere.zone_flux(0.0, 30.0));
  m.flux_0_40 = flux_estimate(sphere.zone_flux(0.0, 40.0));
  m.flux_0_60 = flux_estimate(below_60);
  m.flux_60_90 = flux_estimate(sphere.zone_flux(60.0, 90.0));
  m.flux_0_90 = flux_estimate(down);
  m.flux_90_180 = flux_estimate(sphere.zone_flux(90.0, 180.0));
  const auto percent = [](const Jackknife& a, const Jackknife& b) {
    return share(ratio(a, b), 100.0).estimate();
  };
  m.cie_flux_code = {percent(sphere.zone_flux(0.0, 41.4), down), percent(below_60, down),
                     percent(sphere.zone_flux(0.0, 75.5), down), percent(down, all)};
  constexpr double kBounds[5] = {0.0, 30.0, 60.0, 80.0, 90.0};
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t k = 0; k < 4; ++k) {
      const double street = side == 0 ? 90.0 : 270.0;
      m.bug_zones[4 * side + k] = flux_estimate(sphere.half_zone_flux(kBounds[k], kBounds[k + 1], street));
    }
  }
  m.bug_zones[8] = flux_estimate(sphere.zone_flux(90.0, 100.0));
  m.bug_zones[9] = flux_estimate(sphere.zone_flux(100.0, 180.0));
}

void measure_glare(const CountedSphere& sphere, FarFieldMetrics& m) {
  m.glare_radius_deg = kGlareRadius_deg;
  for (std::size_t i = 0; i < m.glare_cd.size(); ++i) {
    const Direction d = direction_from_type_c(
        {radians(i < 5 ? 0.0 : 90.0), radians(45.0 + 10.0 * static_cast<double>(i % 5))});
    m.glare_cd[i] = sphere.mean_cd(d, Kernel(kGlareRadius_deg)).estimate();
  }
}

/// An estimate that has noise of its own.
Jackknife independent(const Estimate& e, std::size_t replicates) {
  return Jackknife(replicates).map([&](double) { return e.mean; }).with_error(e.standard_error);
}

/// The peak is at `top`. Its place is known as finely as it was looked for, and intervals hold the places
/// that may be as high.
void move(FoundPeak& p, const PointPeak& top) {
  const TypeCAngles at = type_c_angles(top.direction);
  double apart_deg = 0.0, along_deg = 0.0, across_deg = 0.0;
  for (const Direction& d : top.others) {
    const double gap_deg = degrees(angle_between(d, top.direction));
    const double gamma_deg = degrees(std::abs(type_c_angles(d).gamma_rad - at.gamma_rad));
    apart_deg = std::max(apart_deg, gap_deg);
    along_deg = std::max(along_deg, gamma_deg);
    across_deg = std::max(across_deg, std::sqrt(std::max(0.0, gap_deg * gap_deg - gamma_deg * gamma_deg)));
  }
  const auto error = [&](double farthest_deg) {
    return std::hypot(top.ripple_error_deg, farthest_deg / kIntervalErrors);
  };
  const double c_error_deg = error(across_deg) / std::max(std::sin(at.gamma_rad), 1e-9);
  p.direction = top.direction;
  p.direction_error_deg = error(apart_deg);
  if (p.gamma_deg) p.gamma_deg = Estimate{degrees(at.gamma_rad), error(along_deg)};
  if (c_error_deg > kTurned_deg) p.c_deg.reset();
  if (p.c_deg) p.c_deg = Estimate{degrees(at.c_rad), c_error_deg};
}

/// The higher one of two tops, where the other may be as high too: noise, and what no search saw, leave that
/// open.
PointPeak higher(PointPeak a, PointPeak b) {
  if (b.cd.mean > a.cd.mean) std::swap(a, b);
  const double error = std::hypot(a.cd.standard_error, b.cd.standard_error, a.search_error_cd);
  if (a.cd.mean - b.cd.mean <= kIntervalErrors * error) {
    a.others.push_back(b.direction);
    a.others.insert(a.others.end(), b.others.begin(), b.others.end());
  }
  return a;
}

/// Moves the peak to the brightest direction near those that the cells show.
void refine_peak(const PointIntensity& exact, const PointPeak& axis, FoundPeak& p) {
  const PointPeak found = brightest_point(exact, p.bright, kPeakSearch * p.bright_spacing_deg);
  const PointPeak best =
      higher(found, {axis.direction, axis.cd, found.search_error_cd, found.ripple_error_deg, {}});
  move(p, best);
  p.cd = best.cd;
  p.cd.standard_error = std::hypot(p.cd.standard_error, best.search_error_cd);
  p.values = independent(p.cd, p.values.replicates());
  p.radius_deg = p.c_radius_deg = 0.0;
}

Jackknife exact_axis(const PointIntensity& exact, const Direction& axis, std::size_t replicates,
                     FarFieldMetrics& m) {
  m.axis_cd = precise_intensity(exact, axis);
  m.axis_radius_deg = 0.0;
  return independent(m.axis_cd, replicates);
}

/// Kernels from the lobe's own scale down to the counted cells'. Returns the axis without each replicate.
Jackknife measure_axis(const CountedSphere& sphere, const Direction& axis, FarFieldMetrics& m) {
  const double finest = sphere.resolution_deg();
  // Never so wide that what a parabola leaves out of the lobe shows, nor over an edge.
  const double widest = m.peak ? std::min(kSmoothing * m.peak->half_width_deg, 0.5 * m.peak->nearest_side_deg)
                               : kAxisRadius_deg;
  RadiusChoice choice;
  std::vector<double> radii_deg{std::max(finest, widest)};
  for (;; radii_deg.push_back(0.5 * radii_deg.back())) {
    const Jackknife value = sphere.fit(axis, Kernel(radii_deg.back())).coefficients[0];
    choice.add(value, value.estimate().standard_error);
    if (choice.complete() || 0.5 * radii_deg.back() < finest) break;
  }
  if (choice.size() == 1 && !choice.complete()) {
    radii_deg.push_back(0.5 * finest);
    const Jackknife value = sphere.mean_cd(axis, Kernel(radii_deg.back()));
    choice.add(value, value.estimate().standard_error);
  }
  const RadiusChoice::Choice best = choice.best();
  m.axis_radius_deg = radii_deg[best.index];
  m.axis_cd = best.estimate();
  // A quadratic of few rays may end below zero.
  const double below = std::max(0.0, -m.axis_cd.mean);
  m.axis_cd = {m.axis_cd.mean + below, std::hypot(m.axis_cd.standard_error, below)};
  return best.values;
}

/// The reach of the plane where the light reaches furthest.
std::optional<Estimate> furthest(const std::vector<PlaneResult>& results) {
  std::vector<Jackknife> reaches;
  for (const PlaneResult& r : results) {
    if (r.reach) reaches.push_back(*r.reach);
  }
  return reaches.empty() ? std::nullopt : std::optional(largest(reaches).estimate);
}

/// Peak and axis of the side with more light; returns what angles are measured by.
Light measure_peak_and_axis(const CountedSphere& sphere, const PointIntensity& exact, FarFieldMetrics& m) {
  std::optional<FoundPeak> peak =
      peak_estimate(sphere, exact ? PeakSearch::bright_directions : PeakSearch::all_scales);
  m.peak = peak;  // the lobe's width, for the axis
  const bool up = sphere.zone_flux(90.0, 180.0).all() > sphere.zone_flux(0.0, 90.0).all();
  m.axis_gamma_deg = up ? 180.0 : 0.0;
  const Direction axis = Direction::from_unit({0.0, 0.0, up ? 1.0 : -1.0});
  const Jackknife centre =
      exact ? exact_axis(exact, axis, sphere.replicates(), m) : measure_axis(sphere, axis, m);
  if (peak && exact) refine_peak(exact, {axis, m.axis_cd}, *peak);
  // A quadratic of few rays may end below zero at its top too.
  if (peak && !(peak->cd.mean > 0.0)) peak.reset();
  m.peak = peak;
  return {peak ? peak->values : Jackknife(sphere.replicates()), centre,
          m.peak ? kSmoothing * m.peak->half_width_deg : kAxisRadius_deg};
}

}  // namespace

FarFieldMetrics far_field_metrics(const CountedSphere& sphere, std::span<const double> planes_deg,
                                  const PointIntensity& exact) {
  FarFieldMetrics m;
  measure_zones(sphere, m);
  measure_glare(sphere, m);
  const Light light = measure_peak_and_axis(sphere, exact, m);
  std::vector<double> planes{0.0, 90.0};
  for (const double c : planes_deg) {
    if (c < 180.0) planes.push_back(c);
  }
  std::sort(planes.begin(), planes.end());
  planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
  std::vector<PlaneResult> results(planes.size());
  parallel_blocks(planes.size(), 1, [&](std::size_t i, std::size_t) {
    results[i] = measure_plane(sphere, planes[i], m.axis_gamma_deg == 180.0, light, exact);
  });
  for (const PlaneResult& r : results) m.planes.push_back(r.plane);
  m.cut_off_deg = furthest(results);
  return m;
}

PeakAndBeam peak_and_beam(const CountedSphere& sphere, const PointIntensity& exact) {
  FarFieldMetrics m;
  const Light light = measure_peak_and_axis(sphere, exact, m);
  std::array<std::optional<Estimate>, 2> beam_deg;
  parallel_blocks(beam_deg.size(), 1, [&](std::size_t i, std::size_t) {
    Section section = section_of(sphere, 90.0 * static_cast<double>(i), light);
    beam_deg[i] = arc_deg(exact, sphere.resolution_deg(), section, light.maximum, kBeam);
  });
  return {m.peak, m.axis_cd, beam_deg[0], beam_deg[1]};
}

}  // namespace lucerna
