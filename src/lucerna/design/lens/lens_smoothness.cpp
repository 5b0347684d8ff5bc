// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_smoothness.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace lucerna {

namespace {

/// Waves of a perturbation: from one that lifts the whole face to nine half periods.
constexpr int kWaves = 10;

/// How far the corners of a free face move along its normals to begin with: corners by parameters.
Eigen::MatrixXd normal_moves(const LensForm& form, const LensFace& face) {
  const std::size_t sides = face.run.to - face.run.from;
  const auto curve = run_curve(form.corners, face.run);
  Eigen::MatrixXd out =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(sides + 1), static_cast<Eigen::Index>(form.parameters));
  for (std::size_t i = 0; i <= sides; ++i) {
    const OutlinePoint& along = i < sides ? curve[i].from_slope : curve.back().to_slope;
    const double length = std::hypot(along[0], along[1]);
    for (const CornerMove& m : form.moves) {
      if (m.corner != corner_number(form, face.run.from + i)) continue;
      out(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(m.parameter)) =
          (m.direction[0] * along[1] - m.direction[1] * along[0]) / length;
    }
  }
  return out;
}

std::vector<Eigen::MatrixXd> free_moves(const LensForm& form) {
  std::vector<Eigen::MatrixXd> out;
  for (const LensFace& face : form.faces) {
    if (face.is_free) out.push_back(normal_moves(form, face));
  }
  return out;
}

}  // namespace

Eigen::MatrixXd lens_roughness(const LensShape& shape) {
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::MatrixXd& moves : free_moves(shape.form())) {
    const Eigen::Index pieces = moves.rows() - 1;
    if (pieces < 3) continue;
    const Eigen::MatrixXd third = moves.bottomRows(pieces - 2) - 3.0 * moves.middleRows(2, pieces - 2) +
                                  3.0 * moves.middleRows(1, pieces - 2) - moves.topRows(pieces - 2);
    out += std::pow(static_cast<double>(pieces), 5) * third.transpose() * third;
  }
  return out / (shape.radius_mm() * shape.radius_mm());
}

Eigen::MatrixXd lens_tilt(const LensShape& shape) {
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::MatrixXd& moves : free_moves(shape.form())) {
    const Eigen::Index pieces = moves.rows() - 1;
    const Eigen::MatrixXd first = moves.bottomRows(pieces) - moves.topRows(pieces);
    out += first.transpose() * first;
  }
  return out;
}

LensShape perturbed_smoothly(const LensShape& shape, double size_mm, Rng rng) {
  constexpr double kSmaller = 0.8;
  const auto faces = free_moves(shape.form());
  for (double size = size_mm; size > 1e-6 * size_mm; size *= kSmaller) {
    Eigen::VectorXd p = shape.parameters();
    for (const Eigen::MatrixXd& moves : faces) {
      Eigen::VectorXd height = Eigen::VectorXd::Zero(moves.rows());
      for (int wave = 0; wave < kWaves; ++wave) {
        const double high = size * (2.0 * rng.uniform() - 1.0) / (1.0 + 0.2 * wave * wave);
        for (Eigen::Index i = 0; i < height.size(); ++i)
          height[i] += high * std::cos(std::numbers::pi * wave * static_cast<double>(i) /
                                       static_cast<double>(height.size() - 1));
      }
      p += moves.transpose() * height;
    }
    LensShape out = shape.with(p);
    if (out.is_valid()) return out;
  }
  return shape;
}

}  // namespace lucerna
