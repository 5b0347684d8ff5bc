// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_directions.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna {

namespace {

/// No child has a smaller share of its parent's solid angle than this, so a split gains at most -log of it
/// per ray.
constexpr double kLargestGain = 1.7;

/// Bottom-up pruning over sorted samples.
class DirectionGrower {
 public:
  DirectionGrower(std::span<const DirectionSample> samples, double penalty,
                  std::vector<DirectionLeaf>* leaves)
      : samples_(samples), penalty_(penalty), leaves_(leaves), before_(samples.size() + 1, 0.0) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      before_[i + 1] = before_[i] + static_cast<double>(samples[i].weight);
  }

  /// Sum of gains over the octants.
  double grow() {
    double gain = 0.0;
    std::size_t first = 0;
    for (std::uint32_t octant = 0; octant < 8; ++octant) {
      const std::uint32_t code = octant * direction_span(0);
      const std::size_t last = end_of(first, samples_.size(), code + direction_span(0));
      gain += grow(first, last, code, 0);
      first = last;
    }
    return gain;
  }

 private:
  std::size_t end_of(std::size_t first, std::size_t last, std::uint32_t code) const {
    const auto begin = samples_.begin();
    return static_cast<std::size_t>(
        std::lower_bound(begin + static_cast<std::ptrdiff_t>(first),
                         begin + static_cast<std::ptrdiff_t>(last), code,
                         [](const DirectionSample& s, std::uint32_t c) { return s.code < c; }) -
        begin);
  }

  double leaf(std::uint32_t code, int depth, double weight) {
    if (leaves_) leaves_->push_back({code, depth, weight});
    return 0.0;
  }

  /// The best gain that the triangle's subtree can have; appends its leaves.
  double grow(std::size_t first, std::size_t last, std::uint32_t code, int depth) {
    const double weight = before_[last] - before_[first];
    if (depth == kDirectionDepth || weight * kLargestGain <= penalty_) return leaf(code, depth, weight);
    const std::size_t mark = leaves_ ? leaves_->size() : 0;
    const std::array<double, 4>& shares = direction_child_shares(code, depth);
    double gain = -penalty_;
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t begin = code + k * direction_span(depth + 1);
      const std::size_t end = k == 3 ? last : end_of(first, last, begin + direction_span(depth + 1));
      const double part = before_[end] - before_[first];
      if (part > 0.0) gain += part * std::log(part / (weight * shares[k]));
      gain += grow(first, end, begin, depth + 1);
      first = end;
    }
    if (gain > 0.0) return gain;
    if (leaves_) leaves_->resize(mark);
    return leaf(code, depth, weight);
  }

  std::span<const DirectionSample> samples_;
  double penalty_;
  std::vector<DirectionLeaf>* leaves_;
  std::vector<double> before_;
};

}  // namespace

std::vector<DirectionLeaf> direction_tree(std::span<const DirectionSample> samples, double penalty_nats) {
  std::vector<DirectionLeaf> leaves;
  DirectionGrower(samples, penalty_nats, &leaves).grow();
  return leaves;
}

double direction_gain_nats(std::span<const DirectionSample> samples, double penalty_nats) {
  return DirectionGrower(samples, penalty_nats, nullptr).grow();
}

}  // namespace lucerna
