// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "lucerna/bounding_surface.h"
#include "lucerna/geometry.h"
#include "lucerna/source/adaptive/charts/refracting_sphere.h"

namespace lucerna {

/// Where the rays of a layer are written down: a way of giving every line of light four numbers whose volume
/// is étendue (mm^2 sr), or a constant multiple of it where the source is seen through a dome. Density in
/// these numbers is radiance, so a leaf of constant density is a piece of constant radiance.
///
/// | kind     | charts | position (0, 1) | direction (2, 3) |
/// |----------|--------|-----------------|------------------|
/// | plane    | 2: light to +z, light to -z | x, y where the line crosses z = 0 | about the normal |
/// | sphere   | 1 | z, R azimuth where the line leaves it | about the normal |
/// | cylinder | 3: side, top, bottom | R azimuth (less the twist), z; r^2/2, azimuth | about the normal |
/// | box      | 6: +x -x +y -y +z -z | the two other coordinates in cyclic order | about the normal |
/// | focal    | 1 | where the line passes the origin, across it | cosine to z, azimuth |
/// | axis     | 1 | z of the point nearest to the z axis, signed distance | area function of the angle to z,
/// azimuth (less the twist) |
/// | disk     | 2, as plane | r^2/2, azimuth where the line crosses z = 0 | about the normal |
///
/// Directions about a normal are (sin^2/2, azimuth) for `polar` and the concentric square of the unit disk
/// for `concentric`, the projected solid angle either way. A focal support with `polar` has p^2/2 and azimuth
/// for the position. docs/theory/source-model.md derives the measures.
enum class SupportKind : std::uint8_t { plane, sphere, cylinder, box, focal, axis, disk };
inline constexpr std::size_t kSupportKinds = 7;
enum class PolarMap : std::uint8_t { polar, concentric };

std::string_view to_string(SupportKind kind);

/// Four numbers of a line, and which chart they are in.
struct ChartPoint {
  std::uint32_t chart = 0;
  std::array<double, 4> c{};
};

/// Lengths in mm in `world_from_support`'s inner frame. Immutable, thread safe.
struct Support {
  SupportKind kind = SupportKind::focal;
  PolarMap map = PolarMap::concentric;
  Frame world_from_support;
  /// Sphere, cylinder; else 0.
  double radius_mm = 0.0;
  /// Box; z is half the length of a cylinder.
  Vec3 half_size_mm;
  /// Cylinder, axis: azimuth is counted from a line that turns by so much per mm along z (a coil's wires).
  double twist_per_mm = 0.0;
  /// Where there is one, lines are written down as they run inside this ball, in the world's frame: the
  /// numbers' volume is then étendue inside it.
  RefractingSphere dome;

  std::uint32_t charts() const;
  /// Largest range that coordinate `d` of `chart` can take; +-1e30 where only the data bound it.
  std::array<double, 2> range(std::uint32_t chart, std::size_t d) const;

  /// The numbers of a ray's line; nothing if the line misses the support, or runs along it.
  std::optional<ChartPoint> to_chart(const Ray& world) const;
  /// The inverse: the ray of that line that starts on the support (focal: beside the origin; axis: at its
  /// nearest point; with a dome: on the dome). Azimuths may be given beyond their range.
  Ray from_chart(const ChartPoint& p) const;

  /// Étendue outside for one unit of the numbers' volume: 1, or the square of the dome's index.
  double etendue_ratio() const { return dome.etendue_ratio(); }

  friend bool operator==(const Support&, const Support&) = default;
};

/// The support that is the bounding surface itself; nothing for `none`.
std::optional<Support> support_on(const BoundingSurface& surface, PolarMap map);

/// The start of the ray's line on `surface`: where the line leaves it, ahead or behind. Lines that miss it
/// are first moved towards its centre until they touch (models blur by a leaf's width, so a few do). Lines
/// away from a plane's light side start where they cross it. `none` leaves the ray as it is.
Ray start_on(const BoundingSurface& surface, const Ray& ray);

}  // namespace lucerna
