// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/smoothness_penalty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

namespace lucerna {

namespace {

/// Squares of third differences of coefficients, gathered as residuals of the parameters.
class ThirdDifferences {
 public:
  ThirdDifferences(const std::vector<double>& coefficients, const std::vector<int>& parameter_of,
                   double weight, ResidualRows* rows)
      : c_(coefficients),
        parameter_of_(parameter_of),
        weight_(weight / static_cast<double>(coefficients.size())),
        rows_(rows) {}

  /// Of the four coefficients from `first` on, `stride` apart; the residual times `share`.
  void add(int first, int stride, double step_mm, double share) {
    constexpr std::array<double, 4> kThird{-1.0, 3.0, -3.0, 1.0};
    const double per = share * std::sqrt(weight_) / step_mm;
    double residual = 0.0;
    for (std::size_t k = 0; k < 4; ++k) residual += per * kThird[k] * c_[at(first, stride, k)];
    cost_ += residual * residual;
    if (rows_ == nullptr) return;
    rows_->begin(residual);
    for (std::size_t k = 0; k < 4; ++k) rows_->add(parameter_of_[at(first, stride, k)], per * kThird[k]);
  }
  double cost() const { return cost_; }

 private:
  static std::size_t at(int first, int stride, std::size_t k) {
    return static_cast<std::size_t>(first + static_cast<int>(k) * stride);
  }

  const std::vector<double>& c_;
  const std::vector<int>& parameter_of_;
  double weight_, cost_ = 0.0;
  ResidualRows* rows_;
};

}  // namespace

double smoothness_penalty(const DesignShape& shape, double weight, double at_axis, ResidualRows* rows) {
  if (!(weight > 0.0)) return 0.0;
  if (const auto* r = std::get_if<RevolutionShape>(&shape.family())) {
    ThirdDifferences sum(r->coefficients(), shape.parameter_of(), weight, rows);
    for (int i = 0; i + 3 < r->row().coefficients(); ++i) sum.add(i, 1, r->row().step_mm, 1.0);
    return sum.cost();
  }
  const auto& b = std::get<BsplineShape>(shape.family());
  const KnotRow &row_x = b.row_x(), &row_y = b.row_y();
  const int nx = row_x.coefficients(), ny = row_y.coefficients();
  // Coefficient k is the height one knot before knot k, nearly.
  const auto share = [&](double i, double j) {
    const double x = row_x.start_mm + (i - 1.0) * row_x.step_mm,
                 y = row_y.start_mm + (j - 1.0) * row_y.step_mm;
    return std::clamp(std::hypot(x, y) / shape.aperture().outer_radius_mm(), at_axis, 1.0);
  };
  ThirdDifferences sum(b.coefficients(), shape.parameter_of(), weight, rows);
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i + 3 < nx; ++i) sum.add(j * nx + i, 1, row_x.step_mm, share(i + 1.5, j));
  }
  for (int j = 0; j + 3 < ny; ++j) {
    for (int i = 0; i < nx; ++i) sum.add(j * nx + i, nx, row_y.step_mm, share(i, j + 1.5));
  }
  return sum.cost();
}

}  // namespace lucerna
