// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_curves.h"

#include <algorithm>
#include <set>

namespace lucerna {

namespace {

/// Straight sides leave the curve by at most this share of the lens's size; hits are then moved onto it.
constexpr double kSideTolerance = 1e-5;

bool moves_corner(const LensForm& form, std::size_t corner) {
  return std::any_of(form.moves.begin(), form.moves.end(),
                     [&](const CornerMove& m) { return m.corner == corner; });
}

/// The curve of a face with derivatives by one parameter.
std::vector<OutlinePiece<Dual>> dual_curve(const LensShape& shape, const LensFace& face,
                                           std::size_t parameter) {
  const LensForm& form = shape.form();
  std::vector<std::array<Dual, 2>> points;
  for (std::size_t i = face.run.from; i <= face.run.to; ++i) {
    const std::size_t corner = corner_number(form, i);
    std::array<Dual, 2> p{shape.corners()[corner][0], shape.corners()[corner][1]};
    for (const CornerMove& m : form.moves) {
      if (m.corner != corner || m.parameter != parameter) continue;
      for (std::size_t k = 0; k < 2; ++k) p[k].slope = m.direction[k];
    }
    points.push_back(p);
  }
  return spline_through(points, face.run.start, face.run.end);
}

}  // namespace

LensCurves::LensCurves(const LensShape& shape) : tree_(make_sides(shape)) {}

std::vector<OutlineSide> LensCurves::make_sides(const LensShape& shape) {
  const LensForm& form = shape.form();
  const double tolerance_mm = kSideTolerance * outline_reach_mm(shape.corners());
  std::vector<OutlineSide> sides;
  std::vector<int> number_of_edge(form.corners.size(), -1);
  for (std::size_t face_number = 0; face_number < form.faces.size(); ++face_number) {
    const LensFace& face = form.faces[face_number];
    const std::size_t first = pieces_.size();
    for (const OutlinePiece<double>& curve : run_curve(shape.corners(), face.run)) {
      LensPiece piece{curve, face_number};
      if (face.is_free) {
        piece.first_number = static_cast<int>(numbers_);
        numbers_ += kPieceNumbers;
      }
      const int n = straight_pieces_of(curve, tolerance_mm);
      for (int k = 0; k < n; ++k) {
        places_.push_back({static_cast<std::int32_t>(pieces_.size()), static_cast<double>(k) / n,
                           static_cast<double>(k + 1) / n});
      }
      add_sides(curve, n, sides);
      pieces_.push_back(piece);
    }
    const std::size_t from = corner_number(form, face.run.from), to = corner_number(form, face.run.to);
    pieces_[first].edge_at_from = shape.corners()[from][0] > 0.0;
    pieces_.back().edge_at_to = shape.corners()[to][0] > 0.0;
    if (!face.is_free) continue;
    if (moves_corner(form, from)) number_of_edge[from] = pieces_[first].first_number;
    if (moves_corner(form, to)) number_of_edge[to] = pieces_.back().first_number + 2;
  }
  std::size_t at = 0;
  for (const LensFace& face : form.faces) {
    pieces_[at].from_edge_number = number_of_edge[corner_number(form, face.run.from)];
    at += face.run.to - face.run.from;
    pieces_[at - 1].to_edge_number = number_of_edge[corner_number(form, face.run.to)];
  }
  LUCERNA_CHECK(places_.size() == sides.size(), "{} sides of {} places", sides.size(), places_.size());
  return sides;
}

Eigen::MatrixXd number_jacobian(const LensShape& shape) {
  const LensForm& form = shape.form();
  Eigen::Index rows = 0;
  for (const LensFace& face : form.faces) {
    if (face.is_free) rows += kPieceNumbers * static_cast<Eigen::Index>(face.run.to - face.run.from);
  }
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(form.parameters));
  Eigen::Index first = 0;
  for (const LensFace& face : form.faces) {
    if (!face.is_free) continue;
    std::set<std::size_t> touched;
    for (std::size_t i = face.run.from; i <= face.run.to; ++i) {
      for (const CornerMove& m : form.moves) {
        if (m.corner == corner_number(form, i)) touched.insert(m.parameter);
      }
    }
    for (const std::size_t parameter : touched) {
      Eigen::Index at = first;
      for (const OutlinePiece<Dual>& c : dual_curve(shape, face, parameter)) {
        for (const auto* part : {&c.from, &c.to, &c.from_slope, &c.to_slope}) {
          for (const Dual& x : *part) out(at++, static_cast<Eigen::Index>(parameter)) = x.slope;
        }
      }
    }
    first += kPieceNumbers * static_cast<Eigen::Index>(face.run.to - face.run.from);
  }
  return out;
}

}  // namespace lucerna
