// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/initial/zero_etendue.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lucerna/design/initial/supporting_paraboloids.h"

namespace lucerna {

namespace {

constexpr double kPi = std::numbers::pi;

/// A cumulative share of flux over an angle in [-pi, pi], as a table.
class Cumulative {
 public:
  static constexpr int kSteps = 3600;

  template <class Angle>
  Cumulative(std::span<const DirectedFlux> light, const Angle& angle) : share_(kSteps + 1, 0.0) {
    for (const DirectedFlux& l : light) {
      const int bin = std::clamp(static_cast<int>(place(angle(l.direction))), 0, kSteps - 1);
      share_[static_cast<std::size_t>(bin) + 1] += l.flux;
    }
    for (std::size_t i = 1; i < share_.size(); ++i) share_[i] += share_[i - 1];
  }

  double total() const { return share_.back(); }
  double below(double angle) const {
    const double s = std::clamp(place(angle), 0.0, static_cast<double>(kSteps));
    const auto i = std::min(static_cast<std::size_t>(s), share_.size() - 2);
    return share_[i] + (s - static_cast<double>(i)) * (share_[i + 1] - share_[i]);
  }
  double angle_of(double flux) const {
    auto at = std::lower_bound(share_.begin(), share_.end(), flux);
    if (at == share_.begin()) at = std::upper_bound(share_.begin(), share_.end(), 0.0);  // the first light
    if (at == share_.end()) --at;
    const auto i = static_cast<double>(at - share_.begin());
    const double step = std::max(1e-300, *at - *(at - 1));
    return 2.0 * kPi / kSteps * (i - std::clamp((*at - flux) / step, 0.0, 1.0)) - kPi;
  }

 private:
  static double place(double angle) { return (angle / kPi + 1.0) * 0.5 * kSteps; }

  std::vector<double> share_;
};

struct Balance {
  bool outward;  ///< the middle of the mirror lights the middle of the target
  double side;   ///< +1: rays leave away from the axis, -1: they cross it
};

/// A profile in polar coordinates about the source: points (r, z) from the vertex on.
using ProfilePoints = std::vector<std::array<double, 2>>;

/// Integrates the profile whose flux up to `rim` makes the prescribed light; goes on beyond with the last
/// angle.
ProfilePoints integrate(const Balance& way, const Cumulative& source, const Cumulative& target_flux,
                        double hole, double rim, double distance_mm, double source_z_mm) {
  constexpr int kPoints = 1500;
  const double from = source.below(hole), all = source.below(rim) - from;
  const auto gamma = [&](double theta) {
    const double share = std::clamp((source.below(theta) - from) / all, 0.0, 1.0);
    return way.side * target_flux.angle_of((way.outward ? share : 1.0 - share) * target_flux.total());
  };
  ProfilePoints points;
  double log_rho = std::log(distance_mm);
  const double step = 1.15 * rim / kPoints;
  for (int i = 0; i <= kPoints; ++i) {
    const double theta = i * step, rho = std::exp(log_rho);
    points.push_back({rho * std::sin(theta), source_z_mm - rho * std::cos(theta)});
    const double middle = theta + 0.5 * step;
    const double half = 0.5 * (middle + gamma(std::clamp(middle, hole, rim)));
    if (!(std::abs(half) < 0.48 * kPi) || points.back()[0] > 1e6) break;
    log_rho += step * std::tan(half);
  }
  return points;
}

/// Height at a radius, straight beyond the last point; nothing if the radius does not grow along the profile.
std::optional<std::function<double(double)>> height_of(ProfilePoints points, double radius) {
  std::size_t n = 1;
  while (n < points.size() && points[n][0] > points[n - 1][0]) ++n;
  points.resize(n);
  if (n < 3 || points.back()[0] < radius) return std::nullopt;
  const double vertex = points[0][1];
  return [points, vertex](double r) {
    const auto after = std::lower_bound(points.begin() + 1, points.end() - 1, r,
                                        [](const std::array<double, 2>& p, double x) { return p[0] < x; });
    const auto& [r1, z1] = *after;
    const auto& [r0, z0] = *(after - 1);
    return z0 + (r - r0) / (r1 - r0) * (z1 - z0) - vertex;
  };
}

std::vector<DesignShape> flux_balance(const DesignShape& family, const PointSource& source,
                                      std::span<const DirectedFlux> light) {
  const double distance = source.at_mm.z - family.at(0.0, 0.0).z_mm;
  if (!(distance > 0.0)) return {};
  const Direction axis;
  const Cumulative from_source(source.light,
                               [&](const Direction& d) { return kPi - angle_between(d, axis); });
  const Cumulative target_flux(light, [&](const Direction& d) { return angle_between(d, axis); });
  const double radius = family.aperture().outer_radius_mm();
  const double hole = std::atan2(family.aperture().hole_radius_mm(), distance);
  std::vector<DesignShape> shapes;
  for (const Balance way :
       {Balance{true, 1.0}, Balance{true, -1.0}, Balance{false, 1.0}, Balance{false, -1.0}}) {
    // The rim is where the profile that ends there has the aperture's radius.
    double low = hole + 0.05, high = kPi - 0.05;
    for (int i = 0; i < 40; ++i) {
      const double rim = 0.5 * (low + high);
      const ProfilePoints p = integrate(way, from_source, target_flux, hole, rim, distance, source.at_mm.z);
      double reached = 0.0;  // the radius at the rim itself
      const auto at = static_cast<std::size_t>(static_cast<double>(1500) / 1.15);
      if (p.size() > at) reached = p[at][0];
      (p.size() <= at || reached > radius ? high : low) = rim;
    }
    const auto height =
        height_of(integrate(way, from_source, target_flux, hole, low, distance, source.at_mm.z), radius);
    if (!height) continue;
    const double vertex = family.at(0.0, 0.0).z_mm;
    shapes.push_back(
        family.through([&](double x, double y) { return vertex + (*height)(std::hypot(x, y)); }));
  }
  return shapes;
}

/// Angle of a direction seen along y: 0 along +z, positive towards +x.
double seen_along_y(const Direction& d) { return std::atan2(d.x(), d.z()); }

/// One side of a trough's profile: polar radius by the angle from the vertex, as `integrate` makes it, with
/// gamma(theta) given.
template <class Gamma>
ProfilePoints trough_side(const Gamma& gamma, double side, double half_x, double distance_mm, double source_x,
                          double source_z, double& rim) {
  constexpr double kStep = 1e-3;
  ProfilePoints points;
  double log_rho = std::log(distance_mm);
  for (double theta = 0.0; theta < kPi - 0.05; theta += kStep) {
    const double rho = std::exp(log_rho), x = source_x + side * rho * std::sin(theta);
    points.push_back({side * x, source_z - rho * std::cos(theta)});
    if (side * x < half_x) rim = theta;
    if (side * x > 1.3 * half_x) break;
    const double half = 0.5 * (theta + 0.5 * kStep + side * gamma(side * (theta + 0.5 * kStep)));
    if (!(std::abs(half) < 0.48 * kPi)) break;
    log_rho += kStep * std::tan(half);
  }
  return points;
}

}  // namespace

std::optional<DesignShape> trough_balance(const DesignShape& family, const PointSource& source,
                                          std::span<const DirectedFlux> light, double distance_mm,
                                          bool same_order) {
  const double vertex = source.at_mm.z - distance_mm;
  const Cumulative from_source(source.light, [](const Direction& d) { return std::atan2(d.x(), -d.z()); });
  const Cumulative target_flux(light, [](const Direction& d) { return seen_along_y(d); });
  const double half_x = family.aperture().half_x_mm();
  double left = -1.0, right = 1.0;  // angles of the rims, from the vertex; found by iteration
  ProfilePoints minus, plus;
  for (int round = 0; round < 12; ++round) {
    const double begin = from_source.below(left), all = from_source.below(right) - begin;
    if (!(all > 0.0)) return std::nullopt;
    const auto gamma = [&](double theta) {
      const double share = std::clamp((from_source.below(theta) - begin) / all, 0.0, 1.0);
      return target_flux.angle_of((same_order ? share : 1.0 - share) * target_flux.total());
    };
    double to_left = 0.05, to_right = 0.05;
    minus = trough_side(gamma, -1.0, half_x, distance_mm, source.at_mm.x, source.at_mm.z, to_left);
    plus = trough_side(gamma, 1.0, half_x, distance_mm, source.at_mm.x, source.at_mm.z, to_right);
    left = 0.5 * (left - to_left);
    right = 0.5 * (right + to_right);
  }
  const auto on_minus = height_of(minus, half_x), on_plus = height_of(plus, half_x);
  if (!on_minus || !on_plus) return std::nullopt;
  return family.through(
      [&](double x, double) { return vertex + (x < 0.0 ? (*on_minus)(-x) : (*on_plus)(x)); });
}

namespace {

std::vector<DesignShape> trough_balances(const DesignShape& family, const PointSource& source,
                                         std::span<const DirectedFlux> light) {
  const double distance = source.at_mm.z - family.at(0.0, 0.0).z_mm;
  std::vector<DesignShape> shapes;
  for (const bool same_order : {true, false}) {
    if (!(distance > 0.0)) break;
    if (const auto shape = trough_balance(family, source, light, distance, same_order))
      shapes.push_back(*shape);
  }
  return shapes;
}

}  // namespace

std::vector<DesignShape> zero_etendue_shapes(const DesignShape& family, const PointSource& source,
                                             std::span<const DirectedFlux> target_flux, double blur_rad) {
  double total = 0.0;
  for (const DirectedFlux& l : target_flux) total += l.flux;
  if (!(total > 0.0)) return {};
  if (family.is_revolution()) return flux_balance(family, source, target_flux);
  if (family.is_trough()) return trough_balances(family, source, target_flux);
  return supporting_paraboloids(family, source, target_flux, blur_rad);
}

}  // namespace lucerna
