// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lucerna/design/fit/fit_record.h"
#include "lucerna/design/fit/restart_policy.h"
#include "lucerna/design/fit/stage_objective.h"

namespace lucerna {

/// A fit by least squares: takes the steps of a schedule's stages and goes on where the restart policy says.
/// Every decision depends on the state alone, so that a fit that is stopped after any step and taken up from
/// its state continues bit-identically.
class Fit {
 public:
  /// Starts with the first of the problem's starts, or at `shape`. `search_costs` is kept in the state.
  Fit(const FitProblem& problem, const ContinuationSchedule& schedule, const DesignShape& shape,
      std::vector<double> search_costs = {});
  /// Goes on from a state of the same problem, schedule and shape family.
  Fit(const FitProblem& problem, const ContinuationSchedule& schedule, const DesignShape& family,
      const FitState& state);

  // The objective refers to the problem.
  Fit(const Fit&) = delete;
  Fit& operator=(const Fit&) = delete;

  bool done() const { return state_.stage >= static_cast<int>(schedule().size()); }
  /// One trial step (one evaluation with derivatives, two where a stage begins).
  FitRecord step(Progress& progress = no_progress());

  /// How many rays that will trace.
  std::uint64_t next_rays() const { return done() ? 0 : (objective_ ? 1 : 2) * stage().rays; }

  const DesignShape& shape() const { return shape_; }
  /// The best so far: of those that came to the end, else to the screening stage, else the shape now.
  DesignShape best() const;
  /// Whether the best is as good as the noise of the last stage's rays lets one see.
  bool at_noise() const { return policy_.at_noise(state_.restart); }
  const FitState& state() const { return state_; }

 private:
  const ContinuationSchedule& schedule() const { return policy_.schedule(); }
  const FitStage& stage() const { return schedule()[static_cast<std::size_t>(state_.stage)]; }
  void begin_stage(Progress& progress);
  void finish_stage();
  bool stage_ended() const;
  /// Goes on where the policy says.
  void take(const FitBranch& branch);
  void begin_with(const DesignShape& start, std::size_t stage);
  void set_shape(const DesignShape& shape);
  FitSnapshot snapshot() const;
  DesignShape shape_of(const FitSnapshot& snapshot) const;
  DesignShape conjugate() const;

  FitProblem problem_;
  RestartPolicy policy_;
  DesignShape family_, shape_;
  FitState state_;
  /// Of the current stage; empty until it begins. The point has `shape_`.
  std::optional<StageObjective> objective_;
  std::optional<FitPoint> point_;
};

}  // namespace lucerna
