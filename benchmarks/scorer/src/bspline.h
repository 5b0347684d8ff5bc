// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "json_node.h"
#include "patch.h"
#include "vec.h"

namespace bench {

/// Largest degree of a B-spline.
inline constexpr int kMaxDegree = 7;

/// A tensor-product B-spline, rational where it has weights (L. Piegl and W. Tiller, "The NURBS Book",
/// chapters 2 to 4). Immutable; thread safe.
class Bspline {
 public:
  /// `degree`, `knots_u`, `knots_v`, `points_mm`, `weights` of a surface. Throws InputError for anything that
  /// is no such surface.
  explicit Bspline(const JsonNode& surface);

  SurfaceJet at(double u, double v) const;
  /// The domain along an axis (0: u, 1: v).
  double low(std::size_t axis) const {
    return axes_[axis].knots[static_cast<std::size_t>(axes_[axis].degree)];
  }
  double high(std::size_t axis) const { return axes_[axis].knots[axes_[axis].count]; }
  int degree(std::size_t axis) const { return axes_[axis].degree; }
  /// Ascending ends of the pieces of the domain along an axis.
  const std::vector<double>& breaks(std::size_t axis) const { return axes_[axis].breaks; }

 private:
  using Numbers = std::array<double, kMaxDegree + 1>;
  /// The functions that are not 0 on a piece of the domain, as polynomials: [power][function], of where x
  /// is from the piece's low end (0) to its high end (1).
  struct Piece {
    std::size_t first = 0;
    double per_length = 0.0;
    std::array<Numbers, kMaxDegree + 1> powers{};
  };
  struct Axis {
    int degree = 0;
    std::size_t count = 0;
    std::vector<double> knots, breaks;
    std::vector<Piece> pieces;
    double pieces_per_length = 0.0;
  };
  static void read_axis(const JsonNode& knots, Axis& axis);
  static Piece piece(const Axis& axis, std::size_t span);
  /// Values and derivatives of the functions that are not 0 at x; the number of the first of them. Degrees
  /// are numbers that are known to the compiler (std::integral_constant) or not: most splines are cubic, and
  /// much faster so.
  template <class Degree>
  static std::size_t basis(const Axis& axis, Degree p, double x, Numbers& value, Numbers& slope);
  template <class Degree>
  SurfaceJet plain(Degree p, Degree q, double u, double v) const;
  SurfaceJet rational(double u, double v) const;

  std::array<Axis, 2> axes_;
  std::vector<Vec3> points_;
  std::vector<double> weights_;
};

}  // namespace bench
