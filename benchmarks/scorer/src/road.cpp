// SPDX-License-Identifier: Apache-2.0
#include "road.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace bench {

namespace {

constexpr double kMm = 1e-3;
constexpr double kEyeMm = 1500.0, kObserverMm = 60'000.0;
/// Fields longer than this have more than 10 steps, of 3 m at most.
constexpr double kShortFieldMm = 30'000.0, kLongestStepMm = 3'000.0;
constexpr std::size_t kLeastSteps = 10;
/// Lamps nearer than this, in heights over the eye, are screened by the roof; farther ones are not seen.
constexpr double kScreened = 2.75, kFarthestLampMm = 500'000.0;
constexpr double kHalfEyeMm = 500.0;
/// Eyes look down by this.
constexpr double kSightDeg = 1.0;
/// Largest luminance coefficient, so that deposits are at most 1.
constexpr double kMostCoefficient = 100.0;
/// Glare counts between these angles from the sight.
constexpr double kLeastGlareDeg = 1.5, kMostGlareDeg = 60.0;

double interpolated(double a, double b, double share) { return (1.0 - share) * a + share * b; }

/// The interval of ascending places with x in it, and the share of the way through it.
std::pair<std::size_t, double> interval(const std::vector<double>& places, double x) {
  const auto above = std::upper_bound(places.begin() + 1, places.end() - 1, x);
  const auto i = static_cast<std::size_t>(above - places.begin()) - 1;
  return {i, (x - places[i]) / (places[i + 1] - places[i])};
}

std::vector<double> ascending(const JsonNode& n, double last) {
  const auto values = n.numbers();
  if (values.size() < 2 || values[0] != 0.0 || values.back() > last ||
      std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) != values.end())
    n.fail("ascending numbers from 0 on, two or more");
  return values;
}

}  // namespace

Road::Road(const JsonNode& t, double height_mm) : height_mm_(height_mm) {
  t.only({"kind", "place", "lanes", "lane_width_mm", "spacing_mm", "reflection", "min_overall_uniformity",
          "min_lengthwise_uniformity", "max_threshold_increment", "note"});
  if (!(height_mm_ > kEyeMm))
    t.at("place").fail("a lamp at " + std::to_string(height_mm_) + " mm", "above 1500 mm");
  lanes_ = static_cast<std::size_t>(t.at("lanes").whole(1, kMaxLanes));
  lane_mm_ = t.at("lane_width_mm").number_in(1000.0, 10'000.0);
  spacing_mm_ = t.at("spacing_mm").number_in(3000.0, 200'000.0);
  min_overall_ = t.at("min_overall_uniformity").number_in(0.0, 1.0);
  min_lengthwise_ = t.at("min_lengthwise_uniformity").number_in(0.0, 1.0);
  max_increment_ = t.at("max_threshold_increment").number_in(0.0, 10.0);
  steps_ = spacing_mm_ <= kShortFieldMm ? kLeastSteps
                                        : static_cast<std::size_t>(std::ceil(spacing_mm_ / kLongestStepMm));
  most_veil_ =
      veil(kLeastGlareDeg, 1.0) * std::hypot(1.0, (kFarthestLampMm + step_mm()) / (height_mm_ - kEyeMm));
  read_reflection(t.at("reflection"));
}

double Road::veil(double theta_deg, double lux) { return 10.0 * lux / (theta_deg * theta_deg); }

void Road::read_reflection(const JsonNode& n) {
  n.only({"tan_gamma", "beta_deg", "r_1e4", "note"});
  tan_gamma_ = ascending(n.at("tan_gamma"), 20.0);
  beta_deg_ = ascending(n.at("beta_deg"), 180.0);
  if (beta_deg_.back() != 180.0) n.at("beta_deg").fail("angles up to 180");
  for (const JsonNode& row : n.at("r_1e4").items()) {
    reduced_.push_back(row.numbers(beta_deg_.size()));
    const double to_q =
        std::pow(1.0 + std::pow(tan_gamma_[std::min(reduced_.size(), tan_gamma_.size()) - 1], 2), 1.5);
    for (double& r : reduced_.back()) {
      r *= 1e-4;
      if (!(r >= 0.0 && r * to_q <= kMostCoefficient)) row.fail("luminance coefficients from 0 to 100");
    }
  }
  if (reduced_.size() != tan_gamma_.size())
    n.at("r_1e4").fail(std::to_string(reduced_.size()) + " rows", std::to_string(tan_gamma_.size()));
}

double Road::reduced(double tan_gamma, double beta_deg) const {
  if (tan_gamma > tan_gamma_.back()) return 0.0;
  const auto [i, s] = interval(tan_gamma_, tan_gamma);
  const auto [j, b] = interval(beta_deg_, beta_deg);
  return interpolated(interpolated(reduced_[i][j], reduced_[i][j + 1], b),
                      interpolated(reduced_[i + 1][j], reduced_[i + 1][j + 1], b), s);
}

double Road::luminance_coefficient(const Vec3& at, const Vec3& d, std::size_t observer) const {
  const double along = at.x - spacing_mm_ * std::floor(at.x / spacing_mm_);
  const double view_x = kObserverMm + along;
  const double view_y = at.y - (static_cast<double>(observer) + 0.5) * lane_mm_;
  const double across = std::hypot(d.x, d.y), tan_gamma = across / -d.z;
  // Light that comes towards the observer, from a lamp ahead, has beta 0.
  const double cosine =
      across > 0.0 ? -(d.x * view_x + d.y * view_y) / (across * std::hypot(view_x, view_y)) : 1.0;
  const double beta_deg = std::acos(std::clamp(cosine, -1.0, 1.0)) / kDegree;
  return reduced(tan_gamma, beta_deg) * std::pow(1.0 + tan_gamma * tan_gamma, 1.5);
}

Deposit Road::glare(const Vec3& at, const Vec3& d) const {
  const auto lane = static_cast<std::ptrdiff_t>(std::floor(at.y / lane_mm_));
  if (lane < 0 || lane >= static_cast<std::ptrdiff_t>(lanes_)) return {};
  if (std::abs(at.y - (static_cast<double>(lane) + 0.5) * lane_mm_) > kHalfEyeMm) return {};
  // The eye is this far before the lamp, in steps beyond the nearest lamp that is seen.
  const double nearest = kScreened * (height_mm_ - kEyeMm);
  const auto k = static_cast<std::ptrdiff_t>(std::floor((-at.x - nearest) / step_mm() + 0.5));
  if (k < 0 || nearest + static_cast<double>(k) * step_mm() > kFarthestLampMm) return {};
  const Vec3 sight{std::cos(kDegree * kSightDeg), 0.0, -std::sin(kDegree * kSightDeg)};
  const double towards = -dot(d, sight), theta_deg = std::acos(std::clamp(towards, -1.0, 1.0)) / kDegree;
  if (!(theta_deg > kLeastGlareDeg && theta_deg < kMostGlareDeg)) return {};
  // Illuminance at the eye by that on the road's plane.
  const double share = veil(theta_deg, towards / -d.z) / most_veil_;
  const auto steps = static_cast<std::ptrdiff_t>(steps_);
  const auto place = (steps - k % steps) % steps;
  return {static_cast<int>(field_sums()) + static_cast<int>(lane * steps + place), share};
}

bool Road::land(const Vec3& o, const Vec3& d, Deposits& deposits) const {
  if (!(d.z < 0.0)) return false;
  const auto at_level = [&](double z) { return o + ((z - o.z) / d.z) * d; };
  deposits[0] = glare(at_level(kEyeMm), d);
  const Vec3 at = at_level(0.0);
  if (!(at.y >= 0.0 && at.y < width_mm())) return false;
  const auto rows = kAcross * lanes_;
  const auto row =
      std::min(rows - 1, static_cast<std::size_t>(at.y / width_mm() * static_cast<double>(rows)));
  const double along = at.x / spacing_mm_ - std::floor(at.x / spacing_mm_);
  const auto step = std::min(steps_ - 1, static_cast<std::size_t>(along * static_cast<double>(steps_)));
  for (std::size_t observer = 0; observer < lanes_; ++observer) {
    const double q = luminance_coefficient(at, d, observer);
    deposits[observer + 1] = {static_cast<int>((observer * rows + row) * steps_ + step),
                              q / kMostCoefficient};
  }
  return true;
}

Road::Figures Road::figures(const std::vector<double>& shares) const {
  const std::size_t rows = kAcross * lanes_, field = rows * steps_;
  const double cell_m2 = kMm * step_mm() * kMm * lane_mm_ / kAcross,
               eye_m2 = kMm * step_mm() * 2.0 * kMm * kHalfEyeMm;
  Figures out;
  out.overall = out.lengthwise = 1.0;
  double darkest = 0.0;
  for (std::size_t observer = 0; observer < lanes_; ++observer) {
    const auto first = shares.begin() + static_cast<std::ptrdiff_t>(observer * field);
    double sum = 0.0;
    for (std::size_t k = 0; k < field; ++k) sum += first[static_cast<std::ptrdiff_t>(k)];
    const double mean = sum / static_cast<double>(field);
    if (!(mean > 0.0)) return {};
    const auto middle = first + static_cast<std::ptrdiff_t>((kAcross * observer + 1) * steps_);
    const auto [low, high] = std::minmax_element(middle, middle + static_cast<std::ptrdiff_t>(steps_));
    out.overall =
        std::min(out.overall, *std::min_element(first, first + static_cast<std::ptrdiff_t>(field)) / mean);
    out.lengthwise = std::min(out.lengthwise, *high > 0.0 ? *low / *high : 0.0);
    const double luminance = mean * kMostCoefficient / cell_m2;
    darkest = observer == 0 ? luminance : std::min(darkest, luminance);
  }
  out.lm_per_cd_m2 = 1.0 / darkest;
  const double veil =
      *std::max_element(shares.begin() + static_cast<std::ptrdiff_t>(field_sums()), shares.end());
  // TI = 65 Lv / L^0.8 %, with lamps as bright as make L = 1 cd/m2.
  out.threshold_increment = 0.65 * veil * most_veil_ / eye_m2 / darkest;
  return out;
}

RoadScore Road::score(const std::vector<std::vector<double>>& by_replicate) const {
  const auto count = by_replicate.size();
  std::vector<double> all(sums(), 0.0);
  for (const auto& shares : by_replicate) {
    for (std::size_t k = 0; k < all.size(); ++k) all[k] += shares[k] / static_cast<double>(count);
  }
  const Figures whole = figures(all);
  // The jackknife: figures without one of the replicates.
  std::vector<Figures> without;
  for (const auto& shares : by_replicate) {
    std::vector<double> rest = all;
    for (std::size_t k = 0; k < all.size(); ++k)
      rest[k] += (all[k] - shares[k]) / (static_cast<double>(count) - 1.0);
    without.push_back(figures(rest));
  }
  const auto estimate = [&](double Figures::*figure) {
    double mean = 0.0, squares = 0.0;
    for (const Figures& f : without) mean += f.*figure / static_cast<double>(count);
    for (const Figures& f : without) squares += (f.*figure - mean) * (f.*figure - mean);
    const double n = static_cast<double>(count);
    return Estimate{whole.*figure, std::sqrt((n - 1.0) / n * squares)};
  };
  return {estimate(&Figures::lm_per_cd_m2), estimate(&Figures::overall), estimate(&Figures::lengthwise),
          estimate(&Figures::threshold_increment)};
}

}  // namespace bench
