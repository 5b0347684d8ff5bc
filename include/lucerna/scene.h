// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/detectors.h"
#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/material.h"
#include "lucerna/mesh.h"
#include "lucerna/rays.h"
#include "lucerna/reflector.h"
#include "lucerna/scatter.h"
#include "lucerna/source.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// One entry of a table of reflectance over the angle of incidence.
struct ReflectanceEntry {
  /// From the normal, [0, 90].
  double incidence_deg = 0.0;
  /// Reflectance there, [0, 1].
  double value = 0.0;
};

/// The table's value at `cos_incidence` in [0, 1]; at least one entry.
LUCERNA_HD inline double reflectance_at(const ReflectanceEntry* table, std::size_t n, double cos_incidence) {
  if (n == 1) return table[0].value;
  const double cosine = cos_incidence < 0.0 ? 0.0 : cos_incidence > 1.0 ? 1.0 : cos_incidence;
  const double angle = degrees(std::acos(cosine));
  std::size_t after = 0;
  while (after < n && !(angle < table[after].incidence_deg)) ++after;
  if (after == 0) return table[0].value;
  const ReflectanceEntry& a = table[after - 1];
  if (after == n) return a.value;
  const ReflectanceEntry& b = table[after];
  return a.value + (b.value - a.value) * (angle - a.incidence_deg) / (b.incidence_deg - a.incidence_deg);
}

/// The share of light that a mirror returns: a number, or a table over the angle of incidence, linear in the
/// angle between its entries and constant beyond them. Thread safe.
class Reflectance {
 public:
  /// The same at every angle. Throws InputError unless it is in [0, 1].
  explicit Reflectance(double value);

  /// An entry of the table.
  using Entry = ReflectanceEntry;
  /// Throws InputError unless angles ascend within [0, 90] and values are in [0, 1]; at least one entry.
  explicit Reflectance(std::vector<Entry> table);

  /// `cos_incidence` in [0, 1].
  double at(double cos_incidence) const {
    return reflectance_at(table_.data(), table_.size(), cos_incidence);
  }
  /// The largest value at any angle.
  double max() const;
  /// The same over the angle with `change` added to every value, within [0, 1].
  [[nodiscard]] Reflectance shifted(double change) const;
  /// True if it does not depend on the angle.
  bool is_constant() const { return table_.size() == 1; }
  /// Its entries; one for a constant.
  const std::vector<Entry>& table() const { return table_; }

 private:
  std::vector<Entry> table_;
};

/// Of a smooth metal in air at one wavelength: a table over the angle by Fresnel's formulas, within 0.001.
/// `material` is one of the metals of `materials()`. Throws InputError as `refractive_index`, and for a clear
/// medium.
[[nodiscard]] Reflectance metal_reflectance(std::string_view material, double wavelength_nm = 555.0);

/// Something that is no height field: housing, shield, the lamp's own body; absorbs, or is a mirror on both
/// sides.
struct Body {
  /// The cause in the ledger.
  std::string name = "body";
  /// Its triangles, in its own frame; not null.
  std::shared_ptr<const Mesh> mesh;
  /// Where it is in the luminaire frame.
  Frame world_from_body;
  /// 0 absorbs everything.
  Reflectance reflectance{0.0};
  /// True for the lamp's own body: rays of a lamp's file already left it, so it only meets light that comes
  /// back from a mirror or another body; else its shadow would be counted twice.
  bool only_returning_light = false;
  /// > 0: a mirror's normal changes steadily across triangles that meet at less than this angle
  /// (`corner_normals`); 0: every triangle is flat.
  double smooth_below_deg = 0.0;
  /// As PlacedReflector::slope_error_mrad, on both sides.
  double slope_error_mrad = 0.0;
  /// As PlacedReflector::scatter, on both sides.
  Scatter scatter;
};

/// Throws InputError unless the body has triangles, 0 <= smooth_below_deg <= 180 and 0 <= slope_error_mrad <=
/// 1000.
void check(const Body& body);

/// A flat cover glass: a plane-parallel plate that fills 0 <= z <= thickness_mm of its own frame, within a
/// circle or a rectangle about the z axis. Both faces reflect and refract by Fresnel's formulas for
/// unpolarised light; all reflections between the faces are summed (incoherent light), with what the glass
/// absorbs on the way. Light that is let through keeps its direction and leaves beside the line it came on.
/// The rim is black: light that enters or leaves through it is absorbed. Light that starts inside the plate
/// is not touched.
///
/// A ray is not split: one random number of the ray's own stream says whether it is reflected or let through,
/// a second how often it went to and fro (the light is taken as unpolarised again afterwards); what the plate
/// absorbs is taken off its flux under the cause `name`. Being let through is no reflection: it counts
/// neither towards TraceOptions::max_bounces nor makes direct light reflected light in the ledger.
struct CoverGlass {
  /// The cause in the ledger.
  std::string name = "glass";
  /// No hole.
  Aperture aperture = Aperture::circle(100.0);
  /// > 0.
  double thickness_mm = 3.0;
  /// 1 to 4. The default is soda-lime float glass in the visible.
  double refractive_index = 1.52;
  /// Natural absorption coefficient >= 0: a path of x mm leaves exp(-x * absorption_per_mm).
  double absorption_per_mm = 0.0;
  /// Where it is in the luminaire frame.
  Frame world_from_glass;
};

/// Throws InputError naming the number that is out of its range.
void check(const CoverGlass& glass);

/// A closed body of a clear medium: a lens, a TIR collimator, a light guide. Light refracts and reflects at
/// its surface by Snell's law and Fresnel's formulas for unpolarised light, totally where these say so, and
/// is absorbed on its way within. Outside is air. Light may start inside. It is unpolarised where it enters
/// and keeps its polarisation until it leaves; the phases of total reflection are left out.
///
/// A ray is not split: at every boundary one random number of its own stream says whether it is reflected or
/// refracted, with weight 1. What the medium absorbs is taken off its flux under the cause `name`. A ray that
/// has met the surface 1000 times without leaving is lost, as by TraceOptions::max_bounces. Reflections
/// inside do not count towards that limit, and make no reflected light of direct light; those outside do.
///
/// Solids must be apart from each other, from bodies and from mirrors: `trace` checks it.
struct Solid {
  /// The cause in the ledger.
  std::string name = "solid";
  /// Its surface as triangles, in its own frame: closed, all triangles turned the same way. Null for an
  /// outline.
  std::shared_ptr<const Mesh> mesh;
  /// Its surface as an outline that turns about the z axis of its own frame: corners (r, z) of a closed
  /// polygon, at least three, r >= 0, whichever way it runs; a side along the axis makes no surface. Empty
  /// for a mesh.
  std::vector<std::array<double, 2>> outline_mm;
  /// Not null: the top of the body, z = face->at(x, y).z_mm in the body's own frame, which looks to +z. Then
  /// `outline_mm` is open: corners from the axis to the upper end of a wall, so that the last two have the
  /// same radius R > 0 and the last one is higher. The face covers x^2 + y^2 <= R^2, and the wall begins at
  /// the last corner but one and ends at the face's rim. Null for any other body.
  std::shared_ptr<const HeightSurface> face = nullptr;
  /// Not null, beside `face`: the bottom of the body about its axis, which looks to -z. Then `outline_mm`
  /// begins not on the axis but in a wall that runs downward: its first two corners have the same radius
  /// 0 < R1 < R, and the second is lower. The bottom face covers x^2 + y^2 <= R1^2, and this wall begins at
  /// its rim. Null for any other body.
  std::shared_ptr<const HeightSurface> bottom_face = nullptr;
  /// Where it is in the luminaire frame.
  Frame world_from_solid;
  /// 1 to 4. The default is PMMA in the visible.
  double refractive_index = 1.49;
  /// Natural absorption coefficient >= 0: a path of x mm leaves exp(-x * absorption_per_mm).
  double absorption_per_mm = 0.0;
  /// Not null: each ray has the index of its own wavelength, and absorption too where there are samples of
  /// it. Rays of unknown wavelength (not above 0) have those above. All sources must have wavelengths.
  std::shared_ptr<const Dispersion> dispersion = nullptr;
  /// Of a mesh, > 0: the normal changes steadily across triangles that meet at less than this angle
  /// (`corner_normals`); 0: every triangle is flat. Of an outline: between corners that turn by more than
  /// this it is a curve without kinks through its corners (a C2 cubic spline); 0: all sides are straight. At
  /// most 180.
  double smooth_below_deg = 20.0;
  /// How the surface scatters what it reflects and what it lets through, about the direction of a smooth one.
  Scatter scatter;
  /// Of an outline: the sides that scatter, each with all of its face, from one edge to the next; empty for
  /// all. Side 0 leads from the first corner to the second; `face` is that from the last corner on, and
  /// `bottom_face` the one after it.
  std::vector<std::size_t> scatter_sides;
};

/// Throws InputError naming what is out of its range, and for a surface that is open or partly turned, or an
/// outline as solid_of_revolution refuses it, or whose curve crosses itself. With a face, for an outline that
/// is not as `face` says, or turns into a wall by no more than `smooth_below_deg`, and a face that is not
/// finite, is not above the outline and the bottom face at one of 64 x 64 points, or has its rim not above
/// the wall's lower end; for a bottom face alike;
/// and for a measured table, and scatter_sides of a mesh, of a body without lobes, that are not there or lie
/// on the axis.
/// O(triangles log triangles + corners^2).
void check(const Solid& solid);
/// How far the triangles of an outline may leave it, over its size, where they are only shown.
inline constexpr double kSurfaceTolerance = 1e-4;
/// Its surface as triangles, in its own frame: `mesh`, or what stands for its outline within `tolerance` of
/// its size. A face has at most 512 rings of triangles. Throws InputError as `check` does for the outline,
/// and for a tolerance that is not between 1e-8 and 1. O(corners^2 + triangles).
[[nodiscard]] std::shared_ptr<const Mesh> surface_mesh(const Solid& solid,
                                                       double tolerance = kSurfaceTolerance);

/// What a plate returns, lets through and keeps of unpolarised light; they sum to 1. `cos_incidence` in
/// [0, 1], outside the glass.
struct GlassShares {
  /// Each in [0, 1].
  double reflected = 0.0, transmitted = 0.0, absorbed = 0.0;
};
/// The shares of a plate at one angle of incidence. Thread safe.
GlassShares glass_shares(const CoverGlass& glass, double cos_incidence);

/// A source of light in the luminaire frame.
struct PlacedSource {
  /// The source; not null.
  std::shared_ptr<const RaySource> rays;
  /// Where it is in the luminaire frame.
  Frame world_from_source;
  /// Overrides the source's own flux, in its own unit; > 0.
  std::optional<double> flux;
  /// Not empty: the spectral power that wavelengths of the rays are drawn from, whatever the source says of
  /// them; of its lumens where it counts lumens. One point: all rays have that wavelength.
  SpectralTable spectrum = {};

  /// What wavelengths of the rays are drawn from: `spectrum`, else the one spectrum of a source without
  /// wavelengths; null: the rays have their own, or none are known.
  const SpectralTable* drawn_spectrum() const;

  /// `flux` if given, else the source's own; in the source's unit.
  double total_flux() const { return flux ? *flux : rays->flux(); }
};

/// The flux of all sources together, in their common unit.
double total_flux(std::span<const PlacedSource> sources);

/// A mirror in the luminaire frame. The side towards its +z reflects, the other absorbs.
struct PlacedReflector {
  /// The mirror in its own frame.
  Reflector reflector;
  /// Where it is in the luminaire frame.
  Frame world_from_reflector;
  /// Of the reflecting side.
  Reflectance reflectance{1.0};
  /// Standard deviation of the surface normal's tilt about each of two perpendicular axes, Gaussian; >= 0.
  /// Every reflection draws its own tilt.
  double slope_error_mrad = 0.0;
  /// How what is returned is scattered, about the direction that a tilted normal mirrors it to.
  Scatter scatter;
};

/// All that light can hit, and what looks at it. Plain data; `trace` checks it.
struct Scene {
  /// At least one; all in lm or all in W.
  std::vector<PlacedSource> sources;
  /// Mirrors; there may be none.
  std::vector<PlacedReflector> reflectors;
  /// Detectors of intensity.
  std::vector<FarFieldDetector> far_fields;
  /// Detectors of illuminance.
  std::vector<PlaneDetector> planes;
  /// Detectors of luminance.
  std::vector<LuminanceDetector> luminances;
  /// With any of these all rays that leave are kept, as TraceResult::out_rays: 28 bytes a ray.
  std::vector<RayDetector> ray_detectors;
  /// What absorbs or reflects and is no mirror of the list above.
  std::vector<Body> bodies;
  /// Flat plates that light passes.
  std::vector<CoverGlass> glasses;
  /// Closed bodies that light passes.
  std::vector<Solid> solids;
};

/// Share of a source's rays (of its first 4096) that start behind a mirror: within its aperture, on the side
/// of its back. A source that is partly behind reaches through the mirror.
double share_behind(const PlacedSource& source, const PlacedReflector& mirror);

/// Throws InputError if the scene cannot be traced: no source, a flux that is not above 0, lm and W together,
/// a detector whose steps do not divide the circle, two detectors of one name, a spectrum that is none, and a
/// source without wavelengths beside a solid that disperses.
void check(const Scene& scene);

}  // namespace lucerna
#pragma GCC visibility pop
