// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "lucerna/mesh.h"
#include "lucerna/reflector.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// How far a file of flat pieces may be from the surface.
struct CadTolerance {
  /// Largest distance of a piece from the surface, and of a rim's chord from its circle, mm; > 0.
  double chord_mm = 0.01;
  /// Largest angle between a piece and the surface at its corners, degrees; > 0. Half of what a beam would be
  /// off. Profiles keep it too.
  double slope_deg = 2.0;
};

/// What a mesh keeps that light is traced through: flat facets blur a beam by about their angle to the
/// surface, and this is a fifth of a 48th of a wide beam. The mesh of a design for a narrower beam, in its
/// STL file and its validation, is up to twice as fine.
inline constexpr CadTolerance kOpticalTolerance{.chord_mm = 0.01, .slope_deg = 0.3};

/// A reflector as triangles, for STL and OBJ: a grid over the aperture (from the hole's rim outwards where
/// there is one, and over circles; else of rows and columns), counter-clockwise seen from the reflecting
/// side, fine enough for the tolerance everywhere. Vertices are on the exact surface. Throws InputError if a
/// tolerance is not above 0, or would need more than 4 M triangles, and for a faceted mirror, whose steps no
/// connected mesh follows.
[[nodiscard]] Mesh cad_mesh(const Reflector& reflector, const CadTolerance& tolerance = {});

/// The same with a tolerance that is raised until 1 M triangles do, to within a fifth; it then says what is
/// kept. For a surface that bends too sharply for any, the InputError of `cad_mesh`.
[[nodiscard]] Mesh cad_mesh_within(const Reflector& reflector, CadTolerance& tolerance);

/// Binary STL (Stereolithography Interface Specification, 3D Systems 1989), normals towards the light.
[[nodiscard]] std::string stl_bytes(const Mesh& mesh);
/// Wavefront OBJ, mm.
[[nodiscard]] std::string obj_text(const Mesh& mesh);

/// The meridian at y = 0, x >= 0, from the hole's rim to the outline: points (r, z) such that the chords keep
/// the tolerance.
[[nodiscard]] std::vector<std::array<double, 2>> cad_profile(const Reflector& reflector,
                                                             const CadTolerance& tolerance = {});
/// The profile as one polyline of a DXF R12 file ($ACADVER AC1009), r along x and z along y, mm.
[[nodiscard]] std::string dxf_profile(const std::vector<std::array<double, 2>>& profile);
/// The profile as CSV: r_mm,z_mm.
[[nodiscard]] std::string csv_profile(const std::vector<std::array<double, 2>>& profile);

/// A body of revolution as a STEP file (as `step_text`), a closed solid: its outline as `Solid::outline_mm`,
/// each curve without edges as the very spline that is traced, turned about the z axis. Throws InputError as
/// `check(Solid)` does for the outline, and for one that is smooth all about.
[[nodiscard]] std::string solid_step_text(std::span<const std::array<double, 2>> outline_mm,
                                          double smooth_below_deg, const std::string& name = "lens");
/// The same with faces, as `Solid::face` and `Solid::bottom_face`, each of which is one bicubic B-spline
/// surface, the very one that is traced. Its rim is within 1e-6 mm of it. Throws InputError as `check(Solid)`
/// does for both, and for a face that is no B-spline.
[[nodiscard]] std::string solid_step_text(std::span<const std::array<double, 2>> outline_mm,
                                          const BodyFaces& faces, double smooth_below_deg,
                                          const std::string& name = "lens");
/// Its outline in straight pieces within `chord_mm` of the curve, closed: the first point comes last again.
/// Errors as above.
[[nodiscard]] std::vector<std::array<double, 2>> solid_profile(
    std::span<const std::array<double, 2>> outline_mm, double smooth_below_deg, double chord_mm = 1e-3);

/// A reflector as a STEP file (ISO 10303-21, application protocol 214), mm, in the mirror's own frame, as an
/// open shell whose normal looks towards the light. Free forms are one bicubic B-spline surface, the very
/// one that is traced, with x and y as its parameters; profiles are swept surfaces of revolution, of the very
/// spline where they are `RevolutionShape`s, else of a cubic that is within 1e-6 mm of the profile. Outlines
/// and holes are exact for revolution and along rectangles, else curves within 1e-6 mm of the surface. The
/// text depends on nothing but the reflector. Throws InputError for a surface that is neither, and names it.
[[nodiscard]] std::string step_text(const Reflector& reflector, const std::string& name = "reflector");

}  // namespace lucerna
#pragma GCC visibility pop
