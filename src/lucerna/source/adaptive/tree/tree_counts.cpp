// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/tree/tree_counts.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lucerna/source/adaptive/charts/batch_math.h"

namespace lucerna {

namespace {

constexpr auto kCuts = static_cast<int>(kTreeCuts);
/// Cuts that are looked at together.
constexpr std::size_t kLanes = 8;

/// The logarithms of the shares of a box below and above every cut; 0 where there is no cut.
struct LogShares {
  std::array<double, kTreeCuts + 1> below{}, above{};

  LogShares() {
    for (std::uint32_t k = 1; k < kTreeCuts; ++k) {
      below[k] = std::log(k * (1.0 / kTreeCuts));
      above[k] = std::log((kTreeCuts - k) * (1.0 / kTreeCuts));
    }
  }
};
const LogShares kLogShares;

using Floats = float __attribute__((vector_size(16)));
using Integers = std::int32_t __attribute__((vector_size(16)));

/// The parts that an item is in, on all axes.
LUCERNA_ALWAYS_INLINE inline Integers parts_of(const TreeItem& item, Floats low, Floats scale) {
  Floats c;
  std::memcpy(&c, item.c.data(), sizeof c);
  Integers part = __builtin_convertvector((c - low) * scale, Integers);
  part &= ~(part >> 31);  // not below 0
  const Integers over = part - (kCuts - 1);
  return part - (over & ~(over >> 31));
}

/// Returns the squared weight.
LUCERNA_ALWAYS_INLINE inline double put(const TreeItem& item, Integers part, TreeCounts& counts) {
  const double w = static_cast<double>(item.weight);
  // Two parts at a time leave the vector.
  std::array<std::uint64_t, 2> two;
  std::memcpy(two.data(), &part, sizeof two);
  counts.bins[two[0] & 0xFFFFFFFFu][0] += w;
  counts.bins[two[0] >> 32][1] += w;
  counts.bins[two[1] & 0xFFFFFFFFu][2] += w;
  counts.bins[two[1] >> 32][3] += w;
  return w * w;
}

}  // namespace

TreeBinning::TreeBinning(const TreeBox& box) {
  for (std::size_t d = 0; d < 4; ++d) {
    low[d] = static_cast<float>(box.low[d]);
    const double width = box.width(d);
    scale[d] = width > 0.0 ? static_cast<float>(kTreeCuts / width) : 0.0f;
  }
}

std::uint32_t TreeBinning::bin(const TreeItem& item, std::size_t d) const {
  return static_cast<std::uint32_t>(std::clamp(static_cast<int>(place(item, d)), 0, kCuts - 1));
}

void TreeCounts::add(const TreeCounts& other) {
  for (std::size_t b = 0; b < kTreeCuts; ++b) {
    for (std::size_t d = 0; d < 4; ++d) bins[b][d] += other.bins[b][d];
  }
  squares += other.squares;
}

void count_items(std::span<const TreeItem> items, const TreeBinning& binning, TreeCounts& counts) {
  constexpr std::size_t kWorthTwo = 256;
  Floats low, scale;
  std::memcpy(&low, binning.low.data(), sizeof low);
  std::memcpy(&scale, binning.scale.data(), sizeof scale);
  std::size_t i = 0;
  std::array<double, 2> squares{};
  if (items.size() >= kWorthTwo) {
    // Neighbours in the file are often in the same part: two counts alternately, so that none waits for the
    // other.
    TreeCounts others;
    for (; i + 2 <= items.size(); i += 2) {
      squares[0] += put(items[i], parts_of(items[i], low, scale), counts);
      squares[1] += put(items[i + 1], parts_of(items[i + 1], low, scale), others);
    }
    counts.add(others);
  }
  for (; i < items.size(); ++i) squares[0] += put(items[i], parts_of(items[i], low, scale), counts);
  counts.squares += squares[0] + squares[1];
}

TreeSums sums_below(const TreeCounts& counts) {
  TreeSums sums;
  TreeCounts::Row sum{};
  for (std::size_t b = 0; b < kTreeCuts; ++b) {
    sums[b] = sum;
    for (std::size_t d = 0; d < 4; ++d) sum[d] += counts.bins[b][d];
  }
  sums[kTreeCuts] = sum;
  return sums;
}

void CutList::add(double weight_below, std::uint32_t cut) {
  below[size] = weight_below;
  log_below[size] = kLogShares.below[cut];
  log_above[size] = kLogShares.above[cut];
  ++size;
}

namespace {

/// Gains of all lanes of whole vectors, and the largest.
LUCERNA_VECTOR_CLONES double fill_gains(double weight, CutList& cuts) {
  constexpr double kMin = 1e-290;
  const double all = weight * batch::logarithm(std::max(weight, kMin));
  std::array<double, kLanes> max;
  max.fill(-1e300);
  for (std::size_t first = 0; first < cuts.size; first += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const std::size_t i = first + k;
      const double a = cuts.below[i], b = std::max(0.0, weight - a);
      const double log_a = batch::logarithm(std::max(a, kMin)), log_b = batch::logarithm(std::max(b, kMin));
      const double gain = a * (log_a - cuts.log_below[i]) + b * (log_b - cuts.log_above[i]) - all;
      cuts.gain[i] = gain;
      max[k] = std::max(max[k], gain);
    }
  }
  return *std::max_element(max.begin(), max.end());
}

}  // namespace

std::size_t count_gains(double weight, CutList& cuts) {
  // Up to a whole vector: a cut that loses more than any.
  constexpr double kNever = 1e6;
  for (std::size_t i = cuts.size; i % kLanes != 0; ++i)
    cuts.below[i] = 0.0, cuts.log_below[i] = 0.0, cuts.log_above[i] = kNever;
  const double max = fill_gains(weight, cuts);
  std::size_t best = 0;
  while (best + 1 < cuts.size && cuts.gain[best] != max) ++best;
  return best;
}

}  // namespace lucerna
