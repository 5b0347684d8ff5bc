// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/roughness.h"

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

  /// Of the four coefficients from `first` on, `stride` apart.
  void add(int first, int stride, double step_mm) {
    constexpr std::array<double, 4> kThird{-1.0, 3.0, -3.0, 1.0};
    const double per = std::sqrt(weight_) / step_mm;
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

double roughness(const DesignShape& shape, double weight, ResidualRows* rows) {
  if (!(weight > 0.0)) return 0.0;
  if (const auto* r = std::get_if<RevolutionShape>(&shape.family())) {
    ThirdDifferences sum(r->coefficients(), shape.parameter_of(), weight, rows);
    for (int i = 0; i + 3 < r->row().coefficients(); ++i) sum.add(i, 1, r->row().step_mm);
    return sum.cost();
  }
  const auto& b = std::get<BsplineShape>(shape.family());
  const int nx = b.row_x().coefficients(), ny = b.row_y().coefficients();
  ThirdDifferences sum(b.coefficients(), shape.parameter_of(), weight, rows);
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i + 3 < nx; ++i) sum.add(j * nx + i, 1, b.row_x().step_mm);
  }
  for (int j = 0; j + 3 < ny; ++j) {
    for (int i = 0; i < nx; ++i) sum.add(j * nx + i, nx, b.row_y().step_mm);
  }
  return sum.cost();
}

}  // namespace lucerna
