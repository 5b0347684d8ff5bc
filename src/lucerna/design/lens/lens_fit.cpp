// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "lucerna/design/constraints/limits.h"
#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/fit/approach.h"
#include "lucerna/design/lens/lens_evaluation.h"
#include "lucerna/design/lens/lens_start.h"
#include "lucerna/design/solver/levenberg_marquardt.h"
#include "lucerna/random.h"

namespace lucerna {

namespace {

/// Longest way of a corner in one step, over the lens's radius, and the size of a perturbation.
constexpr double kLongestCornerMove = 0.05, kPerturbation = 0.01;
/// A stage ends after two steps that gained less than this share each, or so many refused in a row.
constexpr double kLittleGain = 0.02;
constexpr int kMostRefused = 5, kMostSteps = 40;
/// What of the source may be within the lens beyond what the given one holds.
constexpr double kMaxWithin = 1e-3;
constexpr std::uint64_t kWithinRays = 4096;
/// A restart goes on only if its coarse stages end this much below the best's, squared error.
constexpr double kBetter = 0.95;

struct LensStage {
  int bins;
  std::uint64_t rays;
};

struct LensPoint {
  LensShape shape;
  Evaluation light;
  NormalEquations equations;
};

/// The problem in the bins and rays of one stage.
class LensStageObjective {
 public:
  LensStageObjective(const LensProblem& problem, const LensStage& stage, DesignRays& rays,
                     const std::vector<double>& signs, double flux_reference, double given_within)
      : problem_(problem),
        rays_(rays),
        signs_(signs),
        bins_(rebinned(lens_window(problem), 1.0, stage.bins)),
        target_(target_flux(problem.target, problem.world_from_lens, rays.flux())(bins_)),
        flux_reference_(flux_reference),
        given_within_(given_within) {
    rays.grow(stage.rays);
    options_.rays = stage.rays;
    options_.edge_mm = kEdgeShare * problem.start.radius_mm();
  }

  LensPoint at(const LensShape& shape) const {
    LensPoint out{shape, {}, {}};
    out.equations.cost = std::numeric_limits<double>::infinity();
    if (!shape.is_valid()) return out;
    if (share_within(shape, rays_, kWithinRays) > given_within_ + kMaxWithin) return out;
    out.light = evaluate_lens(shape, problem_.medium, rays_, bins_, options_);
    out.equations = normal_equations(out.light, target_, bins_, problem_.target.mode);
    ResidualRows rows;
    out.equations.cost += lens_limits_cost(problem_.limits, shape, signs_, rows);
    rows.add_to(out.equations);
    if (problem_.target.mode == TargetMode::shape)
      add_flux_term(out.light, kFitFluxWeight, flux_reference_, out.equations);
    return out;
  }

  BinError error(const LensPoint& p) const {
    return bin_error(p.light, target_, bins_, problem_.target.mode);
  }
  std::uint64_t rays() const { return options_.rays; }

 private:
  const LensProblem& problem_;
  DesignRays& rays_;
  const std::vector<double>& signs_;
  TentBins bins_;
  Eigen::VectorXd target_;
  double flux_reference_, given_within_;
  LensEvaluationOptions options_;
};

/// All of a fit between its steps.
class LensFit {
 public:
  LensFit(const LensProblem& problem, const LensFitOptions& options, DesignRays& rays,
          const LensFitWatcher& watch)
      : problem_(problem),
        options_(options),
        rays_(rays),
        watch_(watch),
        signs_(draft_signs(problem.start)),
        result_(problem.start) {
    rays_.grow(std::uint64_t{1} << 16);
    given_within_ = share_within(problem.start, rays_, kWithinRays);
    LensEvaluationOptions plain;
    plain.derivatives = false;
    const Evaluation start = evaluate_lens(problem.start, problem.medium, rays_, lens_window(problem), plain);
    flux_reference_ = start.reflected + start.direct;
    const int least = static_cast<int>(problem.start.parameter_count()) + 6;
    const bool rings = lens_window(problem).is_rings();
    const auto rays_of = [&](int log2) { return std::min(options.max_rays, std::uint64_t{1} << log2); };
    const int coarse = rings ? std::max(24, std::min(least, 48)) : 24;
    stages_ = {{coarse, rays_of(15)}, {48, rays_of(17)}, {48, rays_of(20)}, {48, rays_of(22)}};
    while (stages_.size() > 1 && stages_[stages_.size() - 2].rays == stages_.back().rays &&
           stages_[stages_.size() - 2].bins == stages_.back().bins)
      stages_.pop_back();
  }

  LensFitResult run() {
    std::vector<LensShape> guesses{problem_.start};
    for (LensShape& s : zero_etendue_lenses(problem_.start, problem_.medium, rays_,
                                            target_flux(problem_.target, problem_.world_from_lens, 1.0)))
      guesses.push_back(std::move(s));
    const std::size_t coarse = std::min<std::size_t>(2, stages_.size());
    std::vector<std::pair<double, LensShape>> begun;
    for (const LensShape& guess : guesses) {
      LensShape shape = guess;
      const double cost = through(shape, 0, coarse);
      begun.emplace_back(cost, shape);
      if (stopped_) break;
    }
    const auto best = std::min_element(begun.begin(), begun.end(),
                                       [](const auto& a, const auto& b) { return a.first < b.first; });
    coarse_cost_ = best->first;
    keep(best->second, best->first);
    finish(best->second, coarse);
    for (int failed = 0, k = 0; !stopped_ && !result_.at_noise; ++k) {
      if (failed >= problem_.max_failed_restarts) break;
      failed = restart(k, coarse) ? 0 : failed + 1;
    }
    return std::move(result_);
  }

 private:
  /// Fine stages from a shape; keeps it where it is the best.
  bool finish(LensShape shape, std::size_t first) {
    bool noise = false;
    const double cost = through(shape, first, stages_.size(), &noise);
    if (!(cost < fine_cost_)) return false;
    const bool gained = cost < 0.97 * fine_cost_;
    fine_cost_ = cost;
    result_.shape = std::move(shape);
    result_.at_noise = noise;
    return gained;
  }

  bool restart(int k, std::size_t coarse) {
    Rng rng(options_.seed ^ 0x4C454E53ull, static_cast<std::uint64_t>(k));
    const double size = kPerturbation * problem_.start.radius_mm() * (k % 3 == 2 ? 3.0 : 1.0);
    Eigen::VectorXd p = result_.shape.parameters();
    for (double& x : p) x += size * (2.0 * rng.uniform() - 1.0);
    LensShape shape = problem_.start.with(p);
    if (!shape.is_valid()) return false;
    const double cost = through(shape, 0, coarse);
    if (stopped_ || !(cost < kBetter * coarse_cost_)) return false;
    coarse_cost_ = cost;
    return finish(shape, coarse);
  }

  /// The best so far before any shape has been through the fine stages.
  void keep(const LensShape& shape, double cost) {
    if (cost < std::numeric_limits<double>::infinity()) result_.shape = shape;
  }

  /// Takes `shape` through stages; returns the cost at the end of the last.
  double through(LensShape& shape, std::size_t first, std::size_t last, bool* at_noise = nullptr) {
    double cost = std::numeric_limits<double>::infinity();
    for (std::size_t s = first; s < last && !stopped_; ++s) {
      const LensStageObjective& objective = objective_of(s);
      LensPoint now = objective.at(shape);
      count(objective, now, static_cast<int>(s), 0, 0.0, true);
      if (!std::isfinite(now.equations.cost)) return now.equations.cost;
      steps(objective, now, static_cast<int>(s));
      shape = now.shape;
      cost = now.equations.cost;
      const BinError error = objective.error(now);
      if (at_noise != nullptr)
        *at_noise = error.relative_rms * error.relative_rms <= 1.21 * error.floor * error.floor;
    }
    return cost;
  }

  /// Made when it is first asked for: the target in bins takes as long as an evaluation.
  const LensStageObjective& objective_of(std::size_t stage) {
    objectives_.resize(stages_.size());
    if (objectives_[stage] == nullptr) {
      objectives_[stage] = std::make_unique<LensStageObjective>(problem_, stages_[stage], rays_, signs_,
                                                                flux_reference_, given_within_);
    }
    return *objectives_[stage];
  }

  void steps(const LensStageObjective& objective, LensPoint& now, int stage) {
    double lambda = 1e-3;
    const double longest = kLongestCornerMove * problem_.start.radius_mm();
    for (int step = 1, small = 0, refused = 0; step <= kMostSteps && !stopped_; ++step) {
      const double before = now.equations.cost;
      const Eigen::VectorXd diagonal = now.equations.hessian.diagonal();
      const Eigen::VectorXd metric = diagonal.array() + 1e-2 * diagonal.mean() + 1e-300;
      const Eigen::VectorXd from = now.shape.parameters();
      const LevenbergMarquardtStep made = levenberg_marquardt_step(
          now, Eigen::MatrixXd(metric.asDiagonal()), lambda, longest,
          [&](const Eigen::VectorXd& move) { return objective.at(problem_.start.with(from + move)); });
      lambda = made.next_lambda;
      count(objective, now, stage, step, made.tried_lambda, made.accepted);
      refused = made.accepted ? 0 : refused + 1;
      if (refused >= kMostRefused || lambda >= kMaxLambda) return;
      if (!made.accepted) continue;
      small = before - now.equations.cost < kLittleGain * before ? small + 1 : 0;
      if (small == 2) return;
    }
  }

  void count(const LensStageObjective& objective, const LensPoint& now, int stage, int step, double lambda,
             bool accepted) {
    ++result_.evaluations;
    result_.rays += objective.rays();
    FitRecord r;
    r.stage = stage;
    r.step = step;
    r.rays = objective.rays();
    r.total_rays = result_.rays;
    r.evaluations = result_.evaluations;
    r.lambda = lambda;
    r.accepted = accepted;
    if (std::isfinite(now.equations.cost)) {
      const BinError error = objective.error(now);
      r.error = error.relative_rms;
      r.floor = error.floor;
      r.efficiency = now.light.reflected + now.light.direct;
    }
    result_.history.push_back(r);
    if (!watch_(r, std::isfinite(fine_cost_) ? result_.shape : now.shape)) {
      stopped_ = true;
      result_.end = DesignTermination::time;
    }
  }

  const LensProblem& problem_;
  LensFitOptions options_;
  DesignRays& rays_;
  const LensFitWatcher& watch_;
  std::vector<double> signs_;
  std::vector<LensStage> stages_;
  std::vector<std::unique_ptr<LensStageObjective>> objectives_;
  double flux_reference_ = 1.0, given_within_ = 0.0;
  double coarse_cost_ = std::numeric_limits<double>::infinity();
  double fine_cost_ = std::numeric_limits<double>::infinity();
  bool stopped_ = false;
  LensFitResult result_;
};

}  // namespace

LensFitResult fit_lens(const LensProblem& problem, const LensFitOptions& options, DesignRays& rays,
                       const LensFitWatcher& watch) {
  return LensFit(problem, options, rays, watch).run();
}

}  // namespace lucerna
