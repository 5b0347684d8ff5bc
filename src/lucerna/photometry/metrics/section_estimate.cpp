// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/section_estimate.h"

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

/// Root of the draws' mean square about the whole run's value; NaN where there are fewer than two.
double error_about_value(const Jackknife& x) {
  if (x.replicates() < 2) return std::nan("");
  const auto n = static_cast<double>(x.replicates());
  double squares = 0.0;
  for (const double v : x.values()) squares += (v - x.all()) * (v - x.all());
  return std::sqrt(squares * (n - 1.0) / n);
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
      const Jackknife cd = sphere_.mean_cd(d, Kernel(s.radius_deg)).draws();
      for (std::size_t r = 0; r < s.circles.size(); ++r) s.circles[r].push_back({angle, cd.values()[r]});
    }
  }
  return s;
}

/// `measure(points, threshold)` of one radius and of its draws; nothing if some draw has no such value.
template <class Measure>
std::optional<Jackknife> Section::measured(std::size_t radius, const Jackknife& levels,
                                           const Measure& measure) {
  const Smoothed& s = smoothed(radius);
  std::vector<double> values;
  for (std::size_t r = 0; r < levels.values().size(); ++r) {
    const std::optional<double> value = measure(s.circles[r], levels.values()[r]);
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return Jackknife::from_draws(std::move(values));
}

/// The radius of least error, from the smallest until the error is small. To the scatter of the draws comes
/// what noise moves them by on the average (a wiggle widens an arc), and by how much more than its own error
/// each smaller radius disagrees: what smoothing has moved (O. Lepski, 1990). Sixteen draws of a figure that
/// jumps may agree by chance; the next larger radius has less noise, so where it scatters more, its scatter
/// is taken.
template <class Measure>
std::optional<Jackknife> Section::best(const Jackknife& threshold, const Measure& measure) {
  std::optional<Jackknife> found;
  double min = 0.0;
  const Jackknife levels = threshold.draws();
  std::vector<Estimate> smaller;
  std::optional<Jackknife> next = measured(0, levels, measure);
  for (std::size_t i = 0; i < radii_deg_.size(); ++i) {
    const std::optional<Jackknife> here = std::move(next);
    next = i + 1 < radii_deg_.size() ? measured(i + 1, levels, measure) : std::nullopt;
    if (!here) continue;
    double error = error_about_value(*here);
    // Without errors nothing tells how far to smooth: the beam's own scale then does.
    if (std::isnan(error)) {
      found = here;
      continue;
    }
    if (next) error = std::max({error, error_about_value(*next), std::abs(next->all() - here->all())});
    double moved = 0.0;
    for (const Estimate& s : smaller) {
      const double gap = here->all() - s.mean;
      moved = std::max(moved, gap * gap - s.standard_error * s.standard_error);
    }
    smaller.push_back({here->all(), error});
    error = std::sqrt(error * error + moved);
    if (!found || error < min) {
      found = here->with_error(error);
      min = error;
    }
    if (error <= std::max(kGood_deg, kGoodShare * here->all())) break;
  }
  if (found && min > kUnknown_deg && min > kUnknownShare * found->all()) return std::nullopt;
  return found;
}

std::optional<Estimate> Section::arc_deg(const Jackknife& threshold) {
  if (!(threshold.all() > 0.0)) return std::nullopt;
  const auto angle = best(threshold, [](const std::vector<CirclePoint>& circle, double level) {
    return smallest_arc_deg(circle, level);
  });
  return angle ? std::optional(angle->estimate()) : std::nullopt;
}

std::optional<CircleArc> Section::narrowest_arc(double threshold) {
  return smallest_arc(smoothed(0).circles[0], threshold);
}

Direction Section::direction(double angle_deg) const { return on_circle(c_deg_, angle_deg); }

std::optional<Jackknife> Section::reach_deg(const Jackknife& threshold, bool up) {
  if (!(threshold.all() > 0.0)) return std::nullopt;
  return best(threshold, [up](const std::vector<CirclePoint>& circle, double level) {
    return farthest_from_axis_deg(circle, level, up);
  });
}

}  // namespace lucerna
