// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/tree/tree_marginals.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/rayset/comparison/view_window.h"

namespace lucerna {

namespace {

constexpr std::size_t kMarginalBlock = std::size_t{1} << 18;
/// Nodes in a block of James and Stein.
constexpr std::size_t kShrunkTogether = 16;
/// A node's division is not tested below so many rays on the side that should have fewer.
constexpr double kTestedRays = 2.0;

/// Which cell (first * side + second) is at place `i` of a hierarchy.
enum class Order { first, second, quarters };
std::size_t cell_at(std::size_t i, std::uint32_t bits, Order order) {
  const std::size_t mask = (std::size_t{1} << bits) - 1;
  if (order == Order::first) return i;
  if (order == Order::second) return (i & mask) << bits | i >> bits;
  std::size_t a = 0, b = 0;
  for (std::uint32_t k = 0; k < bits; ++k) {
    a |= (i >> (2 * k + 1) & 1u) << k;
    b |= (i >> (2 * k) & 1u) << k;
  }
  return a << bits | b;
}

/// Sums of neighbours: level k has 2^k numbers; the last level is `cells`.
std::vector<std::vector<double>> pyramid(std::vector<double> cells) {
  std::vector<std::vector<double>> levels{std::move(cells)};
  while (levels.back().size() > 1) {
    const auto& fine = levels.back();
    std::vector<double> coarse(fine.size() / 2);
    for (std::size_t i = 0; i < coarse.size(); ++i) coarse[i] = fine[2 * i] + fine[2 * i + 1];
    levels.push_back(std::move(coarse));
  }
  std::reverse(levels.begin(), levels.end());
  return levels;
}

/// The part of a block's difference that is not noise: James and Stein's factor, and a standard deviation
/// of chi-square on top, so that noise alone hardly ever moves anything.
double shrinkage(double chi2, double tested) {
  if (tested <= 0.0 || chi2 <= 0.0) return 0.0;
  return std::max(0.0, 1.0 - (tested + std::sqrt(2.0 * tested)) / chi2);
}

struct Hierarchy {
  std::vector<std::vector<double>> rays, variance, model;
};

/// How far the rays' divisions of nodes [block, end) of a level are from the model's: chi-square, and of how
/// many nodes.
struct BlockTest {
  double chi2 = 0.0, tested = 0.0;
};

BlockTest block_test(const Hierarchy& h, std::size_t level, std::size_t block, std::size_t end) {
  const auto &rays = h.rays[level], &variance = h.variance[level], &model = h.model[level];
  const auto &fine_rays = h.rays[level + 1], &fine_model = h.model[level + 1];
  BlockTest test;
  for (std::size_t i = block; i < end; ++i) {
    if (!(model[i] > 0.0) || !(rays[i] > 0.0)) continue;
    const double f = fine_model[2 * i] / model[i], even = f * (1.0 - f);
    const double expected = std::min(f, 1.0 - f) * rays[i] * rays[i] / variance[i];
    if (!(even > 0.0) || expected < kTestedRays) continue;
    const double difference = fine_rays[2 * i] - f * rays[i];
    test.chi2 += difference * difference / (even * variance[i]);
    test.tested += 1.0;
  }
  return test;
}

/// Divides the light of the nodes of one level between their halves.
std::vector<double> divided(const Hierarchy& h, std::size_t level, const std::vector<double>& shares) {
  const auto &rays = h.rays[level], &model = h.model[level];
  const auto &fine_rays = h.rays[level + 1], &fine_model = h.model[level + 1];
  std::vector<double> halves(2 * shares.size(), 0.0);
  for (std::size_t block = 0; block < shares.size(); block += kShrunkTogether) {
    const std::size_t end = std::min(shares.size(), block + kShrunkTogether);
    const BlockTest test = block_test(h, level, block, end);
    const double factor = shrinkage(test.chi2, test.tested);
    for (std::size_t i = block; i < end; ++i) {
      if (!(model[i] > 0.0)) continue;
      const double f = fine_model[2 * i] / model[i];
      // What the model keeps dark stays dark.
      const double found = rays[i] > 0.0 && f > 0.0 && f < 1.0 ? fine_rays[2 * i] / rays[i] : f;
      const double share = f + factor * (found - f);
      halves[2 * i] = share * shares[i];
      halves[2 * i + 1] = (1.0 - share) * shares[i];
    }
  }
  return halves;
}

/// Which cell is at each place of a hierarchy of which the grid's origin is moved by `shift` cells.
std::vector<std::size_t> places(Order order, std::size_t shift, std::uint32_t bits) {
  const std::size_t mask = (std::size_t{1} << bits) - 1;
  std::vector<std::size_t> cells(std::size_t{1} << 2 * bits);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t at = cell_at(i, bits, order);
    cells[i] = (((at >> bits) + shift) & mask) << bits | (((at & mask) + shift) & mask);
  }
  return cells;
}

Hierarchy hierarchy(const std::vector<std::size_t>& cells, const TreeMarginals::Cells& rays,
                    double total_weight, double total_squares, const std::vector<double>& model) {
  const double inverse = 1.0 / total_weight, noise = total_squares * inverse * inverse;
  std::vector<double> found(cells.size()), variance(cells.size()), base(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    found[i] = rays.weight[cells[i]] * inverse;
    base[i] = model[cells[i]];
    // What the rays say of their noise, and what the model would have them say.
    variance[i] = 0.5 * (rays.squares[cells[i]] * inverse * inverse + base[i] * noise);
  }
  return {pyramid(std::move(found)), pyramid(std::move(variance)), pyramid(std::move(base))};
}

using AllCells = std::array<TreeMarginals::Cells, kAxisPairs.size()>;

AllCells dark_cells() {
  AllCells cells;
  for (std::size_t p = 0; p < kAxisPairs.size(); ++p) {
    cells[p].weight.assign(kAxisPairs[p].side() * kAxisPairs[p].side(), 0.0);
    cells[p].squares = cells[p].weight;
  }
  return cells;
}

}  // namespace

void TreeMarginals::find_cores(std::span<const TreeItem> items) {
  constexpr double kOutside = 0.01, kNarrowest = 1e-4;
  constexpr std::size_t kSome = 1 << 16;
  const std::size_t stride = items.size() / kSome + 1;
  for (std::size_t d = 0; d < 4; ++d) {
    if (!(box_.width(d) > 0.0)) continue;
    std::vector<WeightedValue> places;
    for (std::size_t i = 0; i < items.size(); i += stride) {
      const double t = (static_cast<double>(items[i].c[d]) - box_.low[d]) / box_.width(d);
      places.push_back({t, static_cast<double>(items[i].weight)});
    }
    const double low = weighted_quantile(places, kOutside), high = weighted_quantile(places, 1.0 - kOutside);
    if (high - low > kNarrowest) stretch_[d] = {std::max(0.0, low), std::min(1.0, high)};
  }
}

TreeMarginals::TreeMarginals(std::span<const TreeItem> items, const TreeBox& box) : box_(box) {
  find_cores(items);
  clear();
  add(items);
}

void TreeMarginals::clear() {
  cells_ = dark_cells();
  total_weight_ = total_squares_ = 0.0;
}

void TreeMarginals::add(std::span<const TreeItem> items) {
  struct Part {
    AllCells cells = dark_cells();
    double weight = 0.0, squares = 0.0;
  };
  std::array<double, 4> scale{};
  for (std::size_t d = 0; d < 4; ++d) scale[d] = box_.width(d) > 0.0 ? 1.0 / box_.width(d) : 0.0;
  const auto parts =
      parallel_map_blocks<Part>(items.size(), kMarginalBlock, [&](std::size_t first, std::size_t last) {
        Part part;
        for (std::size_t i = first; i < last; ++i) {
          const TreeItem& item = items[i];
          const auto w = static_cast<double>(item.weight);
          part.weight += w, part.squares += w * w;
          std::array<double, 4> t{};
          for (std::size_t d = 0; d < 4; ++d)
            t[d] =
                std::clamp(stretch_[d].stretched((static_cast<double>(item.c[d]) - box_.low[d]) * scale[d]),
                           0.0, 0.999999999);
          for (std::size_t p = 0; p < kAxisPairs.size(); ++p) {
            const AxisPair& pair = kAxisPairs[p];
            const auto side = static_cast<double>(pair.side());
            const std::size_t cell = static_cast<std::size_t>(t[pair.first] * side) << pair.bits |
                                     static_cast<std::size_t>(t[pair.second] * side);
            part.cells[p].weight[cell] += w, part.cells[p].squares[cell] += w * w;
          }
        }
        return part;
      });
  for (const Part& part : parts) {
    total_weight_ += part.weight, total_squares_ += part.squares;
    for (std::size_t p = 0; p < kAxisPairs.size(); ++p) {
      for (std::size_t i = 0; i < cells_[p].weight.size(); ++i) {
        cells_[p].weight[i] += part.cells[p].weight[i];
        cells_[p].squares[i] += part.cells[p].squares[i];
      }
    }
  }
}

std::vector<double> shrunken_shares(const TreeMarginals::Cells& rays, double total_weight,
                                    double total_squares, const std::vector<double>& model,
                                    std::uint32_t bits) {
  constexpr std::size_t kShifts = 4;
  const std::size_t side = std::size_t{1} << bits;
  std::vector<double> mean(model.size(), 0.0);
  for (std::size_t k = 0; k < kShifts; ++k) {
    std::vector<double> shares = model;
    for (const Order order : {Order::first, Order::second, Order::quarters}) {
      const auto cells = places(order, k * (side / 8 + 5), bits);
      const Hierarchy h = hierarchy(cells, rays, total_weight, total_squares, shares);
      std::vector<double> level{h.model.front().front()};
      for (std::size_t l = 0; l < std::size_t{2} * bits; ++l) level = divided(h, l, level);
      for (std::size_t i = 0; i < cells.size(); ++i) shares[cells[i]] = level[i];
    }
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += shares[i] / static_cast<double>(kShifts);
  }
  return mean;
}

double axis_contradiction(const TreeMarginals::Cells& rays, double total_weight, double total_squares,
                          const std::vector<double>& model, std::uint32_t bits) {
  double worst = 0.0;
  for (const Order order : {Order::first, Order::second}) {
    const Hierarchy h = hierarchy(places(order, 0, bits), rays, total_weight, total_squares, model);
    for (std::size_t level = 0; level < bits; ++level) {
      const std::size_t nodes = std::size_t{1} << level;
      for (std::size_t block = 0; block < nodes; block += kShrunkTogether) {
        const BlockTest t = block_test(h, level, block, std::min(nodes, block + kShrunkTogether));
        if (t.tested > 0.0) worst = std::max(worst, (t.chi2 - t.tested) / std::sqrt(2.0 * t.tested));
      }
    }
  }
  return worst;
}

}  // namespace lucerna
