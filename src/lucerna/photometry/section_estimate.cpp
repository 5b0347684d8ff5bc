// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/section_estimate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lucerna {

namespace {

/// An angle is known well enough for the smallest kernel: finer than it is printed.
constexpr double kGood_deg = 0.1, kGoodShare = 0.005;
/// An error beyond both leaves an angle undetermined.
constexpr double kUnknown_deg = 1.0, kUnknownShare = 0.1;

Direction on_circle(double c_deg, double angle_deg) {
  const double a = radians(angle_deg), c = radians(c_deg);
  return Direction::from_unit({std::sin(a) * std::cos(c), std::sin(a) * std::sin(c), -std::cos(a)});
}

}  // namespace

Section::Section(const CountedSphere& sphere, double c_deg, double widest_deg, double dark_cd)
    : sphere_(sphere), c_deg_(c_deg), dark_cd_(dark_cd) {
  const double finest = sphere.resolution_deg();
  for (double r = finest; r < widest_deg; r *= std::numbers::sqrt2) radii_deg_.push_back(r);
  if (radii_deg_.empty()) radii_deg_.push_back(finest);
  smoothed_.resize(radii_deg_.size());
}

const Section::Smoothed& Section::smoothed(std::size_t i) {
  Smoothed& s = smoothed_[i];
  if (!s.circles.empty()) return s;
  s.radius_deg = radii_deg_[i];
  s.circles.resize(sphere_.replicates() + 1);
  const int n = 4 * static_cast<int>(std::ceil(90.0 / (0.35 * s.radius_deg)));
  for (int k = 0; k < n; ++k) {
    const double angle = 360.0 * k / n;
    const Direction d = on_circle(c_deg_, angle);
    const double all = sphere_.mean_of_all_cd(d, Kernel(s.radius_deg));
    if (all < dark_cd_) {
      for (auto& circle : s.circles) circle.push_back({angle, all});
    } else {
      const Jackknife cd = sphere_.mean_cd(d, Kernel(s.radius_deg));
      for (std::size_t r = 0; r < s.circles.size(); ++r) s.circles[r].push_back({angle, cd.values()[r]});
    }
  }
  return s;
}

/// `measure(points, threshold)` of each radius, from the smallest, until its error is small.
template <class Measure>
std::optional<Jackknife> Section::best(const Jackknife& threshold, const Measure& measure) {
  std::optional<Jackknife> found;
  double least = 0.0;
  for (std::size_t i = 0; i < radii_deg_.size(); ++i) {
    const Smoothed& s = smoothed(i);
    std::vector<double> values;
    for (std::size_t r = 0; r < threshold.values().size(); ++r) {
      const std::optional<double> value = measure(s.circles[r], threshold.values()[r]);
      if (!value) break;
      values.push_back(*value);
    }
    if (values.size() < threshold.values().size()) continue;
    const Jackknife here(std::move(values));
    const double error = here.estimate().standard_error;
    // Without errors nothing tells how far to smooth: the beam's own scale then does.
    if (std::isnan(error)) {
      found = here;
      continue;
    }
    if (!found || error < least) {
      found = here;
      least = error;
    }
    if (error <= std::max(kGood_deg, kGoodShare * here.all())) break;
  }
  if (found && least > kUnknown_deg && least > kUnknownShare * found->all()) return std::nullopt;
  return found;
}

std::optional<Estimate> Section::arc_deg(const Jackknife& threshold) {
  if (!(threshold.all() > 0.0)) return std::nullopt;
  const auto angle = best(threshold, [](const std::vector<CirclePoint>& circle, double level) {
    return smallest_arc_deg(circle, level);
  });
  return angle ? std::optional(angle->estimate()) : std::nullopt;
}

std::optional<Jackknife> Section::reach_deg(const Jackknife& threshold, bool up) {
  if (!(threshold.all() > 0.0)) return std::nullopt;
  return best(threshold, [up](const std::vector<CirclePoint>& circle, double level) {
    return farthest_from_axis_deg(circle, level, up);
  });
}

}  // namespace lucerna
