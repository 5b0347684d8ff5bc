// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/peak_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/photometry/metrics/radius_choice.h"

namespace lucerna {

namespace {

constexpr double kWidestRadius_deg = 24.0;
/// The kernel's radius over the half width of a lobe, and over the distance of its nearest side: a kernel
/// must not look over an edge.
constexpr double kRadiusOfWidth = 0.3, kRadiusOfSide = 0.5;
/// Along C a kernel is made wider than the lobe is narrow while the light keeps this share of its peak.
constexpr double kLevelAlongC = 0.8;
/// Spacing of the directions that are tried, in radii.
constexpr double kSpacing = 0.5;
/// Directions are candidates down to this share of the brightest: the fit moves a kernel mean by less.
constexpr double kCandidateShare = 0.9;
constexpr std::size_t kMaxCandidates = 400;
/// Where a kernel's mean is below this share of the largest, kernels of half the solid angle need not look.
constexpr double kDarkShare = 0.1;
/// The same for kernels as small as there are, of so much less solid angle.
constexpr double kNarrowestShare = 0.5;
/// Each candidate's quadratic is looked at on a stencil of this many points a side within its spacing.
constexpr std::size_t kStencil = 5;
/// A narrower scale is taken if it is brighter by so many errors of the difference. Eight values tell each
/// half's error, and a dozen scales are tried: Student's t is that large for one run in a thousand.
constexpr double kHigherErrors = 5.0;
/// What it is brighter by beyond so many is in the error where it is not taken.
constexpr double kNoiseErrors = 3.0;
/// A kernel that is so many times as long as it is wide follows a ring.
constexpr double kRing = 1.5;
/// What is as far from a place, in radii, as this belongs to its lobe.
constexpr double kNear = 2.0;
/// Directions that are offered as starts of a finer search.
constexpr std::size_t kMaxBright = 12;
/// Kernels of this radius show ripples on top of a lobe; wider ones may not.
constexpr double kRippleRadius_deg = 1.5;

/// Directions in rows of gamma that cover the sphere, the poles among them.
class Covering {
 public:
  explicit Covering(const Kernel& kernel)
      : rows_(std::max(1, static_cast<int>(std::ceil(180.0 / (kSpacing * kernel.radius_deg))))) {
    for (int i = 0; i <= rows_; ++i) {
      const double gamma = std::numbers::pi * i / rows_;
      // As far apart as the kernel is wide there.
      const double spacing_deg =
          kSpacing *
          std::max(kernel.radius_deg, std::min(kernel.c_radius_deg, kWidestKernelC_deg * std::sin(gamma)));
      first_.push_back(size_);
      columns_.push_back(
          std::max(1, static_cast<int>(std::ceil(360.0 * std::sin(gamma) / spacing_deg - 1e-9))));
      size_ += static_cast<std::size_t>(columns_.back());
    }
  }
  std::size_t size() const { return size_; }
  int rows() const { return rows_; }
  int columns(int row) const { return columns_[static_cast<std::size_t>(row)]; }
  std::size_t index(int row, int column) const {
    return first_[static_cast<std::size_t>(row)] + static_cast<std::size_t>(column);
  }
  TypeCAngles angles(int row, int column) const {
    return {2.0 * std::numbers::pi * column / columns(row), std::numbers::pi * row / rows_};
  }
  std::size_t nearest(const TypeCAngles& a) const {
    const int row = static_cast<int>(std::lround(a.gamma_rad / std::numbers::pi * rows_));
    const int n = columns(row);
    return index(row, static_cast<int>(std::lround(a.c_rad / (2.0 * std::numbers::pi) * n)) % n);
  }

 private:
  int rows_;
  std::size_t size_ = 0;
  std::vector<int> columns_;
  std::vector<std::size_t> first_;
};

/// Kernel means on a covering; -1 where the scan before found too little to look at.
struct Scan {
  Covering covering;
  std::vector<Direction> directions;
  std::vector<double> cd;
  std::size_t best = 0;
};

using MeanCd = std::function<double(const Direction&, const Kernel&)>;

/// Where the scan `before` has less than `dark` of its largest is not looked at.
Scan scan(const MeanCd& mean_cd, const Kernel& kernel, const Scan* before, double dark = kDarkShare) {
  Scan s{Covering(kernel), {}, {}, 0};
  s.directions.resize(s.covering.size());
  s.cd.assign(s.covering.size(), -1.0);
  parallel_blocks(static_cast<std::size_t>(s.covering.rows()) + 1, 1, [&](std::size_t first, std::size_t) {
    const int row = static_cast<int>(first);
    for (int k = 0; k < s.covering.columns(row); ++k) {
      const TypeCAngles a = s.covering.angles(row, k);
      const std::size_t i = s.covering.index(row, k);
      s.directions[i] = direction_from_type_c(a);
      if (before != nullptr && before->cd[before->covering.nearest(a)] < dark * before->cd[before->best])
        continue;
      s.cd[i] = mean_cd(s.directions[i], kernel);
    }
  });
  s.best = static_cast<std::size_t>(std::max_element(s.cd.begin(), s.cd.end()) - s.cd.begin());
  return s;
}

Scan scan(const CountedSphere& sphere, const Kernel& kernel, const Scan* before) {
  return scan([&](const Direction& d, const Kernel& k) { return sphere.mean_of_all_cd(d, k); }, kernel,
              before);
}

struct PointOfScan {
  Direction direction;
  double cd;
};

struct LobeWidth {
  double half_deg = 180.0, side_deg = 180.0;
};

/// How far from `centre` the kernel mean falls to half of `cd`, in four sections.
LobeWidth lobe_width(const CountedSphere& sphere, const Direction& centre, double cd, double radius_deg) {
  const Vec3 helper = std::abs(centre.z()) < 0.9 ? Vec3{0.0, 0.0, 1.0} : Vec3{1.0, 0.0, 0.0};
  const Vec3 ex = Direction::from(cross(helper, centre.vec())).vec(), ey = cross(centre.vec(), ex);
  const double step = 0.25 * radius_deg;
  const auto side = [&](double angle) {
    const Vec3 to = std::cos(angle) * ex + std::sin(angle) * ey;
    double before = cd;
    for (double t = step; t < 180.0; t += step) {
      const Direction d = Direction::from(std::cos(radians(t)) * centre.vec() + std::sin(radians(t)) * to);
      const double here = sphere.mean_of_all_cd(d, Kernel(radius_deg));
      if (here < 0.5 * cd) return t - step * (0.5 * cd - here) / std::max(before - here, 1e-300);
      before = here;
    }
    return 180.0;
  };
  LobeWidth w;
  for (int k = 0; k < 4; ++k) {
    const double angle = 0.25 * std::numbers::pi * k;
    const double a = side(angle), b = side(angle + std::numbers::pi);
    w.half_deg = std::min(w.half_deg, 0.5 * (a + b));
    w.side_deg = std::min({w.side_deg, a, b});
  }
  return w;
}

/// The largest radius along C that does not see how the lobe falls off that way. What is compared is averaged
/// along C over the more the further away it is, so that the noise of a narrow kernel does not look like an
/// end.
double radius_along_c(const CountedSphere& sphere, const Direction& centre, double radius_deg) {
  const TypeCAngles at = type_c_angles(centre);
  const double sine = std::max(std::sin(at.gamma_rad), 1e-9);
  double side = radius_deg;
  for (double t = 1.5 * radius_deg; radians(t) < std::numbers::pi * sine; t *= 1.25) {
    const Kernel kernel(radius_deg, 0.5 * t);
    const double level = kLevelAlongC * sphere.mean_of_all_cd(centre, kernel);
    for (const double turn : {1.0, -1.0}) {
      const Direction d = direction_from_type_c({at.c_rad + turn * radians(t) / sine, at.gamma_rad});
      if (sphere.mean_of_all_cd(d, kernel) < level) return std::min(kRadiusOfSide * side, kWidestRadius_deg);
    }
    side = t;
  }
  return std::min(kRadiusOfSide * side, kWidestRadius_deg);
}

double radius_for(const LobeWidth& w) {
  return std::min({kRadiusOfWidth * w.half_deg, kRadiusOfSide * w.side_deg, kWidestRadius_deg});
}

/// A place in the quadratic about one candidate direction.
struct Place {
  std::size_t fit = 0;
  double x = 0.0, y = 0.0;
};

struct Candidates {
  std::vector<LocalFit> fits;
  std::vector<Place> places;
  std::vector<Jackknife> cd;
  Direction direction(std::size_t i) const { return fits[places[i].fit].direction(places[i].x, places[i].y); }
};

/// The x and y of a quadratic that are looked at: half way to the next direction.
std::array<std::array<double, 2>, kStencil * kStencil> stencil() {
  std::array<std::array<double, 2>, kStencil * kStencil> out{};
  const double reach = 0.5 * kSpacing, step = 2.0 * reach / (kStencil - 1);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {-reach + step * static_cast<double>(i / kStencil),
              -reach + step * static_cast<double>(i % kStencil)};
  return out;
}

Candidates candidates(const CountedSphere& sphere, const Scan& s, const Kernel& kernel) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < s.cd.size(); ++i) {
    if (s.cd[i] >= kCandidateShare * s.cd[s.best]) chosen.push_back(i);
  }
  if (chosen.size() > kMaxCandidates) {
    std::nth_element(
        chosen.begin(), chosen.begin() + kMaxCandidates, chosen.end(),
        [&](std::size_t a, std::size_t b) { return std::pair(-s.cd[a], a) < std::pair(-s.cd[b], b); });
    chosen.resize(kMaxCandidates);
    std::sort(chosen.begin(), chosen.end());
  }
  Candidates out;
  out.fits.resize(chosen.size());
  parallel_blocks(chosen.size(), 1, [&](std::size_t first, std::size_t) {
    out.fits[first] = sphere.fit(s.directions[chosen[first]], kernel);
  });
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    for (const auto& [x, y] : stencil()) {
      out.places.push_back({k, x, y});
      out.cd.push_back(out.fits[k].at(x, y));
    }
  }
  return out;
}

/// The brightest places as kernels of one size show them.
struct Scale {
  Kernel kernel;
  LobeWidth width;
  Scan scan;
  Candidates candidates;
  LargestFigure max;
  /// What narrower kernels may be brighter by; they are not for certain.
  double missed_cd = 0.0;
};

/// Angle between a and b, in degrees.
double apart_deg(const Direction& a, const Direction& b) { return degrees(angle_between(a, b)); }

/// Whether a candidate far from the brightest is as bright within the error of the difference.
void find_runners_up(const Candidates& c, const LargestFigure& max, const PeakEstimate& p, bool& other_c,
                     bool& other_gamma) {
  const TypeCAngles at = type_c_angles(c.direction(max.index));
  for (std::size_t i = 0; i < c.cd.size(); ++i) {
    const TypeCAngles a = type_c_angles(c.direction(i));
    const double turn = std::remainder(a.c_rad - at.c_rad, 2.0 * std::numbers::pi);
    const double across = degrees(2.0 * std::sqrt(std::sin(at.gamma_rad) * std::sin(a.gamma_rad)) *
                                  std::abs(std::sin(0.5 * turn)));
    const bool far_c = across > 2.0 * p.c_radius_deg;
    const bool far_gamma = std::abs(degrees(a.gamma_rad - at.gamma_rad)) > 2.0 * p.radius_deg;
    if (!far_c && !far_gamma) continue;
    Jackknife difference = c.cd[max.index];
    difference.add(-1.0, c.cd[i].values());
    const Estimate e = difference.estimate();
    if (e.mean > 2.0 * e.standard_error) continue;
    other_c = other_c || far_c;
    other_gamma = other_gamma || far_gamma;
  }
}

/// The top of the quadratic with the coefficients of draw `r`; nothing if it is no hill of which the top is
/// near by.
std::optional<Direction> top(const LocalFit& fit, std::size_t r) {
  const auto c = [&](std::size_t k) { return fit.coefficients[k].draws().values()[r]; };
  const double xx = 2.0 * c(3), xy = c(4), yy = 2.0 * c(5), det = xx * yy - xy * xy;
  if (!(xx < 0.0 && det > 0.0)) return std::nullopt;
  const double x = (xy * c(2) - yy * c(1)) / det, y = (xy * c(1) - xx * c(2)) / det;
  if (!(x * x + y * y < 1.0)) return std::nullopt;
  return fit.direction(x, y);
}

/// Where the peak is in the whole run and in each draw of the noise: the top about the candidate that is the
/// brightest there, or the candidate itself where the quadratic has no top.
std::vector<Direction> tops(const Candidates& candidates) {
  std::vector<Direction> out;
  std::vector<Jackknife> draws;
  for (const Jackknife& cd : candidates.cd) draws.push_back(cd.draws());
  for (std::size_t r = 0; r < draws.front().values().size(); ++r) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < draws.size(); ++i) {
      if (draws[i].values()[r] > draws[best].values()[r]) best = i;
    }
    out.push_back(top(candidates.fits[candidates.places[best].fit], r).value_or(candidates.direction(best)));
  }
  return out;
}

/// Root of the mean square of the draws' angles from the whole run's.
double scatter(const std::vector<double>& angles) {
  double squares = 0.0;
  for (const double a : angles) squares += a * a;
  return std::sqrt(squares / static_cast<double>(angles.size()));
}

/// The lobe's width, the direction, its error and whether it is determined.
void place_peak(const Scale& s, PeakEstimate& p) {
  const Candidates& c = s.candidates;
  p.half_width_deg = s.width.half_deg;
  p.nearest_side_deg = s.width.side_deg;
  p.radius_deg = s.kernel.radius_deg;
  p.c_radius_deg = s.kernel.c_radius_deg;
  p.gamma_deg.reset();
  p.c_deg.reset();
  std::vector<Direction> draws = tops(c);
  // A place is read off a stencil: a part of its step is the least error.
  const double min = p.radius_deg * kSpacing / (kStencil - 1) / std::sqrt(12.0);
  p.direction = draws.front();
  draws.erase(draws.begin());
  const TypeCAngles at = type_c_angles(p.direction);
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  p.direction_error_deg = unknown;
  double gamma_error = unknown, c_error = unknown;
  if (draws.size() >= 2) {
    std::vector<double> gaps, along, across;
    for (const Direction& d : draws) {
      gaps.push_back(apart_deg(d, p.direction));
      along.push_back(degrees(type_c_angles(d).gamma_rad - at.gamma_rad));
      across.push_back(std::sqrt(std::max(0.0, gaps.back() * gaps.back() - along.back() * along.back())));
    }
    p.direction_error_deg = std::hypot(scatter(gaps), min);
    gamma_error = std::hypot(scatter(along), min);
    c_error = std::hypot(scatter(across), min) / std::max(std::sin(at.gamma_rad), 1e-9);
  }
  bool other_c = false, other_gamma = false;
  find_runners_up(c, s.max, p, other_c, other_gamma);
  const double from_pole = degrees(std::min(at.gamma_rad, std::numbers::pi - at.gamma_rad));
  if (!other_gamma) p.gamma_deg = Estimate{degrees(at.gamma_rad), gamma_error};
  // The draws of a ring of light are far apart too, but all as far from the axis.
  const bool on_axis = from_pole <= 2.0 * std::min(p.direction_error_deg, 2.0 * gamma_error);
  if (!other_c && !on_axis && !(c_error > 90.0)) p.c_deg = Estimate{degrees(at.c_rad), c_error};
}

/// The kernel at the peak: `widest` or one of half its radius, a quarter, ... Structure below the cells'
/// resolution shows in the mean about the peak, which is too noisy to be taken otherwise.
void choose_radius(const CountedSphere& sphere, const LargestFigure& max, const Kernel& widest,
                   FoundPeak& p) {
  RadiusChoice choice;
  choice.add(max.values, max.estimate.standard_error);
  std::vector<double> shrinks{1.0};
  const double finest = sphere.resolution_deg() / widest.radius_deg;
  while (!choice.complete() && 0.5 * shrinks.back() >= finest) {
    const double shrink = shrinks.emplace_back(0.5 * shrinks.back());
    const Kernel kernel(shrink * widest.radius_deg, shrink * widest.c_radius_deg);
    const Jackknife value = sphere.fit(p.direction, kernel).coefficients[0];
    choice.add(value, value.estimate().standard_error);
  }
  const double below_deg = 0.5 * sphere.resolution_deg();
  if (choice.size() == 1 && !choice.complete() && sphere.resolution_along_c_deg(p.direction) <= below_deg) {
    const Jackknife value = sphere.mean_cd(p.direction, Kernel(below_deg));
    choice.add(value, value.estimate().standard_error);
    shrinks.push_back(0.5 * finest);
  }
  const RadiusChoice::Choice best = choice.best();
  p.radius_deg = shrinks[best.index] * widest.radius_deg;
  p.c_radius_deg = shrinks[best.index] * widest.c_radius_deg;
  p.cd = best.estimate();
  p.values = best.values;
  p.noise_cd = max.estimate.standard_error;
}

/// The peak, then the others in the order of their brightness, as far apart as `spacing_deg`.
std::vector<Direction> bright_directions(const Direction& peak, std::vector<PointOfScan> others,
                                         double spacing_deg) {
  std::stable_sort(others.begin(), others.end(),
                   [](const PointOfScan& a, const PointOfScan& b) { return a.cd > b.cd; });
  std::vector<Direction> out{peak};
  for (const PointOfScan& p : others) {
    const bool apart = std::all_of(
        out.begin(), out.end(), [&](const Direction& o) { return apart_deg(o, p.direction) > spacing_deg; });
    if (apart) out.push_back(p.direction);
    if (out.size() == kMaxBright) break;
  }
  return out;
}

std::vector<PointOfScan> points(const Candidates& c) {
  std::vector<PointOfScan> out;
  for (std::size_t i = 0; i < c.cd.size(); ++i) out.push_back({c.direction(i), c.cd[i].all()});
  return out;
}

std::vector<PointOfScan> points(const Scan& s) {
  std::vector<PointOfScan> out;
  for (std::size_t i = 0; i < s.cd.size(); ++i) {
    if (s.cd[i] >= kCandidateShare * s.cd[s.best]) out.push_back({s.directions[i], s.cd[i]});
  }
  return out;
}

void find_bright(const CountedSphere& sphere, const Scale& s, FoundPeak& p) {
  if (std::max(p.radius_deg, p.c_radius_deg) <= kRippleRadius_deg) {
    p.bright_spacing_deg = p.radius_deg;
    p.bright = bright_directions(p.direction, points(s.candidates), p.bright_spacing_deg);
    return;
  }
  const Kernel narrow(std::min(p.radius_deg, std::max(sphere.resolution_deg(), kRippleRadius_deg)));
  p.bright_spacing_deg = std::min(p.radius_deg, 2.0 * narrow.radius_deg);
  p.bright = bright_directions(p.direction, points(scan(sphere, narrow, &s.scan)), p.bright_spacing_deg);
}

Scale scale_of(const CountedSphere& sphere, const Kernel& kernel, const LobeWidth& width, Scan scan) {
  Candidates c = candidates(sphere, scan, kernel);
  LargestFigure max = largest(c.cd);
  return {kernel, width, std::move(scan), std::move(c), std::move(max), 0.0};
}

/// From wide to narrow, until the kernel is narrow for the lobe that is the brightest then.
std::optional<Scale> widest_scale(const CountedSphere& sphere) {
  const double finest = sphere.resolution_deg();
  std::optional<Scan> s;
  LobeWidth width;
  double radius = kWidestRadius_deg;
  for (;; radius = std::max(finest, radius / std::numbers::sqrt2)) {
    s = scan(sphere, Kernel(radius), s ? &*s : nullptr);
    if (!(s->cd[s->best] > 0.0)) return std::nullopt;
    width = lobe_width(sphere, s->directions[s->best], s->cd[s->best], radius);
    if (radius <= radius_for(width)) {
      radius = radius_for(width);
      break;
    }
    if (radius <= finest) break;
  }
  const Kernel kernel(radius, radius_along_c(sphere, s->directions[s->best], radius));
  return scale_of(sphere, kernel, width, scan(sphere, kernel, &*s));
}

/// One half of a run chooses the brightest place by a kernel, the other one tells how bright that is: no more
/// than the peak but for noise, which is known.
class Halves {
 public:
  explicit Halves(const CountedSphere& sphere)
      : sphere_(sphere), flux_{sphere.half_of_flux(false), sphere.half_of_flux(true)} {}

  /// Forgets what wider kernels have shown.
  void restart() {
    scans_ = {};
    radius_deg_ = kWidestRadius_deg;
  }
  /// The mean of both ways. Kernels narrower than those before.
  Estimate brightest(const Kernel& kernel) {
    Estimate out{0.0, 0.0};
    // The narrowest lobe is as much darker as its kernel is larger.
    const double dark = kNarrowestShare * std::pow(sphere_.resolution_deg() / radius_deg_, 2.0);
    for (std::size_t half = 0; half < 2; ++half) {
      const auto mean_cd = [&](const Direction& d, const Kernel& k) {
        return sphere_.mean_cd_of(flux_[half], d, k);
      };
      std::optional<Scan>& s = scans_[half];
      s = scan(mean_cd, kernel, s ? &*s : nullptr, dark);
      const Estimate e = half_estimate(sphere_.mean_cd(place(half), kernel).values(), half == 0);
      out = {out.mean + 0.5 * e.mean, std::hypot(out.standard_error, 0.5 * e.standard_error)};
    }
    radius_deg_ = kernel.radius_deg;
    return out;
  }
  /// The top of a quadratic about the brightest places instead of kernel means.
  double top_cd(const Kernel& kernel) const {
    double sum_cd = 0.0;
    for (std::size_t half = 0; half < 2; ++half) {
      const LocalFit fit = sphere_.fit(place(half), kernel);
      double best_cd = -std::numeric_limits<double>::infinity(), other_cd = 0.0;
      for (const auto& [x, y] : stencil()) {
        const Jackknife cd = fit.at(x, y);
        const double chosen_cd = half_estimate(cd.values(), half == 1).mean;
        if (!(chosen_cd > best_cd)) continue;
        best_cd = chosen_cd;
        other_cd = half_estimate(cd.values(), half == 0).mean;
      }
      sum_cd += other_cd;
    }
    return 0.5 * sum_cd;
  }
  const Direction& place(std::size_t half) const { return scans_[half]->directions[scans_[half]->best]; }

 private:
  const CountedSphere& sphere_;
  std::array<std::vector<double>, 2> flux_;
  std::array<std::optional<Scan>, 2> scans_;
  double radius_deg_ = kWidestRadius_deg;  ///< of the kernel before
};

/// Only what is near to a place that a half has chosen, or as far from the pole where the kernel follows a
/// ring: elsewhere noise may be higher.
Scan scan_about(const CountedSphere& sphere, const Kernel& kernel, const Halves& halves) {
  Scan s = scan(sphere, kernel, nullptr);
  for (std::size_t i = 0; i < s.cd.size(); ++i) {
    const auto is_near = [&](const Direction& place) {
      if (kernel.c_radius_deg <= kernel.radius_deg)
        return apart_deg(s.directions[i], place) <= kNear * kernel.radius_deg;
      const double off = type_c_angles(s.directions[i]).gamma_rad - type_c_angles(place).gamma_rad;
      return std::abs(degrees(off)) <= kNear * kernel.radius_deg;
    };
    if (!is_near(halves.place(0)) && !is_near(halves.place(1))) s.cd[i] = -1.0;
  }
  s.best = static_cast<std::size_t>(std::max_element(s.cd.begin(), s.cd.end()) - s.cd.begin());
  return s;
}

/// `largest` chooses among the brightest of the whole run, so that what it holds back of a noisy run is not
/// quite held back. What one half finds in the other is: the midpoint of both.
void lower_to(double held_out_cd, Scale& s) {
  const double gap = s.candidates.cd[s.max.index].all() - held_out_cd;
  const double by = s.max.estimate.mean - (held_out_cd + 0.5 * gap);
  if (!(gap > 0.0 && by > 0.0)) return;
  s.max.estimate.mean -= by;
  s.max.estimate.standard_error = std::hypot(s.max.estimate.standard_error, gap / std::sqrt(12.0));
  for (double& v : s.max.values.values()) v -= by;
}

/// A lobe that is narrow beside a wider one, or an edge, is brighter than wide kernels show: the narrowest
/// scale that is brighter for certain.
Scale brightest_scale(const CountedSphere& sphere, Scale s) {
  if (sphere.replicates() < 4) return s;
  const double finest = sphere.resolution_deg();
  // Along a ring first: there is less noise.
  const Kernel widest = s.kernel;
  Halves halves(sphere);
  halves.brightest(widest);
  lower_to(halves.top_cd(widest), s);
  std::vector<double> lengths_deg{0.0};
  if (widest.c_radius_deg > kRing * widest.radius_deg)
    lengths_deg.insert(lengths_deg.begin(), widest.c_radius_deg);
  for (const double length_deg : lengths_deg) {
    halves.restart();
    for (double radius = widest.radius_deg; radius > finest;) {
      radius = std::max(finest, 0.5 * radius);
      const Kernel kernel(radius, length_deg);
      const Estimate found = halves.brightest(kernel);
      const double noise = std::hypot(found.standard_error, s.max.estimate.standard_error);
      const double excess = found.mean - s.max.estimate.mean;
      if (excess > kNoiseErrors * noise)
        s.missed_cd = std::max(s.missed_cd, std::sqrt(excess * excess - std::pow(kNoiseErrors * noise, 2.0)));
      if (!(excess > kHigherErrors * noise)) continue;
      Scan about = scan_about(sphere, kernel, halves);
      const LobeWidth width = lobe_width(sphere, about.directions[about.best], about.cd[about.best], radius);
      s = scale_of(sphere, kernel, width, std::move(about));
      lower_to(halves.top_cd(kernel), s);
    }
  }
  return s;
}

}  // namespace

std::optional<FoundPeak> peak_estimate(const CountedSphere& sphere, PeakSearch search) {
  std::optional<Scale> s = widest_scale(sphere);
  if (!s) return std::nullopt;
  FoundPeak p;
  place_peak(*s, p);
  if (search == PeakSearch::bright_directions) find_bright(sphere, *s, p);
  if (search != PeakSearch::brightest_lobe) {
    const double wide_deg = s->kernel.radius_deg;
    s = brightest_scale(sphere, std::move(*s));
    if (s->kernel.radius_deg < wide_deg) {
      place_peak(*s, p);
      if (!p.bright.empty()) p.bright.insert(p.bright.begin(), p.direction);
    }
  }
  choose_radius(sphere, s->max, s->kernel, p);
  if (s->missed_cd > 0.0) {
    p.cd.standard_error = std::hypot(p.cd.standard_error, s->missed_cd);
    p.values = p.values.with_error(p.cd.standard_error);
  }
  return p;
}

}  // namespace lucerna
