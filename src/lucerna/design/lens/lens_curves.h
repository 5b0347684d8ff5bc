// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "lucerna/design/lens/lens_shape.h"
#include "lucerna/trace/kernels/revolved_tree.h"

namespace lucerna {

/// Numbers that make a piece of a curve: r and z of from, to, from_slope, to_slope.
inline constexpr int kPieceNumbers = 8;

/// A piece of a lens's surface as rays meet it.
struct LensPiece {
  OutlinePiece<double> curve;
  /// Number of its face.
  std::size_t face = 0;
  /// Of its numbers in the derivatives, or -1 where no parameter changes it.
  int first_number = -1;
  /// The piece begins (ends) at an edge to another face.
  bool edge_at_from = false, edge_at_to = false;
  /// Where r and z of that edge are among the numbers of the derivatives; -1 where it stays.
  int from_edge_number = -1, to_edge_number = -1;
};

/// The surface of a lens: its pieces, and a tree over straight sides that leave them by at most 1e-5 of its
/// size. Immutable, thread safe.
class LensCurves {
 public:
  explicit LensCurves(const LensShape& shape);

  const std::vector<LensPiece>& pieces() const { return pieces_; }
  RevolvedView view() const { return tree_.view(); }
  /// Piece of a straight side, and where the side begins and ends on it (0 to 1).
  struct SidePlace {
    std::int32_t piece;
    double from, to;
  };
  const SidePlace& place(std::int32_t side) const { return places_[static_cast<std::size_t>(side)]; }
  /// Numbers that derivatives are first taken by.
  std::size_t number_count() const { return numbers_; }

 private:
  std::vector<OutlineSide> make_sides(const LensShape& shape);

  std::vector<LensPiece> pieces_;
  std::vector<SidePlace> places_;
  std::size_t numbers_ = 0;
  RevolvedTree tree_;
};

/// d number / d parameter: number_count() x parameter_count(), through the spline and the lengths of its
/// chords, by dual numbers.
Eigen::MatrixXd number_jacobian(const LensShape& shape);

/// How much each of a piece's numbers moves its point at u, and that point's derivative by u; of r and of z
/// alike, in the order from, to, from_slope, to_slope.
struct PieceBasis {
  std::array<double, 4> at, first;
};
inline PieceBasis piece_basis(double u) {
  const double v = 1.0 - u;
  return {{v * v * (1.0 + 2.0 * u), u * u * (3.0 - 2.0 * u), u * v * v, -u * u * v},
          {-6.0 * u * v, 6.0 * u * v, v * (1.0 - 3.0 * u), u * (3.0 * u - 2.0)}};
}

}  // namespace lucerna
