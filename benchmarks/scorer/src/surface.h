// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "json_node.h"
#include "vec.h"

namespace bench {

/// Triangles for Embree; corners in the frame of the task, mm.
struct Triangles {
  std::vector<Vec3> corners;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// A first guess of a hit: what Embree says.
struct FlatHit {
  std::uint32_t triangle = 0;
  double t = 0.0;
  /// Weights of the second and the third corner.
  double b1 = 0.0, b2 = 0.0;
};

/// A hit as light is traced: its distance, the unit normal that reflects and refracts, and the geometric one,
/// which says on which side the ray comes.
struct Hit {
  double t = 0.0;
  Vec3 normal, geometric;
};

/// A surface of a submission in the frame of the task. Immutable; thread safe.
class Surface {
 public:
  virtual ~Surface() = default;
  virtual const Triangles& triangles() const = 0;
  /// Points that bound it, for limits: corners of its triangles, and of a trimmed surface those that are left
  /// and where its rim cuts their edges.
  virtual std::vector<Vec3> extent() const { return triangles().corners; }
  /// Is a triangle there as a whole, not trimmed?
  virtual bool whole(const std::array<std::uint32_t, 3>&) const { return true; }
  /// The hit of a ray near a flat one; false where the surface itself is missed.
  virtual bool refine(const Vec3& origin, const Vec3& direction, const FlatHit& flat, Hit& hit) const = 0;
};

/// Distance of a point from a surface, by its triangles and the points of `extent`.
double distance(const Surface& surface, const Vec3& from);

/// An STL file, binary or text (3D Systems 1989). The corners' order gives the normals, stored ones must not
/// point against it. With `crease_deg` > 0 normals are interpolated between corners: those of the facets that
/// meet there within that angle, weighted by their areas; no more than 10 degrees off a facet. With 0 facets
/// are flat.
std::unique_ptr<Surface> read_stl(const std::string& file, const Frame& place, double crease_deg);

/// The faces of a STEP file, read by OpenCASCADE, one by one; they are traced themselves. Normals are those
/// of the faces: out of a solid. Throws InputError where the scorer was built without OpenCASCADE.
std::vector<std::unique_ptr<Surface>> read_step(const std::string& file, const Frame& place);

/// A tensor-product B-spline surface (README.md, "Surfaces"): traced itself, by Newton's method from a hit
/// with triangles of it. Normals along dP/du x dP/dv.
std::unique_ptr<Surface> read_bspline(const JsonNode& surface, const Frame& place);

}  // namespace bench
