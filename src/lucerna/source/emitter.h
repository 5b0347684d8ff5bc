// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "lucerna/rayset/bounding_surface.h"
#include "lucerna/source/ray_source.h"

namespace lucerna {

/// Analytic sources, exactly known: to make ray sets, to trace without a file, and to measure models against.
///
/// - point: the origin; isotropic.
/// - disk (radius), rectangle (size): in z = 0; Lambertian to +z.
/// - cylinder (radius, length; mantle about z, no ends), sphere (radius): Lambertian outward.
/// - filament: wire of radius 0.06 mm coiled 12 times about x, coil radius and length; Lambertian, windings
///   do not shade each other. A share of `ghost_share` leaves from the coil's inverted image, as a concentric
///   bulb reflects it.
/// - led: four 1 mm dies 0.1 mm apart in z = 0, of relative luminance 1, 0.95, 1.05, 1; 1 % of the flux from
///   the package, a disk of radius 2.5 mm. Lambertian to +z.
/// - phong500: uniform on the sphere; Phong lobe of exponent 500 about the outward normal.
/// - phong25: uniform on the sphere; exponent 25, times a pattern over the direction's angle to z: six bands
///   of equal solid angle, alternately 1 and 0.25, which makes three bright bands.
/// - radial: on the sphere, with a positional pattern; along the outward normal (no étendue).
/// - cosine: on the sphere, with the same pattern; Lambertian outward.
///
/// The positional pattern is a checker of 16 sectors of azimuth by 8 bands of equal area, alternately 1 and
/// 0.25. The last four are the synthetic sets of Mas et al. (docs/algorithms/clusters.md); their patterns are
/// ours.
enum class EmitterKind {
  point,
  disk,
  rectangle,
  cylinder,
  sphere,
  filament,
  led,
  phong500,
  phong25,
  radial,
  cosine
};

/// The names above; `emitter_kind` throws UsageError with the list on anything else.
std::string_view to_string(EmitterKind kind);
EmitterKind emitter_kind(std::string_view name);

struct EmitterOptions {
  EmitterKind kind = EmitterKind::point;
  /// Disk, cylinder, sphere, filament (coil), and the sphere of the seed's sets; > 0. Absent: 1, but filament
  /// 0.6, seed's sets 10.
  std::optional<double> radius_mm;
  /// Cylinder, filament; > 0. Absent: 6, filament 8.
  std::optional<double> length_mm;
  /// Rectangle; > 0.
  std::array<double, 2> size_mm{1.0, 1.0};
  /// Filament: share of the flux in the image, [0, 1).
  double ghost_share = 0.05;
  double flux = 1000.0;
  FluxUnit flux_unit = FluxUnit::lumen;
  /// Rays are slid forward to this surface, which must enclose the emitter (or lie above it). Absent: led a
  /// sphere of 3 mm, filament a sphere of 20 mm, else none: rays start where they are emitted.
  std::optional<BoundingSurface> surface;
};

/// The emitter. Throws InputError for sizes or fluxes out of range, or a surface that the emitter does not
/// fit in. A ray takes five numbers of the sequence: 0, 1 direction; 2, 3 position; 4 which part. Cost: about
/// 0.1 us a ray.
std::unique_ptr<RaySource> make_emitter(const EmitterOptions& options);

/// The surface that `options` asks for or its kind has by default.
BoundingSurface emission_surface(const EmitterOptions& options);

}  // namespace lucerna
