// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "lucerna/geometry.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Triangles with shared vertices, mm. Counter-clockwise seen from outside, where the file keeps to that.
struct Mesh {
  /// Corners of the triangles, each once.
  std::vector<Vec3> vertices_mm;
  /// Indices of the three corners of each.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Reads a binary or text STL file (which one follows from the content; equal corners become one vertex).
/// Throws InputError with the byte or line on a damaged file, a coordinate that is not finite, or no
/// triangle.
[[nodiscard]] Mesh read_stl(const std::filesystem::path& path);

/// Reads the `v` and `f` lines of a Wavefront OBJ file; polygons become fans, negative indices count from the
/// end, equal corners become one vertex, all else is passed over. Throws InputError with the line.
[[nodiscard]] Mesh read_obj(const std::filesystem::path& path);

/// By the file's ending, .stl or .obj; InputError on another.
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);

/// Normals at the corners of all triangles, three a triangle, unit: means of the normals of the triangles
/// about the vertex, weighted by their angles there (G. Thürmer, C. Wüthrich, "Computing vertex normals from
/// polygonal facets", J. Graphics Tools 3, 1998), of those that make less than `crease_deg` with the corner's
/// own, so that edges stay sharp. Triangles without area keep +z. Vertices must be shared. O(triangles).
[[nodiscard]] std::vector<Vec3> corner_normals(const Mesh& mesh, double crease_deg);

/// The closed surface that an outline makes when it turns about the z axis. `outline_mm`: corners (r, z) of a
/// closed polygon, at least three, r >= 0; a side along the axis makes no surface. `segments` >= 3 about the
/// axis: a circle of radius r is drawn at most r (1 - cos(pi / segments)) too small. Triangles are
/// counter-clockwise seen from outside whichever way the outline runs. Throws InputError for fewer corners or
/// segments, a radius below 0, a number that is not finite, two equal corners in a row, an outline that
/// crosses itself or has no area. Long flat sides are divided. O(corners^2 + corners segments).
[[nodiscard]] Mesh solid_of_revolution(std::span<const std::array<double, 2>> outline_mm, int segments = 360);

/// Edges that do not belong to exactly two triangles: 0 for a closed body.
std::size_t open_edges(const Mesh& mesh);

}  // namespace lucerna
#pragma GCC visibility pop
