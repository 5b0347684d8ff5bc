// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "lucerna/design/optimizers/gaussian.h"
#include "lucerna/design/optimizers/global_search.h"
#include "lucerna/design/optimizers/hooke_jeeves.h"

namespace lucerna::detail {

namespace {

/// Cells of a parameter's range at a node; they overlap by half, so that no good place lies on a border.
constexpr int kCells = 3;
/// Levels of the tree: ranges are 1, 1/2, 1/4 and 1/8 of the box.
constexpr int kTreeLevels = 4;
/// Branches that go down at once.
constexpr std::size_t kBranches = 4;
/// Evaluations that a local search may take, in sweeps over all parameters.
constexpr int kSweeps = 12;

struct Node {
  Eigen::VectorXd centre;
  double half = 1.0;  ///< of the range of every parameter, in the box's half widths
  /// What was seen in each cell of each parameter's range: the mean cost and how often.
  Eigen::MatrixXd mean, count;
  double min = std::numeric_limits<double>::infinity(), max = 0.0;
  int evaluations = 0;
  Eigen::VectorXd best;
  std::map<std::vector<int>, std::unique_ptr<Node>> children;

  Node(Eigen::VectorXd c, double h)
      : centre(std::move(c)),
        half(h),
        mean(Eigen::MatrixXd::Zero(kCells, centre.size())),
        count(mean),
        best(centre) {}

  void learn(const Eigen::VectorXd& at, double cost) {
    if (!std::isfinite(cost)) return;
    if (cost < min) best = at;
    min = std::min(min, cost);
    max = std::max(max, cost);
    ++evaluations;
    for (Eigen::Index d = 0; d < centre.size(); ++d) {
      const double u = (at[d] - centre[d]) / half;  // -1 to 1
      const int cell = std::clamp(static_cast<int>((u + 1.0) * 0.5 * kCells), 0, kCells - 1);
      double& n = count(cell, d);
      n += 1.0;
      mean(cell, d) += (cost - mean(cell, d)) / n;
    }
  }

  /// One cell of every parameter, the cheaper the likelier; cells not yet seen count as good as the best.
  std::vector<int> choose(Rng& rng) const {
    std::vector<int> cells;
    for (Eigen::Index d = 0; d < centre.size(); ++d) {
      double low = std::numeric_limits<double>::infinity(), high = 0.0;
      for (int c = 0; c < kCells; ++c) {
        if (count(c, d) == 0.0) continue;
        low = std::min(low, mean(c, d));
        high = std::max(high, mean(c, d));
      }
      std::array<double, kCells> weight{};
      double sum = 0.0;
      for (int c = 0; c < kCells; ++c) {
        const double value = count(c, d) > 0.0 ? mean(c, d) : low;
        const double worse = high > low ? (value - low) / (high - low) : 0.0;
        sum += weight[static_cast<std::size_t>(c)] = std::exp(-3.0 * worse);
      }
      double u = rng.uniform() * sum;
      int cell = 0;
      while (cell + 1 < kCells && u >= weight[static_cast<std::size_t>(cell)]) {
        u -= weight[static_cast<std::size_t>(cell)];
        ++cell;
      }
      cells.push_back(cell);
    }
    return cells;
  }

  Node& child(const std::vector<int>& cells) {
    std::unique_ptr<Node>& c = children[cells];
    if (!c) {
      Eigen::VectorXd at = centre;
      for (Eigen::Index d = 0; d < at.size(); ++d) {
        at[d] += 0.5 * half * (cells[static_cast<std::size_t>(d)] - 1);
      }
      c = std::make_unique<Node>(at, 0.5 * half);
    }
    return *c;
  }
};

/// One way down the tree.
struct Branch {
  std::vector<Node*> path;
  std::vector<Eigen::VectorXd> points;
};

void learn(const Branch& branch, const Eigen::VectorXd& at, double cost) {
  for (Node* node : branch.path) node->learn(at, cost);
}

}  // namespace

void search_tree(GlobalSearchRun& run) {
  const auto n = run.size();
  Node root(Eigen::VectorXd::Zero(n), 1.0);
  root.learn(root.centre, run.best().cost);
  const int samples = 4 + static_cast<int>(std::sqrt(static_cast<double>(n)) * 2.0);
  for (std::uint64_t round = 0; !run.spent(); ++round) {
    Rng rng(run.seed(), round, 0x74726565);
    std::vector<Branch> branches(kBranches);
    for (Branch& b : branches) b.path = {&root};
    for (int level = 0; level < kTreeLevels && !run.spent(); ++level) {
      std::vector<Eigen::VectorXd> points;
      for (Branch& b : branches) {
        if (level > 0) b.path.push_back(&b.path.back()->child(b.path.back()->choose(rng)));
        b.points.clear();
        if (b.path.back()->evaluations == 0) b.points.push_back(b.path.back()->centre);
        while (static_cast<int>(b.points.size()) < samples) {
          b.points.push_back(b.path.back()->centre + b.path.back()->half * uniform_vector(rng, n));
        }
        points.insert(points.end(), b.points.begin(), b.points.end());
      }
      const std::vector<double> costs = run.costs(points);
      std::size_t at = 0;
      for (const Branch& b : branches) {
        for (const Eigen::VectorXd& p : b.points) learn(b, p, costs[at++]);
      }
    }
    // Close in from the best place of every branch's last node; what is found counts all the way up.
    std::vector<HookeJeeves> local;
    for (const Branch& b : branches) {
      local.emplace_back(b.path.back()->best, b.path.back()->min, 0.5 * b.path.back()->half);
    }
    for (int i = 0; i < kSweeps * static_cast<int>(n) && !run.spent(); ++i) {
      std::vector<Eigen::VectorXd> points;
      std::vector<std::size_t> count;
      for (const HookeJeeves& l : local) {
        const std::vector<Eigen::VectorXd> asked = l.ask();
        count.push_back(asked.size());
        points.insert(points.end(), asked.begin(), asked.end());
      }
      if (points.empty()) break;
      const std::vector<double> costs = run.costs(points);
      std::size_t at = 0;
      for (std::size_t k = 0; k < local.size(); ++k) {
        local[k].tell({costs.begin() + static_cast<std::ptrdiff_t>(at),
                       costs.begin() + static_cast<std::ptrdiff_t>(at + count[k])});
        at += count[k];
      }
    }
    for (std::size_t k = 0; k < local.size(); ++k) learn(branches[k], local[k].best(), local[k].cost());
  }
}

}  // namespace lucerna::detail
