// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/comparison/transport.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// The transportation problem as a network simplex: nodes 0..m-1 supply, m..m+n-1 demand, tree arcs carry the
/// flow.
class TransportSimplex {
 public:
  TransportSimplex(const std::vector<DirectionMass>& from, const std::vector<DirectionMass>& to)
      : m_(from.size()),
        n_(to.size()),
        cost_(m_ * n_),
        tree_(m_ + n_),
        parent_(m_ + n_, -1),
        depth_(m_ + n_, 0),
        potential_(m_ + n_, 0.0) {
    for (std::size_t i = 0; i < m_; ++i) {
      for (std::size_t j = 0; j < n_; ++j)
        cost_[i * n_ + j] = angle_between(from[i].direction, to[j].direction);
    }
    start(from, to);
  }

  double solve() {
    hang(0, -1);
    // Every pivot of a problem without degeneracy lowers the cost; the limit only guards against rounding.
    const std::size_t limit = 200 * (m_ + n_) + 1000;
    for (std::size_t pivot = 0; pivot < limit; ++pivot) {
      const std::size_t entering = price();
      if (entering == kNone) break;
      turn(entering);
    }
    double total = 0.0;
    for (const Arc& arc : arcs_) total += arc.flow * cost_[arc.from * n_ + arc.to];
    return total;
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  struct Arc {
    std::size_t from, to;  ///< supply index, demand index
    double flow;
  };

  /// North-west corner rule: a tree of m + n - 1 arcs.
  void start(const std::vector<DirectionMass>& from, const std::vector<DirectionMass>& to) {
    double supply_sum = 0.0, demand_sum = 0.0;
    std::vector<double> supply, demand;
    for (const auto& each : from) supply_sum += each.mass;
    for (const auto& each : to) demand_sum += each.mass;
    for (std::size_t i = 0; i < m_; ++i) {
      const double perturbation = 1.0 + 1e-9 * static_cast<double>((i * 2654435761u) % 1024) / 1024.0;
      supply.push_back(from[i].mass / supply_sum * perturbation);
    }
    double total = 0.0;
    for (const double s : supply) total += s;
    for (std::size_t j = 0; j < n_; ++j) demand.push_back(to[j].mass / demand_sum * total);
    scale_ = 0.5 * (supply_sum + demand_sum) / total;
    for (std::size_t i = 0, j = 0; i < m_ && j < n_;) {
      const double flow = std::max(0.0, std::min(supply[i], demand[j]));
      add_arc({i, j, flow * scale_});
      supply[i] -= flow;
      demand[j] -= flow;
      if (j + 1 == n_ || (i + 1 < m_ && supply[i] <= demand[j])) {
        ++i;
      } else {
        ++j;
      }
    }
  }

  void add_arc(const Arc& arc) {
    tree_[arc.from].push_back(arcs_.size());
    tree_[m_ + arc.to].push_back(arcs_.size());
    arcs_.push_back(arc);
  }

  std::size_t other_end(std::size_t arc, std::size_t node) const {
    return node < m_ ? m_ + arcs_[arc].to : arcs_[arc].from;
  }

  /// Hangs the part of the tree beyond `arc` (-1: all) on it, from `root`: parents, depths, potentials.
  void hang(std::size_t root, std::ptrdiff_t arc) {
    parent_[root] = arc;
    stack_.assign(1, root);
    while (!stack_.empty()) {
      const std::size_t node = stack_.back();
      stack_.pop_back();
      if (parent_[node] >= 0) {
        const auto up = static_cast<std::size_t>(parent_[node]);
        const std::size_t above = other_end(up, node);
        const double c = cost_[arcs_[up].from * n_ + arcs_[up].to];
        depth_[node] = depth_[above] + 1;
        potential_[node] = c - potential_[above];  // u + v = c on the tree
      } else {
        depth_[node] = 0;
        potential_[node] = 0.0;
      }
      for (const std::size_t next : tree_[node]) {
        if (static_cast<std::ptrdiff_t>(next) == parent_[node]) continue;
        const std::size_t below = other_end(next, node);
        parent_[below] = static_cast<std::ptrdiff_t>(next);
        stack_.push_back(below);
      }
    }
  }

  /// The arc (i * n + j) of the most negative reduced cost in the next rows that have one, or none.
  std::size_t price() {
    constexpr double kTolerance = 1e-12;
    constexpr std::size_t kRows = 16;
    double best = -kTolerance;
    std::size_t entering = kNone;
    for (std::size_t scanned = 0; scanned < m_; ++scanned) {
      const std::size_t i = next_row_;
      next_row_ = next_row_ + 1 == m_ ? 0 : next_row_ + 1;
      const double u = potential_[i];
      const double* row = &cost_[i * n_];
      for (std::size_t j = 0; j < n_; ++j) {
        const double reduced = row[j] - u - potential_[m_ + j];
        if (reduced < best) {
          best = reduced;
          entering = i * n_ + j;
        }
      }
      if (entering != kNone && scanned % kRows == kRows - 1) break;
    }
    return entering;
  }

  /// Sends flow round the cycle that the entering arc closes and drops the arc that runs empty.
  void turn(std::size_t entering) {
    const std::size_t i = entering / n_, j = entering % n_;
    // Up from both ends to where they meet. Going from the supply end, the first arc loses flow, then by
    // turns.
    std::size_t a = i, b = m_ + j;
    up_a_.clear();
    up_b_.clear();
    while (a != b) {
      std::size_t& low = depth_[a] >= depth_[b] ? a : b;
      auto& path = depth_[a] >= depth_[b] ? up_a_ : up_b_;
      const auto arc = static_cast<std::size_t>(parent_[low]);
      path.push_back(arc);
      low = other_end(arc, low);
    }
    double flow = std::numeric_limits<double>::infinity();
    std::size_t leaving = kNone;
    bool on_a = true;
    for (const auto* path : {&up_a_, &up_b_}) {
      for (std::size_t k = 0; k < path->size(); k += 2) {
        if (arcs_[(*path)[k]].flow < flow) {
          flow = arcs_[(*path)[k]].flow;
          leaving = (*path)[k];
          on_a = path == &up_a_;
        }
      }
    }
    LUCERNA_CHECK(leaving != kNone, "cycle without an arc to empty");
    for (const auto* path : {&up_a_, &up_b_}) {
      for (std::size_t k = 0; k < path->size(); ++k) arcs_[(*path)[k]].flow += k % 2 == 0 ? -flow : flow;
    }
    for (const std::size_t node : {arcs_[leaving].from, m_ + arcs_[leaving].to}) {
      auto& list = tree_[node];
      list.erase(std::find(list.begin(), list.end(), leaving));
    }
    arcs_[leaving] = {i, j, flow};
    tree_[i].push_back(leaving);
    tree_[m_ + j].push_back(leaving);
    // The end on whose side the arc was lost has come loose.
    hang(on_a ? i : m_ + j, static_cast<std::ptrdiff_t>(leaving));
  }

  std::size_t m_, n_;
  double scale_ = 1.0;
  std::vector<double> cost_;
  std::vector<Arc> arcs_;
  std::vector<std::vector<std::size_t>> tree_;
  std::vector<std::ptrdiff_t> parent_;
  std::vector<std::size_t> depth_;
  std::vector<double> potential_;
  std::vector<std::size_t> up_a_, up_b_, stack_;
  std::size_t next_row_ = 0;
};

/// A range of masses, and how it would be split.
struct Group {
  std::size_t from, to;
  double weight;  ///< mass times extent
  int axis;
  bool operator<(const Group& other) const { return weight < other.weight; }
};

std::array<double, 3> components(const Direction& d) { return {d.x(), d.y(), d.z()}; }

Group group_of(const std::vector<DirectionMass>& masses, std::size_t from, std::size_t to) {
  double mass = 0.0;
  std::array<double, 3> sum{}, squares{};
  for (std::size_t i = from; i < to; ++i) {
    const auto c = components(masses[i].direction);
    mass += masses[i].mass;
    for (std::size_t k = 0; k < 3; ++k) {
      sum[k] += masses[i].mass * c[k];
      squares[k] += masses[i].mass * c[k] * c[k];
    }
  }
  Group group{from, to, 0.0, 0};
  double widest = -1.0, spread = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double variance = std::max(0.0, squares[k] / mass - sum[k] * sum[k] / (mass * mass));
    spread += variance;
    if (variance > widest) {
      widest = variance;
      group.axis = static_cast<int>(k);
    }
  }
  group.weight = to - from > 1 ? mass * std::sqrt(spread) : 0.0;
  return group;
}

}  // namespace

double transport_cost_rad(const std::vector<DirectionMass>& from, const std::vector<DirectionMass>& to) {
  if (from.empty() || to.empty()) return 0.0;
  return TransportSimplex(from, to).solve();
}

std::vector<DirectionMass> clustered(std::vector<DirectionMass> masses, std::size_t limit) {
  LUCERNA_CHECK(limit > 0, "limit {}", limit);
  if (masses.size() <= limit) return masses;
  std::priority_queue<Group> groups;
  groups.push(group_of(masses, 0, masses.size()));
  while (groups.size() < limit && groups.top().weight > 0.0) {
    const Group group = groups.top();
    groups.pop();
    const std::size_t middle = group.from + (group.to - group.from) / 2;
    const auto at = [&](std::size_t i) { return masses.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto axis = static_cast<std::size_t>(group.axis);
    std::nth_element(at(group.from), at(middle), at(group.to),
                     [&](const DirectionMass& a, const DirectionMass& b) {
                       return components(a.direction)[axis] < components(b.direction)[axis];
                     });
    groups.push(group_of(masses, group.from, middle));
    groups.push(group_of(masses, middle, group.to));
  }
  std::vector<DirectionMass> result;
  for (; !groups.empty(); groups.pop()) {
    Vec3 sum;
    double mass = 0.0;
    for (std::size_t i = groups.top().from; i < groups.top().to; ++i) {
      sum += masses[i].mass * masses[i].direction.vec();
      mass += masses[i].mass;
    }
    const bool opposed = length(sum) < 1e-9 * mass;
    result.push_back({opposed ? masses[groups.top().from].direction : Direction::from(sum), mass});
  }
  return result;
}

}  // namespace lucerna
