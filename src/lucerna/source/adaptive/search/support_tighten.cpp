// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/search/support_tighten.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lucerna {

namespace {

/// Rounding of lines' numbers must not put the outermost line beside the support.
constexpr double kRelativeTolerance = 1e-6;

/// The smallest value that all but `missed` of the values do not exceed.
double all_but(std::vector<double>& values, double missed) {
  const auto beyond = static_cast<std::size_t>(missed * static_cast<double>(values.size()));
  const auto at = values.end() - 1 - static_cast<std::ptrdiff_t>(std::min(beyond, values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Distance of the line from the z axis, at most `half_mm` from the origin along it.
double distance_from_axis(const Ray& r, double half_mm) {
  const Vec3 &o = r.origin_mm, &d = r.direction.vec();
  const double across2 = d.x * d.x + d.y * d.y;
  double t = across2 > 0.0 ? -(o.x * d.x + o.y * d.y) / across2 : 0.0;
  if (d.z != 0.0) {
    const double low = (-half_mm - o.z) / d.z, high = (half_mm - o.z) / d.z;
    t = std::clamp(t, std::min(low, high), std::max(low, high));
  }
  return std::hypot(o.x + t * d.x, o.y + t * d.y);
}

/// Where the line is inside a cylinder about z without ends, from its lowest to its highest z.
std::optional<std::array<double, 2>> inside_lateral(const Ray& r, double radius_mm) {
  const Vec3 &o = r.origin_mm, &d = r.direction.vec();
  const double a = d.x * d.x + d.y * d.y, b = o.x * d.x + o.y * d.y;
  const double c = o.x * o.x + o.y * o.y - radius_mm * radius_mm;
  const double q = b * b - a * c;
  if (!(a > 0.0) || !(q >= 0.0)) return std::nullopt;
  const double z = o.z - b / a * d.z, reach = std::sqrt(q) / a * std::abs(d.z);
  return std::array<double, 2>{z - reach, z + reach};
}

std::optional<Support> tight_cylinder(const Support& support, const RayBlock& rays, double missed) {
  const Frame support_from_world = support.world_from_support.inverse();
  std::vector<Ray> local;
  std::vector<double> distance;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(rays.weight[i] > 0.0f)) continue;
    local.push_back(support_from_world.ray(rays.ray(i)));
    distance.push_back(distance_from_axis(local.back(), support.half_size_mm.z));
  }
  if (distance.empty()) return std::nullopt;
  Support s = support;
  s.radius_mm = (1.0 + kRelativeTolerance) * all_but(distance, missed);
  // A line hits the cylinder if it enters the lateral surface below the upper end and leaves it above the
  // lower one.
  std::vector<double> enters, leaves;
  for (const Ray& ray : local) {
    const auto z = inside_lateral(ray, s.radius_mm);
    if (!z) continue;
    enters.push_back((*z)[0]);
    leaves.push_back(-(*z)[1]);
  }
  if (enters.empty()) return std::nullopt;
  const double top = all_but(enters, missed), bottom = -all_but(leaves, missed);
  const double half = 0.5 * (1.0 + kRelativeTolerance) * (top - bottom);
  if (!(half > 0.0 && s.radius_mm > 0.0)) return std::nullopt;
  const Frame& f = support.world_from_support;
  s.half_size_mm = {s.radius_mm, s.radius_mm, half};
  s.world_from_support = {f.ex(), f.ey(), f.ez(), f.origin_mm() + 0.5 * (top + bottom) * f.ez()};
  return s;
}

}  // namespace

std::optional<Support> tightened(const Support& support, const RayBlock& rays, double missed) {
  if (support.kind == SupportKind::cylinder) return tight_cylinder(support, rays, missed);
  if (support.kind != SupportKind::sphere) return std::nullopt;
  std::vector<double> distance;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(rays.weight[i] > 0.0f)) continue;
    const Vec3 o = rays.origin_mm(i) - support.world_from_support.origin_mm();
    distance.push_back(length(cross(o, rays.direction(i).vec())));
  }
  if (distance.empty()) return std::nullopt;
  Support s = support;
  s.radius_mm = (1.0 + kRelativeTolerance) * all_but(distance, missed);
  return s.radius_mm > 0.0 ? std::optional(s) : std::nullopt;
}

}  // namespace lucerna
