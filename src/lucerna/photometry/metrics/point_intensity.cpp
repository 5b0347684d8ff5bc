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

constexpr double kPrecise = 0.0015;
constexpr std::uint64_t kFirstSamples = 1024, kMaxSamples = std::uint64_t{1} << 13;
/// Of each direction that a search looks at; the same random numbers for all, so that most noise cancels.
constexpr std::uint64_t kSearchSamples = 256, kSearchSeed = 11, kCompareSeed = 17, kFinalSeed = 23;
/// Noise of what ripples are compared and climbed by: less than they differ by.
constexpr double kSearchNoise = 0.002;
constexpr std::uint64_t kFineSamples = std::uint64_t{1} << 12;
/// Starts that are searched about, and tops that are looked at again.
constexpr std::size_t kSearched = 8, kRetained = 3;
/// Starts below this share of the brightest are not: a search gains less.
constexpr double kHopeful = 0.85;
/// About the best top two rings of directions are looked at, as far away as starts are from each other and
/// twice as far; the brightest of them are searched about, again from what that finds.
constexpr double kFirstRing = 2.0, kSecondRing = 4.0;
constexpr std::size_t kHops = 3;
constexpr int kRounds = 2;
constexpr int kNeighbours = 6;
/// A search goes from the first step to the last, shares of the radius, with so many samples a direction.
struct Steps {
  double first, last;
  std::uint64_t samples;
};
/// About each start; and about the best that they found: the tip of a narrow lobe is sharper than a search's
/// last step.
constexpr Steps kCoarse{0.5, 0.1, kSearchSamples};
constexpr double kFineFirst = 0.1, kFineLast = 0.0125;
/// Of what the finer steps gained: still finer ones may gain so much.
constexpr double kRestOfGain = 0.25;
/// So many more steps from where a crossing seems to be.
constexpr int kMaxSteps = 6;
/// Points of a mean within a step to either side, and the length of the last as a share of the others.
constexpr int kMeanPoints = 6;
constexpr double kShorter = 0.25;
constexpr int kMaxShorter = 3;
constexpr double kSlopeError = 0.5;
/// A mean this many errors from the threshold is at it.
constexpr double kSameErrors = 2.0;
/// Of each direction of a window, and of those where that leaves open on which side of the threshold it is.
constexpr std::uint64_t kWindowSamples = 256, kDoubtSamples = 2048, kMeanSamples = 256;

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

/// A search that ends as high as this share of the best went up another ripple of the same top, a lower one a
/// lobe of its own; searches that end within this share of the radius went up the same.
constexpr double kSameTop = 0.97, kSameRipple = 0.25;

/// The highest of `found`, which is sorted, that are not one ripple.
std::vector<Found> highest_ripples(const std::vector<Found>& found, double radius_deg) {
  std::vector<Found> ripples;
  for (const Found& f : found) {
    const bool other = std::all_of(ripples.begin(), ripples.end(), [&](const Found& r) {
      return degrees(angle_between(r.direction, f.direction)) > kSameRipple * radius_deg;
    });
    if (other && f.cd >= kSameTop * found.front().cd) ripples.push_back(f);
    if (ripples.size() == kRetained) break;
  }
  return ripples;
}

/// By how much a ripple that no search went up may be higher than the best that one did, of `tops` by falling
/// height. At their upper end heights fall off exponentially, with the mean excess of the highest over the
/// next as their scale (I. Weissman, 1978). If as many ripples are unseen as were seen, the highest of these
/// is the higher one in half of the cases, and then by an exponential excess: on the average the square of it
/// is that of the scale. So is, but for a quarter, the mean square of the first two excesses; one alone is
/// small by chance too often.
double search_error(std::span<const PointPeak> tops) {
  if (tops.size() < 2) return 0.0;
  double squares = 0.0;
  for (std::size_t k = 1; k < tops.size(); ++k) {
    const double excess = tops[k - 1].cd.mean - tops[k].cd.mean;
    squares += excess * excess;
  }
  return std::sqrt(squares / static_cast<double>(tops.size() - 1));
}

/// So many samples have this relative error, or `max` of them one near it, where kFirstSamples have that of
/// `first`: it falls with the root of their number, or faster.
std::uint64_t samples_for(const Estimate& first, double error, std::uint64_t max) {
  const double excess = first.standard_error / (error * first.mean);
  if (!(excess > 1.0)) return kFirstSamples;
  const double more = std::min(excess * excess, static_cast<double>(max / kFirstSamples));
  return kFirstSamples * std::bit_ceil(static_cast<std::uint64_t>(std::ceil(more)));
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

/// The tip above a place: tips are sharper than the steps so far, and what is left to climb is not the same
/// for all. Other samples judge what was found. They do not hold the noise that led the search there; where
/// it led down the place itself is the tip.
PointPeak climbed(const PointIntensity& intensity, const Direction& from, double radius_deg,
                  std::uint64_t samples) {
  const Found tip = pattern_search(intensity, from, radius_deg, {kFineFirst, kFineLast, samples});
  PointPeak before = precise_peak(intensity, from);
  PointPeak top = precise_peak(intensity, tip.direction);
  if (before.cd.mean > top.cd.mean) return before;
  top.cd.standard_error = std::hypot(top.cd.standard_error, kRestOfGain * (top.cd.mean - before.cd.mean));
  return top;
}

/// Searches from directions about the best of `found`, which is sorted, until that finds no better one.
void search_around(const PointIntensity& intensity, double radius_deg, std::vector<Found>& found) {
  for (int round = 0; round < kRounds; ++round) {
    const Found best = found.front();
    std::vector<Found> starts;
    for (const double ring : {kFirstRing, kSecondRing}) {
      for (int k = 0; k < kNeighbours; ++k) {
        const double angle = (2.0 * k + ring / kSecondRing) * std::numbers::pi / kNeighbours;
        const Direction d = moved(best.direction, angle, radians(ring * radius_deg));
        starts.push_back({d, intensity(d, kSearchSamples, kSearchSeed).mean});
      }
    }
    retain_brightest(starts, kHops);
    std::erase_if(starts, [&](const Found& f) { return f.cd < kHopeful * best.cd; });
    for (const Found& start : starts) {
      Found top = pattern_search(intensity, start.direction, radius_deg, kCoarse);
      top.cd = intensity(top.direction, kFirstSamples, kSearchSeed).mean;
      found.push_back(top);
    }
    retain_brightest(found, found.size());
    if (!(found.front().cd > best.cd)) return;
  }
}

/// Each end of an arc has random numbers of its own, which are not the peak's either: where they are shared
/// both ends are too bright at once, but the error of the arc takes them as independent.
constexpr std::uint64_t kFromNumbers = 1000, kToNumbers = 2000;

PointIntensity with_other_numbers(const PointIntensity& intensity, std::uint64_t first) {
  return [&intensity, first](const Direction& d, std::uint64_t samples, std::uint64_t seed) {
    return intensity(d, samples, first + seed);
  };
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
/// when the mean of a quarter of the length about it is the threshold, within the noise. What is left of that
/// is taken off by the slope over the longer step, which may be twice that at the crossing or half: half of
/// it is in the error.
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
                     std::hypot(cd.standard_error, kSlopeError * off)};
    if (std::abs(off) <= kSameErrors * cd.standard_error) return found;
    found->cd_error = std::hypot(cd.standard_error, off);
  }
  return found;
}

/// On which side of the threshold a direction is, and whether noise leaves that open.
struct Side {
  bool bright, certain;
};

Side side_of(const PointIntensity& intensity, const Direction& d, const Estimate& threshold) {
  Side side{};
  for (const std::uint64_t samples : {kWindowSamples, kDoubtSamples}) {
    const Estimate cd = intensity(d, samples, kSearchSeed);
    side.bright = cd.mean >= threshold.mean;
    side.certain = std::abs(cd.mean - threshold.mean) >
                   kIntervalErrors * std::hypot(cd.standard_error, threshold.standard_error);
    if (side.certain) break;
  }
  return side;
}

/// The outermost crossing from `window_deg` outside of `near_deg` to `inward_deg` inside of it, or, where it
/// is still bright there, the next one within another window. Outside is where `window_deg` has its sign to.
/// Its error has the steps further outside that may be bright, and those further inside that may not be:
/// where the light runs level along the threshold, noise over slope says nothing.
std::optional<Crossing> find_crossing(const PointIntensity& intensity, const DirectionAt& at, double near_deg,
                                      double window_deg, double inward_deg, double step_deg,
                                      const Estimate& threshold) {
  const double step = std::copysign(step_deg, window_deg), outer = near_deg + window_deg;
  const bool outward = side_of(intensity, at(outer), threshold).bright;
  const int window = static_cast<int>(std::ceil(window_deg / step));
  const int steps = outward ? window : window + static_cast<int>(inward_deg / step_deg);
  std::optional<int> crossed, open;
  int sure = 0;
  for (int k = 1; k <= steps; ++k) {
    const Side side = side_of(intensity, at(outer + (outward ? k : -k) * step), threshold);
    if (!side.certain && !open) open = k;
    if (side.bright != outward && !crossed) crossed = k;
    sure = k;
    if (crossed && side.bright != outward && side.certain) break;
  }
  if (!crossed) return std::nullopt;
  const double angle = outer + (outward ? *crossed - 0.5 : 0.5 - *crossed) * step;
  std::optional<Crossing> found = precise_crossing(intensity, at, angle, step, threshold.mean);
  if (!found) return std::nullopt;
  // One step to either side is what any crossing spans.
  const int level = std::max({*crossed - open.value_or(*crossed), sure - *crossed, 1}) - 1;
  const double level_cd = level * step_deg / kIntervalErrors * std::abs(found->cd_per_deg);
  found->cd_error = std::max(found->cd_error, level_cd);
  return found;
}

}  // namespace

Estimate precise_intensity(const PointIntensity& intensity, const Direction& direction) {
  const Estimate first = intensity(direction, kFirstSamples, kFinalSeed);
  const std::uint64_t samples = samples_for(first, kPrecise, kMaxSamples);
  return samples > kFirstSamples ? intensity(direction, samples, kFinalSeed) : first;
}

PointPeak brightest_point(const PointIntensity& intensity, std::span<const Direction> starts,
                          double radius_deg) {
  LUCERNA_CHECK(!starts.empty(), "nowhere to start");
  std::vector<Found> found;
  for (const Direction& d : starts) found.push_back({d, intensity(d, kFirstSamples, kSearchSeed).mean});
  retain_brightest(found, kSearched);
  const double min_cd = kHopeful * found.front().cd;
  std::erase_if(found, [&](const Found& f) { return f.cd < min_cd; });
  std::vector<Found> seen = found;
  for (Found& f : found) f = pattern_search(intensity, f.direction, radius_deg, kCoarse);
  for (Found& f : found) f.cd = intensity(f.direction, kFirstSamples, kSearchSeed).mean;
  retain_brightest(found, kSearched);
  search_around(intensity, radius_deg, found);
  // Noise leads searches away from starts that were better: other numbers than those that led them compare.
  seen.insert(seen.end(), found.begin(), found.end());
  const std::uint64_t samples =
      samples_for(intensity(found.front().direction, kFirstSamples, kFinalSeed), kSearchNoise, kFineSamples);
  for (Found& f : seen) f.cd = intensity(f.direction, samples, kCompareSeed).mean;
  retain_brightest(seen, seen.size());
  std::vector<PointPeak> tops;
  for (const Found& f : highest_ripples(seen, radius_deg)) {
    tops.push_back(climbed(intensity, f.direction, radius_deg, std::max(kFirstSamples, samples / 2)));
  }
  std::ranges::stable_sort(tops, std::ranges::greater(), [](const PointPeak& p) { return p.cd.mean; });
  // Fine steps can raise one tip above the others, which are lobes of their own then.
  const double same_cd = kSameTop * tops.front().cd.mean;
  std::erase_if(tops, [&](const PointPeak& p) { return p.cd.mean < same_cd; });
  PointPeak best = tops.front();
  best.search_error_cd = search_error(tops);
  // What lies within this counts as one ripple.
  best.ripple_error_deg = kSameRipple * radius_deg / kIntervalErrors;
  for (std::size_t k = 1; k < tops.size(); ++k) best.others.push_back(tops[k].direction);
  return best;
}

std::optional<Estimate> exact_arc_deg(const PointIntensity& intensity, const DirectionAt& at,
                                      const CircleArc& near, const ArcWindow& window,
                                      const Estimate& threshold) {
  const auto is_noisy = [&](double angle_deg) {
    return mean_about(intensity, at, angle_deg, window.step_deg).standard_error >
           window.max_noise * threshold.mean;
  };
  if (std::isfinite(window.max_noise) && (is_noisy(near.from_deg) || is_noisy(near.to_deg)))
    return std::nullopt;
  const double inward_deg = std::max(window.outward_deg, 0.5 * (near.to_deg - near.from_deg));
  const auto end = [&](double near_deg, double outward_deg, std::uint64_t numbers) {
    return find_crossing(with_other_numbers(intensity, numbers), at, near_deg, outward_deg, inward_deg,
                         window.step_deg, threshold);
  };
  const auto from = end(near.from_deg, -window.outward_deg, kFromNumbers),
             to = end(near.to_deg, window.outward_deg, kToNumbers);
  if (!from || !to) return std::nullopt;
  const double by_threshold =
      threshold.standard_error * (1.0 / std::abs(from->cd_per_deg) + 1.0 / std::abs(to->cd_per_deg));
  return Estimate{to->angle_deg - from->angle_deg,
                  std::hypot(by_threshold, from->error_deg(), to->error_deg())};
}

}  // namespace lucerna
