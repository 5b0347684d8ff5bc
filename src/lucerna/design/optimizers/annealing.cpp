// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "lucerna/design/optimizers/gaussian.h"
#include "lucerna/design/optimizers/global_search.h"

namespace lucerna::detail {

namespace {

constexpr std::size_t kChains = 8;
/// Random points whose scatter sets the first temperature.
constexpr int kProbes = 24;
/// Share of proposals that a chain's step length aims to have accepted.
constexpr double kAccepted = 0.3;

struct Chain {
  Rng rng;
  Eigen::VectorXd at, proposal;
  double cost = 0.0;
  double step = 0.3;
};

/// A few coordinates at a time: most moves of all at once are bad.
void propose(Chain& chain) {
  const Eigen::Index n = chain.at.size();
  const double share = std::min(1.0, 4.0 / static_cast<double>(n));
  chain.proposal = chain.at;
  bool moved = false;
  while (!moved) {
    for (double& x : chain.proposal) {
      if (chain.rng.uniform() >= share) continue;
      x += chain.step * gaussian(chain.rng);
      moved = true;
    }
  }
  for (double& x : chain.proposal) {  // the walls of the box are mirrors
    x = std::abs(std::fmod(std::abs(x + 1.0), 4.0) - 2.0);
    x = 1.0 - x;
  }
}

}  // namespace

void anneal(GlobalSearchRun& run) {
  std::vector<Chain> chains;
  Rng rng(run.seed(), 0, 0x5a);
  std::vector<Eigen::VectorXd> probes;
  for (int i = 0; i < kProbes; ++i) probes.push_back(0.5 * uniform_vector(rng, run.size()));
  const std::vector<double> costs = run.costs(probes);
  double mean = 0.0, square = 0.0, count = 0.0;
  for (const double c : costs) {
    if (!std::isfinite(c)) continue;
    mean += c;
    square += c * c;
    count += 1.0;
  }
  if (count == 0.0) return;
  mean /= count;
  const double hot = std::max(1e-3 * mean, std::sqrt(std::max(0.0, square / count - mean * mean)));
  for (std::size_t k = 0; k < kChains; ++k) {
    chains.push_back({Rng(run.seed(), k + 1, 0x5a), run.best_point(), {}, run.best().cost});
  }
  while (!run.spent()) {
    const double temperature = hot * std::pow(1e-4, run.used());
    std::vector<Eigen::VectorXd> points;
    for (Chain& c : chains) {
      propose(c);
      points.push_back(c.proposal);
    }
    const std::vector<double> now = run.costs(points);
    for (std::size_t k = 0; k < chains.size(); ++k) {
      Chain& c = chains[k];
      const bool accepted = std::log(1.0 - c.rng.uniform()) * temperature <= c.cost - now[k];
      if (accepted) {
        c.at = c.proposal;
        c.cost = now[k];
      }
      c.step = std::min(1.0, std::max(1e-4, c.step * std::exp(0.2 * ((accepted ? 1.0 : 0.0) - kAccepted))));
    }
  }
}

}  // namespace lucerna::detail
