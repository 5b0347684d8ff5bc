// SPDX-License-Identifier: Apache-2.0
// Light distributions that are plausible wishes, as smooth functions: what bench_real_targets designs mirrors
// for whose light then is a target that a mirror is known to meet.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "lucerna/geometry.h"
#include "lucerna/intensity.h"

namespace lucerna::bench {

/// A synthetic target: relative intensity by direction; nadir is -z.
struct SyntheticTarget {
  std::string name;
  std::function<double(const Direction&)> intensity;
};

/// 1 well inside, 1/2 at the edge, falling over about `soft` of it: a logistic step.
inline double soft_step(double x, double edge, double soft) {
  return 1.0 / (1.0 + std::exp(std::min(60.0, 4.0 * (x - edge) / (soft * edge))));
}

/// Angles from nadir along x and along y, degrees, as beams are quoted.
inline double across_x(const Direction& d) { return degrees(std::atan2(d.x(), -d.z())); }
inline double across_y(const Direction& d) { return degrees(std::atan2(d.y(), -d.z())); }
inline double from_nadir(const Direction& d) { return degrees(std::atan2(std::hypot(d.x(), d.y()), -d.z())); }

/// Spots and floods: half of the peak at half the beam angle, with the tail of a Gaussian.
inline double round_beam(const Direction& d, double beam_deg) {
  return std::exp2(-std::pow(2.0 * from_nadir(d) / beam_deg, 2));
}

inline double oval(const Direction& d, double beam_x_deg, double beam_y_deg) {
  if (d.z() >= 0.0) return 0.0;
  return std::exp2(-std::pow(2.0 * across_x(d) / beam_x_deg, 2) -
                   std::pow(2.0 * across_y(d) / beam_y_deg, 2));
}

/// Even light on a floor: 1 / cos^3 up to an edge, rotational.
inline double batwing(const Direction& d, double edge_deg) {
  const double gamma = from_nadir(d);
  if (gamma >= 89.0) return 0.0;
  return std::pow(std::cos(radians(std::min(gamma, 75.0))), -3.0) * soft_step(gamma, edge_deg, 0.25);
}

/// Light towards a wall on the side of +x: rising to 60 degrees there, little on the other side.
inline double wall_washer(const Direction& d) {
  if (d.z() >= 0.0) return 0.0;
  const double x = across_x(d), y = across_y(d);
  const double along =
      (0.25 + 0.75 / (1.0 + std::exp(-(x - 12.0) / 9.0))) * soft_step(std::abs(x - 15.0), 48.0, 0.3);
  return along * std::exp2(-std::pow(y / 38.0, 2));
}

/// Two lobes along a street (+-x, 55 degrees), bent towards its far side (+y).
inline double street(const Direction& d) {
  const double gamma = from_nadir(d);
  if (d.z() >= 0.0 || gamma >= 88.0) return 0.0;
  const double x = std::abs(across_x(d)), y = across_y(d);
  const double lobe = std::exp(-std::pow((x - 52.0) / 16.0, 2)) * std::exp(-std::pow((y - 15.0) / 22.0, 2));
  const double base = std::exp(-std::pow((across_y(d) - 12.0) / 30.0, 2)) * soft_step(x, 55.0, 0.4);
  return (0.35 * base + lobe) * soft_step(gamma, 72.0, 0.12);
}

/// An even square on a floor, 2 * tan(edge) of the height wide.
inline double square(const Direction& d, double edge_deg) {
  if (d.z() >= -0.05) return 0.0;
  const double edge = std::tan(radians(edge_deg));
  const double x = std::abs(d.x() / d.z()), y = std::abs(d.y() / d.z());
  return std::pow(-d.z(), -3.0) * soft_step(x, edge, 0.25) * soft_step(y, edge, 0.25);
}

inline std::vector<SyntheticTarget> synthetic_targets() {
  return {{"spot20", [](const Direction& d) { return round_beam(d, 20.0); }},
          {"flood30", [](const Direction& d) { return round_beam(d, 30.0); }},
          {"flood60", [](const Direction& d) { return round_beam(d, 60.0); }},
          {"oval", [](const Direction& d) { return oval(d, 64.0, 32.0); }},
          {"batwing", [](const Direction& d) { return batwing(d, 50.0); }},
          {"wallwasher", wall_washer},
          {"street", street},
          {"square", [](const Direction& d) { return square(d, 35.0); }}};
}

/// Of 1000 lm or so, on a grid.
inline IntensityDistribution table_of(const SyntheticTarget& target, double c_step_deg,
                                      double gamma_step_deg) {
  IntensityDistribution d = uniform_distribution(c_step_deg, gamma_step_deg);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      d.at(c, g) = 1000.0 * std::max(0.0, target.intensity(direction_from_type_c(
                                              {radians(d.c_deg[c]), radians(d.gamma_deg[g])})));
    }
  }
  return d;
}

}  // namespace lucerna::bench
