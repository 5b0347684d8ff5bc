// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {

namespace {

std::vector<CirclePoint> great_circle(const IntensityDistribution& d, double c_deg) {
  std::vector<CirclePoint> circle;
  const auto add = [&](double angle, double cd) {
    if (circle.empty() || angle > circle.back().angle_deg) circle.push_back({angle, cd});
  };
  const auto& g = d.gamma_deg;
  if (g.front() > 0.0) add(0.0, 0.0);
  // Beyond the grid the intensity is zero: a step at its edge.
  const double step = 1e-9;
  if (g.front() > 0.0) add(g.front() - step, 0.0);
  for (const double gamma : g) add(gamma, intensity_at(d, c_deg, gamma));
  if (g.back() < 180.0) {
    add(g.back() + step, 0.0);
    add(360.0 - g.back() - step, 0.0);
  }
  for (std::size_t i = g.size(); i-- > 0;) {
    if (g[i] > 0.0) add(360.0 - g[i], intensity_at(d, c_deg + 180.0, g[i]));
  }
  if (g.front() > 0.0) add(360.0 - g.front() + step, 0.0);
  return circle;
}

double reference_cd(const IntensityDistribution& d, BeamReference reference) {
  return reference == BeamReference::maximum ? peak_intensity(d).cd : intensity_at(d, 0.0, axis_gamma_deg(d));
}

}  // namespace

/// 360 less the widest run of the circle below the threshold.
std::optional<CircleArc> smallest_arc(const std::vector<CirclePoint>& circle, double threshold) {
  const std::size_t n = circle.size();
  std::optional<double> first_rise, last_fall;
  CircleArc arc;
  bool any_above = false;
  // The arc is what the widest gap leaves.
  const auto gap = [&](double fall, double rise) {
    if (rise - fall > 360.0 - (arc.to_deg - arc.from_deg)) arc = {rise, fall + 360.0};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const CirclePoint a = circle[i];
    CirclePoint b = circle[(i + 1) % n];
    if (i + 1 == n) b.angle_deg += 360.0;
    any_above = any_above || a.cd >= threshold;
    const bool above_a = a.cd >= threshold, above_b = b.cd >= threshold;
    if (above_a == above_b) continue;
    const double crossing = a.angle_deg + (b.angle_deg - a.angle_deg) * (threshold - a.cd) / (b.cd - a.cd);
    if (above_a) {
      last_fall = crossing;
    } else if (last_fall) {
      gap(*last_fall, crossing);
    } else {
      first_rise = crossing;
    }
  }
  if (!any_above) return std::nullopt;
  if (first_rise && last_fall) gap(*last_fall, *first_rise + 360.0);
  return arc;
}

std::optional<double> smallest_arc_deg(const std::vector<CirclePoint>& circle, double threshold) {
  const std::optional<CircleArc> arc = smallest_arc(circle, threshold);
  return arc ? std::optional(arc->to_deg - arc->from_deg) : std::nullopt;
}

std::optional<double> farthest_from_axis_deg(const std::vector<CirclePoint>& circle, double threshold,
                                             bool up) {
  const auto from_axis = [up](double angle) {
    const double gamma = std::abs(std::remainder(angle, 360.0));
    return up ? 180.0 - gamma : gamma;
  };
  std::optional<double> farthest;
  const auto reach = [&](double angle) { farthest = std::max(farthest.value_or(0.0), from_axis(angle)); };
  for (std::size_t i = 0; i < circle.size(); ++i) {
    const CirclePoint a = circle[i];
    CirclePoint b = circle[(i + 1) % circle.size()];
    if (i + 1 == circle.size()) b.angle_deg += 360.0;
    if (a.cd >= threshold) reach(a.angle_deg);
    if ((a.cd >= threshold) != (b.cd >= threshold))
      reach(a.angle_deg + (b.angle_deg - a.angle_deg) * (threshold - a.cd) / (b.cd - a.cd));
  }
  return farthest;
}

PeakIntensity peak_intensity(const IntensityDistribution& d) {
  const auto at = static_cast<std::size_t>(std::max_element(d.cd.begin(), d.cd.end()) - d.cd.begin());
  LUCERNA_CHECK(at < d.cd.size(), "empty distribution");
  return {d.cd[at], d.c_deg[at / d.gamma_deg.size()], d.gamma_deg[at % d.gamma_deg.size()]};
}

double axis_gamma_deg(const IntensityDistribution& d) {
  return zonal_flux(d, 90.0, 180.0) > zonal_flux(d, 0.0, 90.0) ? 180.0 : 0.0;
}

std::optional<double> beam_angle_deg(const IntensityDistribution& d, double c_deg, double fraction,
                                     BeamReference reference) {
  const double full = reference_cd(d, reference);
  if (!(full > 0.0)) return std::nullopt;
  return smallest_arc_deg(great_circle(d, c_deg), fraction * full);
}

BeamMetrics beam_metrics(const IntensityDistribution& d) {
  BeamMetrics figures;
  figures.flux = total_flux(d);
  figures.peak = peak_intensity(d);
  figures.axis_gamma_deg = axis_gamma_deg(d);
  figures.centre_cd = reference_cd(d, BeamReference::centre);
  std::vector<double> planes{0.0, 90.0};
  for (const double c : d.c_deg) {
    if (c < 180.0) planes.push_back(c);
  }
  std::sort(planes.begin(), planes.end());
  planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
  const double maximum = reference_cd(d, BeamReference::maximum);
  const double centre = figures.centre_cd;
  for (const double c : planes) {
    const std::vector<CirclePoint> circle = great_circle(d, c);
    const auto angle = [&](double full, double fraction) -> std::optional<double> {
      return full > 0.0 ? smallest_arc_deg(circle, fraction * full) : std::nullopt;
    };
    figures.planes.push_back(
        {c, angle(maximum, 0.5), angle(maximum, 0.1), angle(centre, 0.5), angle(centre, 0.1)});
  }
  return figures;
}

}  // namespace lucerna
