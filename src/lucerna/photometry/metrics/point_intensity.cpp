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
constexpr int kNeighbours = 6;
/// A search goes from the first step to the last, shares of the radius, with so many samples a direction.
struct Steps {
  double first, last;
  std::uint64_t samples;
};
/// About each start; and about the best that they found: the tip of a narrow lobe is sharper than a search's
/// last step.
constexpr Steps kCoarse{0.5, 0.1, kSearchSamples}, kFine{0.1, 0.0125, kFirstSamples};
/// Of what the finer steps gained: still finer ones may gain so much.
constexpr double kRestOfGain = 0.25;
/// Steps into which a window is cut to find a crossing, and so many more from there.
constexpr int kWindowSteps = 5, kMaxSteps = 6;
/// Points of a mean within a step to either side, and the length of the last as a share of the others.
constexpr int kMeanPoints = 6;
constexpr double kShorter = 0.25;
constexpr int kMaxShorter = 3;
/// A mean this many errors from the threshold is at it.
constexpr double kSameErrors = 2.0;
constexpr std::uint64_t kWindowSamples = 256, kMeanSamples = 512;

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

Found pattern_search(const PointIntensity& intensity, const Direction& start, double radius_deg,
                     const Steps& steps) {
  const auto look = [&](const Direction& d) {
    return Found{d, intensity(d, steps.samples, kSearchSeed).mean};
  };
  Found best = look(start);
  double turn = 0.0;
  for (double step = steps.first; step > steps.last;) {
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

  double error_deg() const { return cd_error / std::abs(cd_per_deg); }
};

/// The mean of independent estimates within `half_deg` of an angle.
Estimate mean_about(const PointIntensity& intensity, const DirectionAt& at, double angle_deg,
                    double half_deg) {
  double sum = 0.0, variance = 0.0;
  for (int k = 0; k < kMeanPoints; ++k) {
    const double x = half_deg * ((2.0 * k + 1.0) / kMeanPoints - 1.0);
    const Estimate cd =
        intensity(at(angle_deg + x), kMeanSamples, kFinalSeed + static_cast<std::uint64_t>(k));
    sum += cd.mean;
    variance += cd.standard_error * cd.standard_error;
  }
  return {sum / kMeanPoints, std::sqrt(variance) / kMeanPoints};
}

/// Steps from `angle_deg` to where means lie on either side of the threshold, and the crossing of the line
/// through these; nothing where that is too far. Outside is where `step_deg` has its sign to.
std::optional<Crossing> crossing_near(const PointIntensity& intensity, const DirectionAt& at,
                                      double angle_deg, double step_deg, double threshold) {
  Estimate here = mean_about(intensity, at, angle_deg, step_deg);
  const bool bright = here.mean >= threshold;
  const double step = bright ? step_deg : -step_deg;
  for (int k = 0; k < kMaxSteps; ++k) {
    const Estimate next = mean_about(intensity, at, angle_deg + step, step_deg);
    if ((next.mean >= threshold) != bright) {
      const double slope = (next.mean - here.mean) / step, off = (threshold - here.mean) / slope;
      const double share = off / step;
      return Crossing{angle_deg + off, slope,
                      std::hypot((1.0 - share) * here.standard_error, share * next.standard_error)};
    }
    angle_deg += step;
    here = next;
  }
  return std::nullopt;
}

/// The crossing by ever shorter steps: a line through two means leaves out how the section bends. It is found
/// when the mean of a quarter of the length about it is the threshold, within the noise; what is left of that
/// is in the error.
std::optional<Crossing> precise_crossing(const PointIntensity& intensity, const DirectionAt& at,
                                         double angle_deg, double step_deg, double threshold) {
  std::optional<Crossing> found;
  for (int k = 0; k < kMaxShorter; ++k) {
    const auto near = crossing_near(intensity, at, angle_deg, step_deg, threshold);
    if (!near) return found;
    step_deg *= kShorter;
    angle_deg = near->angle_deg;
    const Estimate cd = mean_about(intensity, at, angle_deg, step_deg);
    const double off = threshold - cd.mean;
    found = Crossing{angle_deg + off / near->cd_per_deg, near->cd_per_deg,
                     std::hypot(cd.standard_error, kShorter * kShorter * off)};
    if (std::abs(off) <= kSameErrors * cd.standard_error) return found;
    found->cd_error = std::hypot(cd.standard_error, off);
  }
  return found;
}

/// The outermost crossing from `window_deg` outside of `near_deg` to `inward_deg` inside of it, or, where it
/// is still bright there, the next one within another window. Outside is where `window_deg` has its sign to.
std::optional<Crossing> find_crossing(const PointIntensity& intensity, const DirectionAt& at, double near_deg,
                                      double window_deg, double inward_deg, double threshold) {
  const auto bright = [&](double angle) {
    return intensity(at(angle), kWindowSamples, kSearchSeed).mean >= threshold;
  };
  const double step = window_deg / kWindowSteps, outer = near_deg + window_deg;
  const bool outward = bright(outer);
  const int steps = outward ? kWindowSteps : kWindowSteps + static_cast<int>(inward_deg / std::abs(step));
  for (int k = 1; k <= steps; ++k) {
    const double angle = outer + (outward ? k : -k) * step;
    if (bright(angle) == outward) continue;
    return precise_crossing(intensity, at, angle + (outward ? -0.5 : 0.5) * step, step, threshold);
  }
  return std::nullopt;
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
  for (Found& f : found) f = pattern_search(intensity, f.direction, radius_deg, kCoarse);
  for (Found& f : found) f.cd = intensity(f.direction, kFirstSamples, kSearchSeed).mean;
  retain_brightest(found, kRetained);
  const double coarse_cd = found.front().cd;
  found.front() = pattern_search(intensity, found.front().direction, radius_deg, kFine);
  const double rest_cd = kRestOfGain * std::max(0.0, found.front().cd - coarse_cd);
  // Other samples judge what was found: they do not hold the noise that led the search there.
  PointPeak best = precise_peak(intensity, brightest_start);
  std::vector<PointPeak> tops;
  for (const Found& f : found) {
    tops.push_back(precise_peak(intensity, f.direction));
    if (tops.back().cd.mean > best.cd.mean) best = tops.back();
  }
  best.cd.standard_error = std::hypot(best.cd.standard_error, rest_cd);
  best.search_error_cd = search_error(std::move(tops));
  return best;
}

std::optional<Estimate> exact_arc_deg(const PointIntensity& intensity, const DirectionAt& at,
                                      const CircleArc& near, double window_deg, const Estimate& threshold) {
  const double inward_deg = std::max(window_deg, 0.5 * (near.to_deg - near.from_deg));
  const auto from = find_crossing(intensity, at, near.from_deg, -window_deg, inward_deg, threshold.mean);
  const auto to = find_crossing(intensity, at, near.to_deg, window_deg, inward_deg, threshold.mean);
  if (!from || !to) return std::nullopt;
  const double by_threshold =
      threshold.standard_error * (1.0 / std::abs(from->cd_per_deg) + 1.0 / std::abs(to->cd_per_deg));
  return Estimate{to->angle_deg - from->angle_deg,
                  std::hypot(by_threshold, from->error_deg(), to->error_deg())};
}

}  // namespace lucerna
