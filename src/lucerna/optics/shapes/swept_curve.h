// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/geometry.h"
#include "lucerna/optics/shapes/profile.h"

namespace lucerna {

/// A part of the curve (r(s), z(s)), s in [0, 1], cubic in both, that turns so little that it is also a
/// function of one of them. Plain data, read by tracing kernels.
struct CurvePiece {
  double r[4], z[4];  ///< coefficients, lowest power first
  double from, to;    ///< of the coordinate that it is a function of, at s = 0 and 1; monotone between
  bool along_z;       ///< that coordinate is z
};

/// A box about consecutive pieces. Nodes stand in depth-first order: a ray that misses a box goes on at
/// `skip`, else at the next node; a leaf has a piece >= 0.
struct CurveNode {
  double r0, r1, z0, z1;
  std::int32_t skip, piece;
};

/// How a profile becomes a surface: turned about the z axis, or drawn along y over both signs of x.
enum class Sweep { revolution, trough };

/// The C2 parametric cubic spline through given points of the (r, z) half plane, r >= 0, swept to a mirror.
/// Unlike a `Profile` it need not be a function of r: a reflector may close in again past its equator, and
/// walls may be vertical. Points go from the vertex (or the hole) to the rim; the side to the left of that
/// way reflects, which for ascending r is the one towards +z: the inside. Parametrised by the chords; smooth
/// where it starts or ends on the axis, else not-a-knot. Exact: nothing is sampled, normals are those of the
/// spline. Immutable and thread safe.
class SweptCurve {
 public:
  /// Throws InputError unless there are at least two points, finite, r >= 0, no two neighbours equal, not all
  /// on the axis; or if the spline turns so sharply that it nearly stops, crosses the axis between two
  /// points, or crosses itself (naming the points). O(points^2) in the worst case, for that check.
  SweptCurve(const std::vector<ProfileKnot>& knots, Sweep sweep);

  Sweep sweep() const { return sweep_; }
  const std::vector<CurvePiece>& pieces() const { return pieces_; }
  const std::vector<CurveNode>& nodes() const { return nodes_; }
  double r_min_mm() const { return nodes_.front().r0; }
  double r_max_mm() const { return nodes_.front().r1; }
  const ProfileKnot& first() const { return first_; }
  const ProfileKnot& last() const { return last_; }
  HeightRange heights() const { return {nodes_.front().z0, nodes_.front().z1}; }

  /// Point of the curve and unit normal towards the reflecting side, in the (r, z) plane; `u` in [0, 1] runs
  /// over all pieces. For drawing.
  struct Point {
    double r_mm, z_mm, normal_r, normal_z;
  };
  Point at(double u) const;

 private:
  void add_pieces(const CurvePiece& whole, std::size_t knot, int depth);
  std::int32_t add_nodes(std::size_t first, std::size_t last);
  void check_crossings() const;

  Sweep sweep_;
  ProfileKnot first_, last_;
  std::vector<CurvePiece> pieces_;
  std::vector<std::size_t> knot_of_;  ///< by piece: the knot that it comes after
  std::vector<CurveNode> nodes_;
};

}  // namespace lucerna
