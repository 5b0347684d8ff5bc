// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace lucerna {

/// The pattern search of Hooke and Jeeves (J. ACM 8, 1961), as a machine that asks for costs and is told
/// them, so that several run side by side: an exploratory move tries every parameter a little up and down and
/// keeps what is better; a pattern move jumps on along what it found; the step is halved when nothing helps.
class HookeJeeves {
 public:
  /// From a point of known cost; done when the step has fallen to a 64th.
  HookeJeeves(Eigen::VectorXd start, double cost, double step)
      : base_(std::move(start)), at_(base_), base_cost_(cost), at_cost_(cost), step_(step), first_(step) {}

  bool done() const { return step_ < first_ / 64.0; }
  /// The points whose costs it needs next: none when it is done.
  std::vector<Eigen::VectorXd> ask() const {
    if (done()) return {};
    if (jump_) return {base_ + (base_ - before_)};
    std::vector<Eigen::VectorXd> points{at_, at_};
    points[0][axis_] -= step_;
    points[1][axis_] += step_;
    return points;
  }
  /// Costs of exactly the points asked for.
  void tell(const std::vector<double>& costs) {
    if (costs.empty()) return;
    if (jump_) {  // explore about the place jumped to; it need not be better itself
      at_ = base_ + (base_ - before_);
      at_cost_ = costs[0];
      jump_ = false;
      axis_ = 0;
      return;
    }
    const std::size_t better = costs[1] < costs[0] ? 1 : 0;
    if (costs[better] < at_cost_) {
      at_[axis_] += better == 1 ? step_ : -step_;
      at_cost_ = costs[better];
    }
    if (++axis_ < at_.size()) return;
    axis_ = 0;
    if (at_cost_ < base_cost_) {
      before_ = base_;
      base_ = at_;
      base_cost_ = at_cost_;
      jump_ = true;
      return;
    }
    // Nothing better about here: from a jump back to its base, from the base to a shorter step.
    if (at_ == base_) step_ *= 0.5;
    at_ = base_;
    at_cost_ = base_cost_;
  }

  const Eigen::VectorXd& best() const { return base_; }
  double cost() const { return base_cost_; }

 private:
  Eigen::VectorXd base_, before_, at_;
  double base_cost_, at_cost_, step_, first_;
  Eigen::Index axis_ = 0;
  bool jump_ = false;
};

}  // namespace lucerna
