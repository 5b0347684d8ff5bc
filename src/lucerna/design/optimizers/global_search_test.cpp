// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/optimizers/global_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/design/optimizers/gaussian.h"
#include "lucerna/design/optimizers/hooke_jeeves.h"

namespace lucerna {
namespace {

using Function = double (*)(const Eigen::VectorXd&);

constexpr GlobalMethod kMethods[] = {GlobalMethod::tree, GlobalMethod::annealing, GlobalMethod::cma_es,
                                     GlobalMethod::direct};

BatchCost batch(Function f, std::vector<Eigen::VectorXd>* seen = nullptr) {
  return [f, seen](const std::vector<Eigen::VectorXd>& points) {
    std::vector<double> costs;
    for (const Eigen::VectorXd& p : points) {
      costs.push_back(f(p));
      if (seen != nullptr) seen->push_back(p);
    }
    return costs;
  };
}

/// A narrow bowl, its axes turned and of lengths 1 to 30.
double bowl(const Eigen::VectorXd& x) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double along = x[i] + 0.5 * x[(i + 1) % x.size()] - 0.31 - 0.1 * static_cast<double>(i);
    sum += std::pow(30.0, 2.0 * static_cast<double>(i) / static_cast<double>(x.size())) * along * along;
  }
  return sum;
}

/// Rastrigin: a bowl full of holes, 10 apart from each other in cost.
double holes(const Eigen::VectorXd& x) {
  double sum = 0.0;
  for (const double v : x) {
    const double u = 2.0 * (v - 0.37);
    sum += u * u + 10.0 * (1.0 - std::cos(2.0 * std::numbers::pi * u));
  }
  return sum;
}

SearchBox box(Eigen::Index n) {
  return {Eigen::VectorXd::Constant(n, 0.2), Eigen::VectorXd::Constant(n, 2.0)};
}

double by_chance(Function f, Eigen::Index n, int evaluations, std::uint64_t seed) {
  Rng rng(seed, 0);
  double best = 1e300;
  for (int i = 0; i < evaluations; ++i) {
    best = std::min(best, f(box(n).centre + 2.0 * uniform_vector(rng, n)));
  }
  return best;
}

TEST(GlobalSearch, EveryMethodBeatsChance) {
  for (const Function f : {&bowl, &holes}) {
    for (const GlobalMethod method : kMethods) {
      double ours = 0.0, chance = 0.0;
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        // As many holes as the budget can look into; the division needs 27 cells a side to see one.
        const Eigen::Index n = f == &bowl ? 5 : (method == GlobalMethod::direct ? 2 : 3);
        const int budget = n == 3 ? 2000 : 3000;
        ours += global_search(method, box(n), {seed, budget}, batch(f)).cost;
        chance += by_chance(f, n, budget, seed);
      }
      EXPECT_LT(ours, 0.5 * chance) << to_string(method) << (f == &bowl ? ", bowl" : ", holes");
    }
  }
}

TEST(GlobalSearch, CmaEsConvergesOnANarrowBowl) {
  EXPECT_LT(global_search(GlobalMethod::cma_es, box(8), {3, 4000}, batch(&bowl)).cost, 1e-6);
}

TEST(GlobalSearch, SpendsTheBudgetAndStaysInTheBox) {
  for (const GlobalMethod method : kMethods) {
    for (const int budget : {1, 7, 500}) {
      std::vector<Eigen::VectorXd> seen;
      const GlobalSearchResult result = global_search(method, box(3), {1, budget}, batch(&holes, &seen));
      EXPECT_EQ(seen.size(), static_cast<std::size_t>(budget)) << to_string(method);
      EXPECT_EQ(result.evaluations, budget);
      EXPECT_EQ(seen[0], box(3).centre);
      double min = 1e300;
      for (const Eigen::VectorXd& p : seen) {
        EXPECT_LE((p - box(3).centre).cwiseAbs().maxCoeff(), 2.0 + 1e-12) << to_string(method);
        min = std::min(min, holes(p));
      }
      EXPECT_EQ(result.cost, min);
      EXPECT_EQ(holes(result.best), min);
    }
  }
}

/// What resuming rests on: the same costs lead to the same questions, and no other state is needed.
TEST(GlobalSearch, AsksTheSameAgain) {
  for (const GlobalMethod method : kMethods) {
    std::vector<Eigen::VectorXd> once, again, other;
    global_search(method, box(4), {7, 400}, batch(&holes, &once));
    global_search(method, box(4), {7, 400}, batch(&holes, &again));
    EXPECT_EQ(once, again) << to_string(method);
    if (method == GlobalMethod::direct) continue;  // it has no chance in it
    global_search(method, box(4), {8, 400}, batch(&holes, &other));
    EXPECT_NE(once, other) << to_string(method);
  }
}

TEST(GlobalSearch, ShapesThatCannotBeAreWorseThanAny) {
  const BatchCost half = [](const std::vector<Eigen::VectorXd>& points) {
    std::vector<double> costs;
    for (const Eigen::VectorXd& p : points) costs.push_back(p[0] > 0.3 ? std::nan("") : bowl(p));
    return costs;
  };
  for (const GlobalMethod method : kMethods) {
    const GlobalSearchResult r = global_search(method, box(3), {1, 600}, half);
    EXPECT_TRUE(std::isfinite(r.cost)) << to_string(method);
    EXPECT_LE(r.best[0], 0.3) << to_string(method);
  }
}

TEST(HookeJeeves, FindsTheBottomOfABowl) {
  HookeJeeves search(Eigen::VectorXd::Constant(3, 1.0), bowl(Eigen::VectorXd::Constant(3, 1.0)), 0.25);
  int asked = 0;
  for (std::vector<Eigen::VectorXd> points = search.ask(); !points.empty(); points = search.ask()) {
    std::vector<double> costs;
    for (const Eigen::VectorXd& p : points) costs.push_back(bowl(p));
    asked += static_cast<int>(points.size());
    search.tell(costs);
  }
  EXPECT_EQ(search.cost(), bowl(search.best()));
  EXPECT_LT(search.cost(), 0.01 * bowl(Eigen::VectorXd::Constant(3, 1.0)));
  EXPECT_LT(asked, 2000);
}

}  // namespace
}  // namespace lucerna
