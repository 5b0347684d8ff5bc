// SPDX-License-Identifier: Apache-2.0
#include "lucerna/bounding_surface.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr std::array<std::string_view, 5> kSurfaceNames{"none", "plane", "sphere", "cylinder", "box"};

}  // namespace

std::string_view to_string(SurfaceKind kind) { return kSurfaceNames[static_cast<std::size_t>(kind)]; }

SurfaceKind surface_kind(std::string_view name) {
  const auto found = std::find(kSurfaceNames.begin(), kSurfaceNames.end(), name);
  if (found == kSurfaceNames.end()) {
    throw UsageError(fmt::format("unknown surface '{}'; expected {}", name, fmt::join(kSurfaceNames, ", ")));
  }
  return static_cast<SurfaceKind>(found - kSurfaceNames.begin());
}

BoundingSurface BoundingSurface::plane(double z_mm) {
  return {SurfaceKind::plane, Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, z_mm}), 0.0, {}};
}
BoundingSurface BoundingSurface::sphere(double radius_mm) { return {SurfaceKind::sphere, {}, radius_mm, {}}; }
BoundingSurface BoundingSurface::cylinder(double radius_mm, double length_mm) {
  return {SurfaceKind::cylinder, {}, radius_mm, {radius_mm, radius_mm, 0.5 * length_mm}};
}
BoundingSurface BoundingSurface::box(const Vec3& size_mm) {
  return {SurfaceKind::box, {}, 0.0, 0.5 * size_mm};
}

BoundingSurface BoundingSurface::from_sizes(SurfaceKind kind, std::span<const double> mm) {
  constexpr std::array<std::size_t, 5> kCounts{0, 1, 1, 2, 3};
  const std::size_t expected = kCounts[static_cast<std::size_t>(kind)];
  if (mm.size() != expected) {
    throw InputError(
        fmt::format("a {} surface takes {} number(s), found {}", to_string(kind), expected, mm.size()));
  }
  for (const double value : mm) {
    if (kind != SurfaceKind::plane && !(value > 0.0)) {
      throw InputError(fmt::format("a {} surface of size {}, expected > 0", to_string(kind), value));
    }
  }
  switch (kind) {
    case SurfaceKind::none:
      return {};
    case SurfaceKind::plane:
      return plane(mm[0]);
    case SurfaceKind::sphere:
      return sphere(mm[0]);
    case SurfaceKind::cylinder:
      return cylinder(mm[0], mm[1]);
    case SurfaceKind::box:
      return box({mm[0], mm[1], mm[2]});
  }
  return {};
}

double BoundingSurface::outside_mm(const Vec3& point_mm) const {
  const Vec3 p = world_from_surface.inverse().point(point_mm);
  switch (kind) {
    case SurfaceKind::none:
      return 0.0;
    case SurfaceKind::plane:
      return p.z;
    case SurfaceKind::sphere:
      return length(p) - radius_mm;
    case SurfaceKind::cylinder:
      return std::max(std::hypot(p.x, p.y) - radius_mm, std::abs(p.z) - half_size_mm.z);
    case SurfaceKind::box:
      return std::max(
          {std::abs(p.x) - half_size_mm.x, std::abs(p.y) - half_size_mm.y, std::abs(p.z) - half_size_mm.z});
  }
  return 0.0;
}

}  // namespace lucerna
