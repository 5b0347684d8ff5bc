// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/point_intensity.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

constexpr double kPrecise = 0.003;
constexpr std::uint64_t kFirstSamples = 1024, kMaxSamples = std::uint64_t{1} << 13;
/// Of each direction that a search looks at; the same random numbers for all, so that most noise cancels.
constexpr std::uint64_t kSearchSamples = 256, kSearchSeed = 11, kFinalSeed = 23;
/// Starts that are searched about, and looked at again by themselves.
constexpr std::size_t kSearched = 2, kRetained = 2;
/// A search ends when its step is this share of the radius.
constexpr double kFirstStep = 0.5, kLastStep = 0.05;
constexpr int kNeighbours = 6;
/// Steps into which a window is cut to find a crossing; points of the line through it within a step to either
/// side.
constexpr int kWindowSteps = 10, kLinePoints = 8, kMaxLines = 4;
constexpr std::uint64_t kWindowSamples = 256, kLineSamples = 512;

Direction moved(const Direction& from, double angle_rad, double distance_rad) {
  const Frame frame = Frame::from_z(from);
  const Vec3 to = std::cos(angle_rad) * frame.ex() + std::sin(angle_rad) * frame.ey();
  return Direction::from(std::cos(distance_rad) * from.vec() + std::sin(distance_rad) * to);
}

struct Found {
  Direction direction;
  double cd = 0.0;
};

Found pattern_search(const PointIntensity& intensity, const Direction& start, double radius_deg) {
  const auto look = [&](const Direction& d) {
    return Found{d, intensity(d, kSearchSamples, kSearchSeed).mean};
  };
  Found best = look(start);
  double turn = 0.0;
  for (double step = kFirstStep; step > kLastStep;) {
    const Direction centre = best.direction;
    const double before = best.cd;
    for (int k = 0; k < kNeighbours; ++k) {
      const double angle = turn + 2.0 * std::numbers::pi * k / kNeighbours;
      const Found here = look(moved(centre, angle, radians(step * radius_deg)));
      if (here.cd > best.cd) best = here;
    }
    turn += std::numbers::pi / kNeighbours;
    if (!(best.cd > before)) step *= 0.5;
  }
  return best;
}

/// Where a section falls below a threshold, its slope there, and the error of its intensity.
struct Crossing {
  double angle_deg, cd_per_deg, cd_error;
};

/// By a line through independent estimates within `half_deg` of `near_deg`; nothing where the line does not
/// fall that way (the sign of `half_deg`).
std::optional<Crossing> crossing_of_line(const PointIntensity& intensity, const DirectionAt& at,
                                         double near_deg, double half_deg, double threshold) {
  double mean = 0.0, covariance = 0.0, squares = 0.0, variance = 0.0;
  for (int k = 0; k < kLinePoints; ++k) {
    const double x = half_deg * ((2.0 * k + 1.0) / kLinePoints - 1.0);
    const Estimate cd = intensity(at(near_deg + x), kLineSamples, kFinalSeed + static_cast<std::uint64_t>(k));
    mean += cd.mean / kLinePoints;
    covariance += x * cd.mean;
    squares += x * x;
    variance += cd.standard_error * cd.standard_error / (kLinePoints * kLinePoints);
  }
  const double slope = covariance / squares, off = (threshold - mean) / slope;
  if (!(slope * half_deg < 0.0)) return std::nullopt;
  // At the crossing the line is less well known than at its middle.
  const double spread = std::sqrt(1.0 + off * off * kLinePoints / squares);
  return Crossing{near_deg + off, std::abs(slope), spread * std::sqrt(variance)};
}

/// The line about the crossing that the line before found, until it is there.
std::optional<Crossing> crossing_near(const PointIntensity& intensity, const DirectionAt& at, double near_deg,
                                      double half_deg, double threshold) {
  for (int k = 0; k < kMaxLines; ++k) {
    const auto found = crossing_of_line(intensity, at, near_deg, half_deg, threshold);
    if (!found) break;
    const double off = found->angle_deg - near_deg;
    if (std::abs(off) <= std::abs(half_deg)) return found;
    near_deg += std::copysign(half_deg, off);
  }
  return std::nullopt;
}

/// The outermost crossing from `near_deg` - `window_deg` to `near_deg` + `window_deg`, the outer end.
std::optional<Crossing> find_crossing(const PointIntensity& intensity, const DirectionAt& at, double near_deg,
                                      double window_deg, double threshold) {
  const auto cd = [&](double angle) { return intensity(at(angle), kWindowSamples, kSearchSeed).mean; };
  const double step = 2.0 * window_deg / kWindowSteps;
  double inner = near_deg + window_deg;
  int k = 0;
  for (; cd(inner) < threshold; inner -= step) {
    if (++k > kWindowSteps) return std::nullopt;
  }
  if (k == 0) return std::nullopt;  // bright beyond the window
  return crossing_near(intensity, at, inner + 0.5 * step, step, threshold);
}

}  // namespace

Estimate precise_intensity(const PointIntensity& intensity, const Direction& direction) {
  Estimate e;
  for (std::uint64_t samples = kFirstSamples; samples <= kMaxSamples; samples *= 2) {
    e = intensity(direction, samples, kFinalSeed);
    if (e.standard_error <= kPrecise * e.mean) break;
  }
  return e;
}

PointPeak brightest_point(const PointIntensity& intensity, std::span<const Direction> starts,
                          double radius_deg) {
  LUCERNA_CHECK(!starts.empty(), "nowhere to start");
  std::vector<Found> found;
  for (const Direction& d : starts) found.push_back({d, intensity(d, kFirstSamples, kSearchSeed).mean});
  const auto brighter = [](const Found& a, const Found& b) { return a.cd > b.cd; };
  std::stable_sort(found.begin(), found.end(), brighter);
  const std::size_t searched = std::min(kSearched, found.size());
  found.resize(std::min(found.size(), kRetained));
  for (std::size_t i = 0; i < searched; ++i)
    found.push_back(pattern_search(intensity, found[i].direction, radius_deg));
  // Other samples choose among the few that are left, and do not hold the noise that led the search there.
  PointPeak best{};
  for (const Found& f : found) {
    const Estimate cd = precise_intensity(intensity, f.direction);
    if (cd.mean > best.cd.mean) best = {f.direction, cd};
  }
  return best;
}

std::optional<Estimate> exact_arc_deg(const PointIntensity& intensity, const DirectionAt& at,
                                      const CircleArc& near, double window_deg, const Estimate& threshold) {
  const auto from = find_crossing(intensity, at, near.from_deg, -window_deg, threshold.mean);
  const auto to = find_crossing(intensity, at, near.to_deg, window_deg, threshold.mean);
  if (!from || !to) return std::nullopt;
  const double by_threshold = threshold.standard_error * (1.0 / from->cd_per_deg + 1.0 / to->cd_per_deg);
  return Estimate{to->angle_deg - from->angle_deg,
                  std::hypot(by_threshold, from->cd_error / from->cd_per_deg, to->cd_error / to->cd_per_deg)};
}

}  // namespace lucerna
