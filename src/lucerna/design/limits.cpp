// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/limits.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace lucerna {

namespace {

constexpr double kMargin_mm = 0.02;

struct Place {
  double x, y;
};

/// Where the height is looked at: a grid, and the outline.
std::vector<Place> places(const DesignShape& shape) {
  const Aperture& a = shape.aperture();
  std::vector<Place> out;
  constexpr int kSteps = 12;
  if (shape.is_revolution()) {
    for (int i = 1; i <= 8 * kSteps; ++i) out.push_back({a.half_x_mm() * i / (8.0 * kSteps), 0.0});
    return out;
  }
  for (int j = -kSteps; j <= kSteps; ++j) {
    for (int i = -kSteps; i <= kSteps; ++i) {
      const Place p{a.half_x_mm() * i / kSteps, a.half_y_mm() * j / kSteps};
      if (a.contains(p.x, p.y)) out.push_back(p);
    }
  }
  if (a.shape() == ApertureShape::circle) {
    for (int i = 0; i < 72; ++i) {
      const double angle = i * std::numbers::pi / 36.0;
      out.push_back({a.half_x_mm() * std::cos(angle), a.half_x_mm() * std::sin(angle)});
    }
  }
  return out;
}

/// d z / d parameters at a place, times `sign`, added to `row`.
void add_height_row(const DesignShape& design, const Place& p, double sign, Eigen::VectorXd& row) {
  std::visit(
      [&](const auto& shape) {
        using Shape = std::decay_t<decltype(shape)>;
        const auto local = shape.local(p.x, p.y);
        std::array<double, Shape::kSupport> value;
        const std::array<double, Shape::kSupport> none{};
        shape.gradient(local, sign, 0.0, 0.0, value.data());
        std::vector<double> coefficients(shape.coefficients().size(), 0.0);
        shape.add(local, 1.0, value.data(), 0.0, none.data(), coefficients.data());
        for (std::size_t i = 0; i < coefficients.size(); ++i) {
          row[design.parameter_of()[i]] += coefficients[i];
        }
      },
      design.family());
}

}  // namespace

double height_limit(const DesignShape& shape, double max_height_mm, NormalEquations* equations) {
  double cost = 0.0;
  const double vertex = shape.at(0.0, 0.0).z_mm, limit = max_height_mm - kMargin_mm;
  for (const Place& p : places(shape)) {
    const double excess = (shape.at(p.x, p.y).z_mm - vertex - limit) / kMargin_mm;
    if (excess <= 0.0) continue;
    cost += excess * excess;
    if (equations == nullptr) continue;
    Eigen::VectorXd row = Eigen::VectorXd::Zero(equations->gradient.size());
    add_height_row(shape, p, 1.0 / kMargin_mm, row);
    add_height_row(shape, {0.0, 0.0}, -1.0 / kMargin_mm, row);
    equations->gradient += excess * row;
    equations->hessian.selfadjointView<Eigen::Lower>().rankUpdate(row);
  }
  return cost;
}

void add_flux_term(const Evaluation& e, double weight, double reference, NormalEquations& equations) {
  const double missing = 1.0 - e.flux.sum() / reference;
  const Eigen::VectorXd slope = e.jacobian.colwise().sum().transpose() * (-1.0 / reference);
  equations.cost += weight * missing * missing;
  equations.gradient += weight * missing * slope;
  equations.hessian.selfadjointView<Eigen::Lower>().rankUpdate(slope, weight);
}

}  // namespace lucerna
