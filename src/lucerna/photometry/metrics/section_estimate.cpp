// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/section_estimate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lucerna {

namespace {

/// An angle is known well enough for the smallest kernel: a share of it, within bounds.
constexpr double kGoodShare = 0.005, kGoodFrom_deg = 0.1, kGoodTo_deg = 0.5;
/// An error beyond both leaves an angle undetermined.
constexpr double kUnknown_deg = 1.0, kUnknownShare = 0.1;

/// So many points to either side share their noise: a few radii.
constexpr int kPooled = 8;

Direction on_circle(double c_deg, double angle_deg) {
  const double a = radians(angle_deg), c = radians(c_deg);
  return Direction::from_unit({std::sin(a) * std::cos(c), std::sin(a) * std::sin(c), -std::cos(a)});
}

/// The standard error of what lies between two values within `kIntervalErrors`: the larger side.
double error_within(double value, double low, double high) {
  return std::max(high - value, value - low) / kIntervalErrors;
}

/// The threshold as it is, and as high and as low as it may be.
struct Levels {
  double middle, high, low;
  explicit Levels(const Estimate& e)
      : middle(e.mean),
        high(e.mean + (std::isnan(e.standard_error) ? 0.0 : kIntervalErrors * e.standard_error)),
        low(e.mean - (std::isnan(e.standard_error) ? 0.0 : kIntervalErrors * e.standard_error)) {}
};

double size(const CircleArc& arc) { return arc.to_deg - arc.from_deg; }

/// How far the ends of `other` lie outside of those of `arc`, to either side; below 0 inside.
struct Outside {
  double from_deg, to_deg;
  /// It is another part of the circle.
  bool turned;
  Outside(const CircleArc& arc, const CircleArc& other) {
    const double middle = 0.5 * (arc.from_deg + arc.to_deg), half = 0.5 * (arc.to_deg - arc.from_deg);
    const double other_half = 0.5 * (other.to_deg - other.from_deg);
    const double shift = std::remainder(0.5 * (other.from_deg + other.to_deg) - middle, 360.0);
    from_deg = other_half - shift - half;
    to_deg = other_half + shift - half;
    turned = std::abs(shift) > 0.5 * std::max(half, other_half);
  }
};

/// Errors of a section's points from the variances of those about them: sixteen replicates of few rays know a
/// variance badly, and where it is too small by chance a band is too narrow. Variance over intensity is the
/// light of one effective ray, which varies slowly. Where n rays were counted the error is that of n + 1.
std::vector<double> pooled_errors(const std::vector<CirclePoint>& section,
                                  const std::vector<double>& variance) {
  const auto n = static_cast<int>(section.size());
  std::vector<double> out;
  for (int k = 0; k < n; ++k) {
    double light = 0.0, noise = 0.0;
    for (int j = k - kPooled; j <= k + kPooled; ++j) {
      const auto i = static_cast<std::size_t>((j + n) % n);
      if (!(variance[i] > 0.0)) continue;
      light += section[i].cd;
      noise += variance[i];
    }
    const double ray = light > 0.0 ? noise / light : 0.0;
    const auto i = static_cast<std::size_t>(k);
    out.push_back(variance[i] > 0.0 ? error_of_rays(section[i].cd, ray) : 0.0);
  }
  return out;
}

/// The error of an arc that the band allows to be as `wide` or as `narrow`: that of its two ends, which are
/// independent. Where the widest dark stretch is another one there (two may be equally wide), ends are not
/// comparable, but sizes are.
double error_of_ends(const CircleArc& arc, const CircleArc& wide, const CircleArc& narrow) {
  const Outside outer(arc, wide), inner(arc, narrow);
  if (outer.turned || inner.turned) return error_within(size(arc), size(narrow), size(wide));
  const auto larger = [](double a, double b) { return std::max(std::abs(a), std::abs(b)) / kIntervalErrors; };
  return std::hypot(larger(outer.from_deg, inner.from_deg), larger(outer.to_deg, inner.to_deg));
}

/// The smallest arc, and the one that leaves out the second widest dark stretch.
std::vector<CircleArc> two_smallest_arcs(std::vector<CirclePoint> circle, double threshold) {
  std::vector<CircleArc> out;
  while (out.size() < 2) {
    const auto arc = smallest_arc(circle, threshold);
    if (!arc || !(size(*arc) < 360.0)) break;
    out.push_back(*arc);
    for (CirclePoint& p : circle) {
      const double from_end = p.angle_deg - arc->to_deg;
      if (from_end - 360.0 * std::floor(from_end / 360.0) < 360.0 - size(*arc)) p.cd = threshold;
    }
  }
  return out;
}

}  // namespace

bool is_determined(const Estimate& angle_deg) {
  return !(angle_deg.standard_error > std::max(kUnknown_deg, kUnknownShare * angle_deg.mean));
}

Section::Section(const CountedSphere& sphere, double c_deg, double widest_deg, double dark_cd)
    : sphere_(sphere), c_deg_(c_deg), dark_cd_(dark_cd) {
  const double finest = sphere.resolution_deg();
  for (double r = finest; r < widest_deg; r *= std::numbers::sqrt2) radii_deg_.push_back(r);
  if (radii_deg_.empty()) radii_deg_.push_back(finest);
  usable_ = radii_deg_.size();
  if (usable_ == 1) radii_deg_.push_back(2.0 * finest);
  smoothed_.resize(radii_deg_.size());
}

const Section::Smoothed& Section::smoothed(std::size_t i) {
  Smoothed& s = smoothed_[i];
  if (!s.middle.empty()) return s;
  const Kernel kernel(radii_deg_[i]);
  s.draws.resize(sphere_.replicates());
  const int n = 4 * static_cast<int>(std::ceil(90.0 / (0.35 * radii_deg_[i])));
  std::vector<double> variance;
  for (int k = 0; k < n; ++k) {
    const double angle = 360.0 * k / n;
    const Direction d = on_circle(c_deg_, angle);
    const double all = sphere_.mean_of_all_cd(d, kernel);
    Jackknife cd = Jackknife(sphere_.replicates()).map([all](double) { return all; });
    if (all >= dark_cd_) cd = sphere_.mean_cd(d, kernel);
    const double error = sphere_.replicates() < 2 ? 0.0 : cd.estimate().standard_error;
    const Jackknife draws = cd.draws();
    for (std::size_t r = 0; r < s.draws.size(); ++r) s.draws[r].push_back({angle, draws.values()[r + 1]});
    s.middle.push_back({angle, all});
    variance.push_back(error * error);
  }
  const std::vector<double> errors = pooled_errors(s.middle, variance);
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const auto [angle, cd] = s.middle[k];
    s.high.push_back({angle, cd + kIntervalErrors * errors[k]});
    s.low.push_back({angle, cd - kIntervalErrors * errors[k]});
  }
  return s;
}

/// The radius of least error, from the smallest until the error is small. `measure(section)` is the figure
/// with what noise makes of it. To that comes the bias of the kernel: what the next larger one differs by,
/// where bias grows with the square of the radius (of a lobe that one kernel alone is narrow for, with the
/// radius: the next has twice its own); and by how much more than its own error each smaller one disagrees:
/// what smoothing has moved (O. Lepski, 1990).
template <class Measure>
std::optional<Section::Best> Section::best(const Measure& measure) {
  std::optional<Best> found;
  std::vector<Estimate> smaller;
  std::optional<Estimate> next = measure(smoothed(0));
  for (std::size_t i = 0; i < usable_; ++i) {
    const std::optional<Estimate> here = next;
    next = i + 1 < radii_deg_.size() ? measure(smoothed(i + 1)) : std::nullopt;
    if (!here) continue;
    // Without errors nothing tells how far to smooth: the beam's own scale then does.
    if (sphere_.replicates() < 2) {
      found = Best{{here->mean, std::nan("")}, i};
      continue;
    }
    const double gap = next ? next->mean - here->mean : 0.0;
    double error = std::hypot(here->standard_error, gap), moved = 0.0;
    for (const Estimate& s : smaller) {
      const double from = here->mean - s.mean;
      moved = std::max(moved, from * from - s.standard_error * s.standard_error);
    }
    smaller.push_back({here->mean, error});
    error = std::sqrt(error * error + moved);
    if (!found || error < found->angle.standard_error) found = Best{{here->mean, error}, i};
    if (error <= std::clamp(kGoodShare * here->mean, kGoodFrom_deg, kGoodTo_deg)) break;
  }
  if (found && !is_determined(found->angle)) return std::nullopt;
  return found;
}

std::optional<Estimate> Section::arc_deg(const Estimate& threshold) {
  if (!(threshold.mean > 0.0)) return std::nullopt;
  const Levels level(threshold);
  const auto found = best([&](const Smoothed& s) -> std::optional<Estimate> {
    const auto arc = smallest_arc(s.middle, level.middle);
    const auto high = smallest_arc(s.high, level.middle), low = smallest_arc(s.low, level.middle);
    const auto above = smallest_arc(s.middle, level.high), below = smallest_arc(s.middle, level.low);
    if (!arc || !high || !low || !above || !below) return std::nullopt;
    const double by_level = error_within(size(*arc), size(*above), size(*below));
    return Estimate{size(*arc), std::hypot(by_level, error_of_ends(*arc, *high, *low))};
  });
  return found ? std::optional(found->angle) : std::nullopt;
}

std::vector<Section::Place> Section::places(const Estimate& threshold) {
  const std::vector<CircleArc> middle = two_smallest_arcs(smoothed(0).middle, threshold.mean),
                               wide = two_smallest_arcs(smoothed(0).high, Levels(threshold).low);
  std::vector<Place> out;
  double noise_deg = 0.0;
  for (const CircleArc& arc : middle) {
    if (!out.empty() && size(arc) - size(out.front().arc) > noise_deg) break;
    const auto widest =
        std::find_if(wide.begin(), wide.end(), [&](const CircleArc& w) { return !Outside(arc, w).turned; });
    if (widest == wide.end()) return {};
    const Outside outside(arc, *widest);
    noise_deg = std::max(outside.from_deg, 0.0) + std::max(outside.to_deg, 0.0);
    out.push_back({arc, std::max({outside.from_deg, outside.to_deg, 0.0})});
  }
  return out;
}

Direction Section::direction(double angle_deg) const { return on_circle(c_deg_, angle_deg); }

std::optional<Jackknife> Section::reach_deg(const Jackknife& threshold, bool up) {
  if (!(threshold.all() > 0.0)) return std::nullopt;
  const Levels level(threshold.estimate());
  const auto found = best([&](const Smoothed& s) -> std::optional<Estimate> {
    const auto reach = farthest_from_axis_deg(s.middle, level.middle, up);
    const auto high = farthest_from_axis_deg(s.high, level.middle, up),
               low = farthest_from_axis_deg(s.low, level.middle, up);
    const auto above = farthest_from_axis_deg(s.middle, level.high, up),
               below = farthest_from_axis_deg(s.middle, level.low, up);
    if (!reach || !high || !low || !above || !below) return std::nullopt;
    return Estimate{*reach,
                    std::hypot(error_within(*reach, *low, *high), error_within(*reach, *above, *below))};
  });
  if (!found) return std::nullopt;
  std::vector<double> values{found->angle.mean};
  const Jackknife levels = threshold.draws();
  const Smoothed& s = smoothed(found->radius);
  for (std::size_t r = 0; r < s.draws.size(); ++r)
    values.push_back(farthest_from_axis_deg(s.draws[r], levels.values()[r + 1], up).value_or(values[0]));
  Jackknife reach = Jackknife::from_draws(std::move(values));
  return s.draws.size() < 2 ? reach : reach.with_error(found->angle.standard_error);
}

}  // namespace lucerna
