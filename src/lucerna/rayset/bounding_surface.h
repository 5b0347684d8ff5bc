// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "lucerna/core/frame.h"

namespace lucerna {

enum class SurfaceKind { none, plane, sphere, cylinder, box };

/// "none", "plane", "sphere", "cylinder", "box"; the second throws UsageError on anything else.
std::string_view to_string(SurfaceKind kind);
SurfaceKind surface_kind(std::string_view name);

/// The convex surface that the starts of a ray set lie on, wrapped round its source. Immutable, thread safe.
struct BoundingSurface {
  SurfaceKind kind = SurfaceKind::none;
  /// Places the surface: plane z = 0 of the frame (light goes to +z), sphere about its origin, cylinder about
  /// its z axis and closed by discs at +-half its length, box about its origin.
  Frame world_from_surface;
  /// Sphere, cylinder.
  double radius_mm = 0.0;
  /// Half the edges of a box; z is also half the length of a cylinder.
  Vec3 half_size_mm;

  static BoundingSurface plane(double z_mm);
  static BoundingSurface sphere(double radius_mm);
  static BoundingSurface cylinder(double radius_mm, double length_mm);
  static BoundingSurface box(const Vec3& size_mm);

  /// The same from the numbers that users give: plane Z, sphere RADIUS, cylinder RADIUS LENGTH, box X Y Z,
  /// none nothing. Throws InputError for another count of numbers or sizes that are not > 0.
  static BoundingSurface from_sizes(SurfaceKind kind, std::span<const double> mm);

  /// Signed distance-like measure of a point in mm: < 0 inside (below the plane), 0 on it, > 0 outside; exact
  /// distance on faces. 0 everywhere for `none`.
  double outside_mm(const Vec3& point_mm) const;

  /// Distance along the ray to where its line last leaves the body (for a plane: crosses towards +z); may be
  /// negative when that lies behind the start. Nothing when the line misses it, or for `none`. A ray that
  /// starts inside has exactly one such point ahead of it: where it belongs on the surface.
  std::optional<double> exit_distance_mm(const Ray& ray) const;
};

}  // namespace lucerna
