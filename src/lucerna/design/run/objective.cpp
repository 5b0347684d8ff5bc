// SPDX-License-Identifier: Apache-2.0
#include "lucerna/objective.h"

#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/fit/missing_light.h"
#include "lucerna/design/run/design.h"
#include "lucerna/design/run/design_problem.h"
#include "lucerna/design/solver/least_squares.h"
#include "lucerna/design/solver/residual_rows.h"

namespace lucerna {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Rows = Eigen::Map<RowMajor>;

/// The rows of the bins: residual and derivatives, the best scale among them.
void add_bins(const Evaluation& light, const Eigen::VectorXd& target, const Eigen::VectorXd& weights,
              TargetMode mode, double scale, double* residuals, Rows* jacobian) {
  const Eigen::VectorXd root = weights.cwiseSqrt() / std::sqrt(weights.dot(target.cwiseAbs2()));
  Eigen::Map<Eigen::VectorXd>(residuals, root.size()) = root.cwiseProduct(scale * light.flux - target);
  if (jacobian == nullptr) return;
  auto rows = jacobian->topRows(root.size());
  rows.noalias() = (scale * root).asDiagonal() * light.jacobian;
  if (mode == TargetMode::absolute) return;
  // s = <F, T> / <F, F>, so that ds = (<dF, T> - 2 s <dF, F>) / <F, F>.
  const double own = weights.dot(light.flux.cwiseAbs2());
  if (!(own > 0.0)) return;
  const Eigen::VectorXd pull = weights.cwiseProduct(target - 2.0 * scale * light.flux) / own;
  const Eigen::RowVectorXd slope = pull.transpose() * light.jacobian;
  rows.noalias() += root.cwiseProduct(light.flux) * slope;
}

}  // namespace

struct Objective::Problem {
  DesignProblem design;
  ObjectiveOptions options;
  DesignRays rays;
  FitProblem fit;
  Eigen::VectorXd target, weights;

  Problem(DesignProblem given, const ObjectiveOptions& how, Progress& progress)
      : design(std::move(given)),
        options(how),
        rays(design_rays(design, {}, how.seed)),
        fit(fit_problem(design, {}, rays)),
        target(fit.target(fit.bins)),
        weights(bin_weights(fit.bins)) {
    rays.grow(how.rays, progress);
  }

  bool has_flux() const { return fit.flux_weight > 0.0; }
  std::size_t residuals() const { return fit.bins.size() + (has_flux() ? 1 : 0) + (fit.limits ? 1 : 0); }

  DesignShape shape(std::span<const double> parameters) const {
    const std::size_t n = design.start.parameter_count();
    if (parameters.size() != n) {
      throw InputError(fmt::format("parameters: found {} numbers, expected {}", parameters.size(), n));
    }
    for (const double p : parameters) {
      if (!std::isfinite(p))
        throw InputError(fmt::format("parameters: found {}, expected finite numbers", p));
    }
    return design.start.with(
        Eigen::Map<const Eigen::VectorXd>(parameters.data(), static_cast<Eigen::Index>(n)));
  }

  EvaluationOptions evaluation(const DesignShape& at, bool derivatives) const {
    EvaluationOptions out;
    out.rays = rays.size();
    out.derivatives = derivatives;
    out.direct_light = fit.direct_light;
    out.rim_mm = options.rim_mm.value_or(kRimShare * at.radius_mm());
    return out;
  }

  /// What breaking the limits costs, as one residual.
  void add_limits(const DesignShape& at, double& residual, Rows* jacobian) const {
    ResidualRows rows;
    residual = std::sqrt(fit.limits_cost(at, rays.size(), jacobian != nullptr ? &rows : nullptr));
    if (jacobian == nullptr || !(residual > 0.0)) return;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(at.parameter_count()));
    rows.add_gradient_to(gradient);
    jacobian->row(jacobian->rows() - 1) = gradient.transpose() / residual;
  }
};

Objective::Objective(Project project, const std::string& name, const ObjectiveOptions& options,
                     Progress& progress) {
  if (options.rays == 0 || options.rays > kMaxRays)
    throw InputError(fmt::format("rays: found {}, expected 1 to {}", options.rays, kMaxRays),
                     ErrorCause::out_of_range);
  if (options.rim_mm && !(*options.rim_mm >= 0.0 && std::isfinite(*options.rim_mm)))
    throw InputError(fmt::format("rim_mm: found {}, expected a finite number >= 0", *options.rim_mm),
                     ErrorCause::out_of_range);
  DesignProblem problem = design_problem(std::move(project), name);
  if (problem.target.zones_only)
    throw InputError(fmt::format("{}: target: found zones alone, expected a file", name));
  problem_ = std::make_unique<const Problem>(std::move(problem), options, progress);
}

Objective::~Objective() = default;
Objective::Objective(Objective&&) noexcept = default;
Objective& Objective::operator=(Objective&&) noexcept = default;

std::size_t Objective::parameter_count() const { return problem_->design.start.parameter_count(); }
std::size_t Objective::residual_count() const { return problem_->residuals(); }

std::vector<double> Objective::start() const {
  const Eigen::VectorXd& p = problem_->design.start.parameters();
  return {p.data(), p.data() + p.size()};
}

ObjectiveValue Objective::at(std::span<const double> parameters, bool jacobian) const {
  const Problem& p = *problem_;
  const DesignShape shape = p.shape(parameters);
  const Evaluation light =
      evaluate(shape, p.fit.reflectance, p.rays, p.fit.bins, p.evaluation(shape, jacobian));
  const BinError error = bin_error(light, p.target, p.fit.bins, p.fit.mode);
  ObjectiveValue out;
  out.relative_rms = error.relative_rms;
  out.floor = error.floor;
  out.scale = error.scale;
  out.efficiency = light.reflected + light.direct;
  const std::size_t rows = p.residuals(), columns = parameters.size(), bins = p.fit.bins.size();
  out.residuals.resize(rows);
  if (jacobian) out.jacobian.resize(rows * columns);
  Rows slopes(out.jacobian.data(), static_cast<Eigen::Index>(jacobian ? rows : 0),
              static_cast<Eigen::Index>(columns));
  Rows* const j = jacobian ? &slopes : nullptr;
  add_bins(light, p.target, p.weights, p.fit.mode, error.scale, out.residuals.data(), j);
  if (p.has_flux()) {
    const double root = std::sqrt(p.fit.flux_weight);
    const double missing = missing_light(light.flux.sum(), p.fit.flux_reference);
    out.residuals[bins] = root * missing;
    if (jacobian && missing > 0.0)
      slopes.row(static_cast<Eigen::Index>(bins)) =
          light.jacobian.colwise().sum() * (-root / p.fit.flux_reference);
  }
  if (p.fit.limits) p.add_limits(shape, out.residuals.back(), j);
  return out;
}

Reflector Objective::reflector(std::span<const double> parameters) const {
  return problem_->shape(parameters).reflector();
}

std::string Objective::project_text(std::span<const double> parameters) const {
  return lucerna::project_text(with_shape(problem_->design, problem_->shape(parameters)));
}

}  // namespace lucerna
