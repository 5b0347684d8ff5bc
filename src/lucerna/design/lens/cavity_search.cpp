// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/cavity_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lucerna {

namespace {

/// The grid: radii over the largest, depths over the radius, and the free face's distance there.
constexpr std::array<double, 3> kRadii{0.2, 0.45, 1.0};
constexpr std::array<double, 3> kDepths{0.25, 0.5, 1.0};
constexpr double kDistance = 1.12;
/// Steps from the best are by these factors, smaller ones where none of the larger is better.
constexpr std::array<double, 2> kSteps{1.35, 1.16};

/// What a step multiplies radius, depth and distance by: these powers of its factor.
struct StepKind {
  double radius, depth, distance;
};
constexpr std::array<StepKind, 3> kKinds{{{0.0, 0.0, 0.5}, {0.0, 1.0, 0.0}, {1.0, 1.0, 0.0}}};

class CavitySearch {
 public:
  CavitySearch(const CavityRange& range, const CavityCost& cost, std::size_t max_trials)
      : range_(range), cost_(cost), max_trials_(max_trials) {}

  CavityTrial run() {
    look({{}, kDistance});
    for (const double radius : kRadii) {
      const double radius_mm = radius * range_.max_radius_mm;
      for (const double depth : kDepths) look({{radius_mm, depth * radius_mm}, kDistance});
    }
    for (const double factor : kSteps) {
      while (can_look() && has_stepped(factor)) {
      }
    }
    return best_;
  }

 private:
  bool can_look() const { return !ended_ && trials_ < max_trials_; }

  /// Steps may lead back.
  bool was_looked_at(const CavityTrial& trial) const {
    const auto same = [](double a, double b) { return std::abs(a - b) <= 1e-6 * std::abs(a); };
    return std::any_of(looked_at_.begin(), looked_at_.end(), [&](const CavityTrial& t) {
      return same(t.cavity.radius_mm, trial.cavity.radius_mm) &&
             same(t.cavity.depth_mm, trial.cavity.depth_mm) && same(t.distance, trial.distance);
    });
  }

  bool has_stepped(double factor) {
    const CavityTrial from = best_;
    for (const StepKind& kind : kKinds) {
      if (from.cavity.depth_mm == 0.0 && kind.distance == 0.0) continue;
      for (const double f : {factor, 1.0 / factor}) {
        CavityTrial to = from;
        to.cavity.radius_mm *= std::pow(f, kind.radius);
        to.cavity.depth_mm *= std::pow(f, kind.depth);
        to.distance *= std::pow(f, kind.distance);
        look(to);
        if (best_.cost < from.cost) return true;
      }
    }
    return false;
  }

  void look(CavityTrial trial) {
    const bool fits =
        trial.cavity.radius_mm <= range_.max_radius_mm && trial.cavity.depth_mm <= range_.max_depth_mm;
    if (!fits || !can_look() || was_looked_at(trial)) return;
    looked_at_.push_back(trial);
    const std::optional<double> cost = cost_(trial);
    ended_ = !cost;
    if (cost && std::isfinite(*cost)) ++trials_;
    if (!cost || !(*cost < best_.cost)) return;
    best_ = trial;
    best_.cost = *cost;
  }

  const CavityRange& range_;
  const CavityCost& cost_;
  std::size_t max_trials_;
  CavityTrial best_;
  std::vector<CavityTrial> looked_at_;
  /// Those that were lenses.
  std::size_t trials_ = 0;
  bool ended_ = false;
};

}  // namespace

CavityTrial search_cavity(const CavityRange& range, const CavityCost& cost, std::size_t max_trials) {
  return CavitySearch(range, cost, max_trials).run();
}

}  // namespace lucerna
