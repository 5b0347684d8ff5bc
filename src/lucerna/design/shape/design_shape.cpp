// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/shape/design_shape.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <type_traits>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

void check_range(const char* what, double value, double low, double high) {
  if (!(value >= low && value <= high)) {
    throw InputError(fmt::format("design: {} is {}, expected {} to {}", what, value, low, high));
  }
}

/// Numbers the classes of coefficients that a symmetry ties together, in the order of their first members.
std::vector<int> number_classes(const std::vector<int>& representative) {
  std::vector<int> number(representative.size(), -1);
  int next = 0;
  for (std::size_t i = 0; i < representative.size(); ++i) {
    int& n = number[static_cast<std::size_t>(representative[i])];
    if (n < 0) n = next++;
  }
  std::vector<int> classes(representative.size());
  for (std::size_t i = 0; i < classes.size(); ++i) {
    classes[i] = number[static_cast<std::size_t>(representative[i])];
  }
  return classes;
}

std::vector<int> tied(const RevolutionShape& shape, ShapeSymmetry) {
  std::vector<int> same(shape.coefficients().size());
  std::iota(same.begin(), same.end(), 0);
  same[2] = 0;
  return number_classes(same);
}

std::vector<int> tied(const BsplineShape& shape, ShapeSymmetry symmetry) {
  const int nx = shape.row_x().coefficients(), ny = shape.row_y().coefficients();
  const bool in_x = symmetry == ShapeSymmetry::mirror_x || symmetry == ShapeSymmetry::both ||
                    symmetry == ShapeSymmetry::trough_mirror_x;
  const bool in_y = symmetry == ShapeSymmetry::mirror_y || symmetry == ShapeSymmetry::both;
  const bool all_y = symmetry == ShapeSymmetry::trough || symmetry == ShapeSymmetry::trough_mirror_x;
  std::vector<int> same;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const int a = in_x ? std::min(i, nx - 1 - i) : i, b = all_y ? 0 : (in_y ? std::min(j, ny - 1 - j) : j);
      same.push_back(b * nx + a);
    }
  }
  return number_classes(same);
}

RevolutionShape with_coefficients(const RevolutionShape& s, std::vector<double> c) {
  return {s.focal_mm(), s.row(), std::move(c)};
}
BsplineShape with_coefficients(const BsplineShape& s, std::vector<double> c) {
  return {s.focal_mm(), s.row_x(), s.row_y(), std::move(c)};
}

/// The matrix that takes values at the Greville points of `row` (every knot, one more beyond each end) to
/// coefficients. Values beyond the ends are those of the end polynomials.
Eigen::MatrixXd interpolation(const KnotRow& row) {
  const int n = row.coefficients();
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    const KnotRow::Place p = row.place(row.start_mm + (i - 1) * row.step_mm);
    const CubicBasis b = cubic_basis(p.t);
    for (int k = 0; k < 4; ++k) values(i, p.first + k) = b[static_cast<std::size_t>(k)];
  }
  return values.inverse();
}

double greville(const KnotRow& row, int i) { return row.start_mm + (i - 1) * row.step_mm; }

using Height = std::function<double(double, double)>;

/// The spline on `row` whose offset from the paraboloid agrees with `offset` at the Greville points.
RevolutionShape interpolate(const RevolutionShape& s, int intervals, int, const Height& offset) {
  const KnotRow row{0.0, s.row().end_mm() / intervals, intervals};
  const int n = row.coefficients() - 1;  // the one before the axis is the one after it
  Eigen::MatrixXd at_points = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd values(n);
  for (int i = 0; i < n; ++i) {
    const double r = greville(row, i + 1);
    const KnotRow::Place p = row.place(r);
    const CubicBasis b = cubic_basis(p.t);
    for (int k = 0; k < 4; ++k) {
      const int c = p.first + k;
      at_points(i, c == 0 ? 1 : c - 1) += b[static_cast<std::size_t>(k)];
    }
    values[i] = offset(r, 0.0);
  }
  const Eigen::VectorXd c = at_points.partialPivLu().solve(values);
  std::vector<double> coefficients{c[1]};
  coefficients.insert(coefficients.end(), c.begin(), c.end());
  return {s.focal_mm(), row, std::move(coefficients)};
}

BsplineShape interpolate(const BsplineShape& s, int intervals_x, int intervals_y, const Height& offset) {
  const KnotRow x{s.row_x().start_mm, (s.row_x().end_mm() - s.row_x().start_mm) / intervals_x, intervals_x};
  const KnotRow y{s.row_y().start_mm, (s.row_y().end_mm() - s.row_y().start_mm) / intervals_y, intervals_y};
  Eigen::MatrixXd values(y.coefficients(), x.coefficients());
  for (int j = 0; j < y.coefficients(); ++j) {
    for (int i = 0; i < x.coefficients(); ++i) values(j, i) = offset(greville(x, i), greville(y, j));
  }
  const Eigen::MatrixXd c = interpolation(y) * values * interpolation(x).transpose();
  std::vector<double> coefficients;
  for (int j = 0; j < y.coefficients(); ++j) {
    for (int i = 0; i < x.coefficients(); ++i) coefficients.push_back(c(j, i));
  }
  return {s.focal_mm(), x, y, std::move(coefficients)};
}

std::vector<double> above_parameters(const RevolutionShape& shape, ShapeSymmetry) {
  return std::vector<double>(shape.coefficients().size(), 0.0);
}

/// A trough's: -y^2 / (4 f), which a cubic spline of y holds exactly.
std::vector<double> above_parameters(const BsplineShape& shape, ShapeSymmetry symmetry) {
  std::vector<double> above(shape.coefficients().size(), 0.0);
  if (symmetry != ShapeSymmetry::trough && symmetry != ShapeSymmetry::trough_mirror_x) return above;
  const KnotRow& row = shape.row_y();
  Eigen::VectorXd values(row.coefficients());
  for (int j = 0; j < row.coefficients(); ++j)
    values[j] = -0.25 / shape.focal_mm() * std::pow(greville(row, j), 2);
  const Eigen::VectorXd c = interpolation(row) * values;
  const auto nx = static_cast<std::size_t>(shape.row_x().coefficients());
  for (std::size_t i = 0; i < above.size(); ++i) above[i] = c[static_cast<Eigen::Index>(i / nx)];
  return above;
}

}  // namespace

DesignShape::DesignShape(std::variant<RevolutionShape, BsplineShape> shape, const Aperture& aperture,
                         ShapeSymmetry symmetry)
    : shape_(std::move(shape)), aperture_(aperture), symmetry_(symmetry) {
  parameter_of_ = std::visit([&](const auto& s) { return tied(s, symmetry); }, shape_);
  above_ = std::visit([&](const auto& s) { return above_parameters(s, symmetry); }, shape_);
  const std::vector<double> c = coefficients();
  const int n = 1 + *std::max_element(parameter_of_.begin(), parameter_of_.end());
  parameters_ = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd members = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < c.size(); ++i) {
    parameters_[parameter_of_[i]] += c[i] - above_[i];
    members[parameter_of_[i]] += 1.0;
  }
  parameters_ = parameters_.cwiseQuotient(members);
}

DesignShape DesignShape::revolution(double focal_mm, const Aperture& aperture, int intervals) {
  check_range("the focal length in mm", focal_mm, 1e-3, 1e6);
  check_range("the number of knot intervals", intervals, 1, 1000);
  if (aperture.shape() != ApertureShape::circle) {
    throw InputError("design: a surface of revolution needs aperture = \"circle\"");
  }
  const KnotRow row{0.0, aperture.outer_radius_mm() / intervals, intervals};
  const std::vector<double> c(static_cast<std::size_t>(row.coefficients()), 0.0);
  return {RevolutionShape(focal_mm, row, c), aperture, ShapeSymmetry::none};
}

DesignShape DesignShape::bspline(double focal_mm, const Aperture& aperture, int intervals_x, int intervals_y,
                                 ShapeSymmetry symmetry) {
  check_range("the focal length in mm", focal_mm, 1e-3, 1e6);
  check_range("the number of knot intervals along x", intervals_x, 1, 60);
  check_range("the number of knot intervals along y", intervals_y, 1, 60);
  const double a = aperture.half_x_mm(), b = aperture.half_y_mm();
  const KnotRow x{-a, 2.0 * a / intervals_x, intervals_x}, y{-b, 2.0 * b / intervals_y, intervals_y};
  const std::vector<double> c(static_cast<std::size_t>(x.coefficients() * y.coefficients()), 0.0);
  return {BsplineShape(focal_mm, x, y, c), aperture, symmetry};
}

DesignShape DesignShape::trough(double focal_mm, const Aperture& aperture, int intervals, bool mirrored) {
  const DesignShape shape = bspline(focal_mm, aperture, intervals, 1,
                                    mirrored ? ShapeSymmetry::trough_mirror_x : ShapeSymmetry::trough);
  return shape.with(Eigen::VectorXd::Zero(shape.parameters().size()));
}

double DesignShape::focal_mm() const {
  return std::visit([](const auto& s) { return s.focal_mm(); }, shape_);
}

std::vector<double> DesignShape::coefficients() const {
  return std::visit([](const auto& s) { return s.coefficients(); }, shape_);
}

DesignShape DesignShape::with(const Eigen::VectorXd& parameters) const {
  LUCERNA_CHECK(parameters.size() == parameters_.size(), "{} parameters, expected {}", parameters.size(),
                parameters_.size());
  std::vector<double> c(parameter_of_.size());
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = parameters[parameter_of_[i]] + above_[i];
  DesignShape other = *this;
  std::visit([&](auto& s) { s = with_coefficients(s, c); }, other.shape_);
  other.parameters_ = parameters;
  return other;
}

DesignShape DesignShape::refined(int intervals_x, int intervals_y) const {
  return std::visit(
      [&](const auto& s) {
        const Height offset = [&](double x, double y) { return s.view().offset(x, y).s; };
        const DesignShape fine(interpolate(s, intervals_x, intervals_y, offset), aperture_, symmetry_);
        return fine.with(fine.parameters());  // tied coefficients equal to the last bit
      },
      shape_);
}

DesignShape DesignShape::through(const std::function<double(double, double)>& height_mm) const {
  return std::visit(
      [&](const auto& s) {
        const Height offset = [&](double x, double y) {
          return height_mm(x, y) - 0.25 / s.focal_mm() * (x * x + y * y);
        };
        const DesignShape shape(interpolate(s, intervals_x(), intervals_y(), offset), aperture_, symmetry_);
        return shape.with(shape.parameters());
      },
      shape_);
}

double DesignShape::height_mm() const {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto look = [&](double x, double y) {
    if (!aperture_.contains(x, y)) return;
    const double z = at(x, y).z_mm;
    low = std::min(low, z);
    high = std::max(high, z);
  };
  const auto look_around = [&](double radius) {
    for (int i = 0; i < 360; ++i) {
      const double angle = i * std::numbers::pi / 180.0;
      look(radius * std::cos(angle), radius * std::sin(angle));
    }
  };
  const double a = aperture_.half_x_mm(), b = aperture_.half_y_mm();
  constexpr int kSteps = 50;
  for (int j = -kSteps; j <= kSteps; ++j) {
    for (int i = -kSteps; i <= kSteps; ++i) look(a * i / kSteps, b * j / kSteps);
  }
  // Rounding must not move a rim's points off the mirror.
  if (aperture_.hole_radius_mm() > 0.0) look_around((1.0 + 1e-12) * aperture_.hole_radius_mm());
  if (aperture_.shape() == ApertureShape::circle) look_around((1.0 - 1e-12) * a);
  return high - low;
}

int DesignShape::intervals_x() const {
  if (const auto* r = std::get_if<RevolutionShape>(&shape_)) return r->row().intervals;
  return std::get<BsplineShape>(shape_).row_x().intervals;
}

int DesignShape::intervals_y() const {
  return is_revolution() ? 0 : std::get<BsplineShape>(shape_).row_y().intervals;
}

std::shared_ptr<const HeightSurface> DesignShape::surface() const {
  return std::visit(
      [](const auto& s) -> std::shared_ptr<const HeightSurface> {
        return std::make_shared<SmoothSurface<std::decay_t<decltype(s)>>>(s);
      },
      shape_);
}

SurfacePoint DesignShape::at(double x_mm, double y_mm) const {
  return std::visit([&](const auto& s) { return smooth_point(s.view(), x_mm, y_mm); }, shape_);
}

}  // namespace lucerna
