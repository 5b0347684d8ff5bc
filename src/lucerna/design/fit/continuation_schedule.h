// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/design/fit/fit_problem.h"
#include "lucerna/design/shape/design_shape.h"

namespace lucerna {

/// One stage of a fit, from coarse to fine.
struct FitStage {
  int intervals_x = 1, intervals_y = 1;
  /// Bins across, and how much wider than the target's window they reach.
  int bins = 48;
  double widen = 1.0;
  std::uint64_t rays = 1 << 16;
  int max_steps = 30;
  /// The stage ends when the last two accepted steps gained less than this share of the error.
  double min_gain = 0.03;
  /// Weight of `smoothness_penalty` in the cost.
  double smoothing = 0.0;
  /// Initial guesses are compared here: only the best goes on, later restarts only where they beat it.
  bool screening = false;
  /// The knots are taken only where the stage before ended above the noise; else those of before stay.
  bool grow = false;
  /// Large scales of the light weigh more (spectral_weighting.h), by so many half waves; 0: all alike.
  double cutoff = 0.0;
  /// Of the search for other basins, which only its own restarts pass. Such stages come first.
  bool search = false;
};

/// The stages of a fit, from coarse to fine: those of the search for other basins first. Immutable.
class ContinuationSchedule {
 public:
  /// There must be a stage that is not the search's.
  explicit ContinuationSchedule(std::vector<FitStage> stages);

  std::size_t size() const { return stages_.size(); }
  const FitStage& operator[](std::size_t stage) const { return stages_[stage]; }
  const FitStage& last() const { return stages_.back(); }

  /// How many stages the search has; the fit's first is the one after them.
  std::size_t search_stages() const { return search_stages_; }
  /// The stage where starts are compared; the last where there is none.
  std::size_t screening() const;
  /// Whether starts are still compared at `stage` or later.
  bool screens_from(std::size_t stage) const;
  /// The first of the fit's stages with so many intervals, the screening stage at the latest.
  std::size_t first_with(int intervals) const;
  /// Where a guess begins.
  std::size_t entry(InitialKnots entry) const;
  /// The same without what follows the screening stage.
  ContinuationSchedule up_to_screening() const;

 private:
  std::vector<FitStage> stages_;
  std::size_t search_stages_ = 0;
};

/// How a schedule is made.
struct ScheduleOptions {
  /// Rays of the last stage at most.
  std::uint64_t rays = std::uint64_t{1} << 22;
  /// How often the knots may be doubled beyond the shape's own where the light asks for it.
  int knot_doublings = 0;
};

/// The schedule for a shape: knots up to its own (and beyond, with growth), bins up to the problem's, always
/// enough bins to tell all parameters apart. Neither knots nor bins ever get fewer, and at the same knots
/// neither do rays.
ContinuationSchedule continuation_schedule(const DesignShape& shape, const TentBins& bins,
                                           const ScheduleOptions& options);

}  // namespace lucerna
