// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "lucerna/reflector/mesh.h"
#include "lucerna/reflector/reflector.h"

namespace lucerna {

/// How far a file of flat pieces may be from the surface.
struct CadTolerance {
  /// Largest distance of a piece from the surface, mm; > 0.
  double chord_mm = 0.01;
};

/// A reflector as triangles, for STL and OBJ: a grid over the aperture (polar for a circle, from the hole's
/// rim outwards; rectangles have theirs cut out where cells lie in it), counter-clockwise seen from the
/// reflecting side, fine enough that no triangle's edge middles or centre are farther than the tolerance from
/// the surface. Vertices are on the exact surface. Throws InputError if the tolerance is not above 0, or
/// would need more than 4 M triangles; says what would do.
Mesh cad_mesh(const Reflector& reflector, const CadTolerance& tolerance = {});

/// Binary STL (Stereolithography Interface Specification, 3D Systems 1989), normals towards the light.
std::string stl_bytes(const Mesh& mesh);
/// Wavefront OBJ, mm.
std::string obj_text(const Mesh& mesh);

/// The meridian at y = 0, x >= 0, from the hole's rim to the outline: points (r, z) such that the chords keep
/// the tolerance.
std::vector<std::array<double, 2>> cad_profile(const Reflector& reflector,
                                               const CadTolerance& tolerance = {});
/// The profile as one polyline of a DXF R12 file ($ACADVER AC1009), r along x and z along y, mm.
std::string dxf_profile(const std::vector<std::array<double, 2>>& profile);
/// The profile as CSV: r_mm,z_mm.
std::string csv_profile(const std::vector<std::array<double, 2>>& profile);

}  // namespace lucerna
