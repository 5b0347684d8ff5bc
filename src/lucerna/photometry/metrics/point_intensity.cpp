// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/point_intensity.h"

#include <algorithm>
#include <bit>
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
/// Starts that are searched about, and tops that are looked at again.
constexpr std::size_t kSearched = 8, kRetained = 3;
/// Starts below this share of the brightest are not: a search gains less.
constexpr double kHopeful = 0.92;
/// A search ends when its step is this share of the radius.
constexpr double kFirstStep = 0.5, kLastStep = 0.1;
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

void retain_brightest(std::vector<Found>& found, std::size_t max) {
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.cd > b.cd; });
  found.resize(std::min(found.size(), max));
}

/// A search that ends as high as this share of the best went up another ripple of the same top.
constexpr double kSameTop = 0.95;

/// Half of what the best two searches differ by: a ripple that none saw may be higher by about that.
double search_error(std::vector<PointPeak> tops) {
  std::sort(tops.begin(), tops.end(),
            [](const PointPeak& a, const PointPeak& b) { return a.cd.mean > b.cd.mean; });
  if (tops.size() < 2 || tops[1].cd.mean < kSameTop * tops[0].cd.mean) return 0.0;
  return 0.5 * (tops[0].cd.mean - tops[1].cd.mean);
}

PointPeak precise_peak(const PointIntensity& intensity, const Direction& direction) {
  return {direction, precise_intensity(intensity, direction)};
}

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
  const Estimate first = intensity(direction, kFirstSamples, kFinalSeed);
  const double excess = first.standard_error / (kPrecise * first.mean);
  if (!(excess > 1.0)) return first;
  // The error falls with the root of the samples, or faster.
  const double more = std::min(excess * excess, static_cast<double>(kMaxSamples / kFirstSamples));
  return intensity(direction, kFirstSamples * std::bit_ceil(static_cast<std::uint64_t>(std::ceil(more))),
                   kFinalSeed);
}

PointPeak brightest_point(const PointIntensity& intensity, std::span<const Direction> starts,
                          double radius_deg) {
  LUCERNA_CHECK(!starts.empty(), "nowhere to start");
  std::vector<Found> found;
  for (const Direction& d : starts) found.push_back({d, intensity(d, kFirstSamples, kSearchSeed).mean});
  retain_brightest(found, kSearched);
  const double min_cd = kHopeful * found.front().cd;
  std::erase_if(found, [&](const Found& f) { return f.cd < min_cd; });
  const Direction brightest_start = found.front().direction;
  for (Found& f : found) f = pattern_search(intensity, f.direction, radius_deg);
  for (Found& f : found) f.cd = intensity(f.direction, kFirstSamples, kSearchSeed).mean;
  retain_brightest(found, kRetained);
  // Other samples judge what was found: they do not hold the noise that led the search there.
  PointPeak best = precise_peak(intensity, brightest_start);
  std::vector<PointPeak> tops;
  for (const Found& f : found) {
    tops.push_back(precise_peak(intensity, f.direction));
    if (tops.back().cd.mean > best.cd.mean) best = tops.back();
  }
  best.search_error_cd = search_error(std::move(tops));
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
