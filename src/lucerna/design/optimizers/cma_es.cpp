// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "lucerna/design/optimizers/gaussian.h"
#include "lucerna/design/optimizers/global_search.h"

namespace lucerna::detail {

namespace {

/// Weights and rates of Hansen, "The CMA Evolution Strategy: A Tutorial" (2016), for dimension n and
/// population lambda.
struct Rates {
  Eigen::VectorXd weights;
  double mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, chi;

  Rates(double n, int lambda) : weights(lambda / 2) {
    const int mu = lambda / 2;
    for (int i = 0; i < mu; ++i) weights[i] = std::log(0.5 * (lambda + 1)) - std::log(i + 1.0);
    weights /= weights.sum();
    mu_eff = 1.0 / weights.squaredNorm();
    c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
    d_sigma = 1.0 + 2.0 * std::max(0.0, std::sqrt((mu_eff - 1.0) / (n + 1.0)) - 1.0) + c_sigma;
    c_c = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n);
    c_1 = 2.0 / ((n + 1.3) * (n + 1.3) + mu_eff);
    c_mu = std::min(1.0 - c_1, 2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0) * (n + 2.0) + mu_eff));
    chi = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
  }
};

/// One run until it has converged or the budget is spent.
class CmaRun {
 public:
  CmaRun(GlobalSearchRun& run, Rng& rng, int lambda, Eigen::VectorXd mean, double sigma)
      : run_(run),
        rng_(rng),
        lambda_(lambda),
        rates_(static_cast<double>(run.size()), lambda),
        mean_(std::move(mean)),
        sigma_(sigma),
        c_(Eigen::MatrixXd::Identity(run.size(), run.size())),
        basis_(c_),
        scale_(Eigen::VectorXd::Ones(run.size())),
        p_sigma_(Eigen::VectorXd::Zero(run.size())),
        p_c_(p_sigma_) {}

  void go() {
    const auto patience = static_cast<std::size_t>(10 + 30 * run_.size() / lambda_);
    std::vector<double> bests;
    while (!run_.spent()) {
      const double best = generation(bests.size());
      bests.push_back(best);
      if (sigma_ * scale_.maxCoeff() < 1e-5 || scale_.maxCoeff() > 1e7 * scale_.minCoeff()) return;
      if (bests.size() < patience) continue;
      const auto [low, high] =
          std::minmax_element(bests.end() - static_cast<std::ptrdiff_t>(patience), bests.end());
      if (*high - *low <= 1e-3 * std::abs(*low)) return;
    }
  }

 private:
  /// Draws, ranks and learns; the best cost of the generation.
  double generation(std::size_t number) {
    std::vector<Eigen::VectorXd> steps, points;
    for (int i = 0; i < lambda_; ++i) {
      steps.emplace_back(basis_ * scale_.cwiseProduct(gaussian_vector(rng_, run_.size())));
      points.emplace_back(mean_ + sigma_ * steps.back());
    }
    std::vector<double> costs = run_.costs(points);
    // A point outside the box represents the nearest one inside; how far out it is makes it worse.
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::VectorXd out = points[i] - points[i].cwiseMax(-1.0).cwiseMin(1.0);
      costs[i] += std::abs(costs[i]) * out.squaredNorm();
    }
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return costs[a] < costs[b]; });
    learn(steps, order, static_cast<double>(number + 1));
    return costs[order[0]];
  }

  void learn(const std::vector<Eigen::VectorXd>& steps, const std::vector<std::size_t>& order, double age) {
    const Rates& r = rates_;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(run_.size());
    Eigen::MatrixXd spread = Eigen::MatrixXd::Zero(run_.size(), run_.size());
    for (Eigen::Index i = 0; i < r.weights.size(); ++i) {
      const Eigen::VectorXd& s = steps[order[static_cast<std::size_t>(i)]];
      step += r.weights[i] * s;
      spread += r.weights[i] * s * s.transpose();
    }
    mean_ += sigma_ * step;
    const Eigen::VectorXd white = basis_ * (basis_.transpose() * step).cwiseQuotient(scale_);
    p_sigma_ = (1.0 - r.c_sigma) * p_sigma_ + std::sqrt(r.c_sigma * (2.0 - r.c_sigma) * r.mu_eff) * white;
    const double grown = std::sqrt(1.0 - std::pow(1.0 - r.c_sigma, 2.0 * age));
    const auto n = static_cast<double>(run_.size());
    const bool steady = p_sigma_.norm() / grown < (1.4 + 2.0 / (n + 1.0)) * r.chi;
    p_c_ = (1.0 - r.c_c) * p_c_ + (steady ? std::sqrt(r.c_c * (2.0 - r.c_c) * r.mu_eff) : 0.0) * step;
    const double lost = steady ? 0.0 : r.c_1 * r.c_c * (2.0 - r.c_c);
    c_ = (1.0 - r.c_1 - r.c_mu + lost) * c_ + r.c_1 * p_c_ * p_c_.transpose() + r.c_mu * spread;
    sigma_ *= std::exp(r.c_sigma / r.d_sigma * (p_sigma_.norm() / r.chi - 1.0));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(c_);
    basis_ = eigen.eigenvectors();
    scale_ = eigen.eigenvalues().cwiseMax(1e-20).cwiseSqrt();
  }

  GlobalSearchRun& run_;
  Rng& rng_;
  int lambda_;
  Rates rates_;
  Eigen::VectorXd mean_;
  double sigma_;
  Eigen::MatrixXd c_, basis_;
  Eigen::VectorXd scale_, p_sigma_, p_c_;
};

}  // namespace

void cma_es(GlobalSearchRun& run) {
  Rng rng(run.seed(), 0, 0x636d61);
  int lambda = 4 + static_cast<int>(3.0 * std::log(static_cast<double>(run.size())));
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(run.size());
  while (!run.spent()) {
    CmaRun(run, rng, lambda, mean, 0.3).go();
    lambda *= 2;
    mean = 0.7 * uniform_vector(rng, run.size());
  }
}

}  // namespace lucerna::detail
