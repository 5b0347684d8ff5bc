// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lucerna/design/fit/continuation_schedule.h"
#include "lucerna/design/fit/fit_state.h"

namespace lucerna {

/// A stage ends well where its error is at most so many times the noise: above it something is left to gain.
inline constexpr double kGoodErrorToNoise = 1.5;

/// What a restart policy has to know of a fit.
struct RestartRules {
  /// Of the fit's initial guesses, in their order; at least one.
  std::vector<InitialKnots> guesses{InitialKnots::few_knots};
  /// So many of them are compared at the screening stage.
  std::size_t compared = 5;
  /// FitProblem::max_failed_restarts and ::perturbation.
  int max_failed = 6;
  double perturbation = 0.02;
  /// Bins of the last stage.
  std::size_t bins = std::size_t{48} * 48;
};
RestartRules restart_rules(const FitProblem& problem);

/// Where a fit goes on.
struct FitBranch {
  enum class Kind {
    next,       ///< the shape as it is, in the next stage
    restored,   ///< `snapshot` as it was kept, in `stage`
    begin,      ///< a guess, else `snapshot`, begins anew in `stage`
    conjugate,  ///< the present shape's conjugate begins anew in `stage`
    end,        ///< the fit is done with `snapshot`
  };
  Kind kind = Kind::next;
  std::size_t stage = 0;
  /// Which of the guesses.
  std::optional<std::size_t> start;
  FitSnapshot snapshot;
  /// Of the parameters, over the mirror's outer radius, with a stream of random numbers; 0: none.
  double perturbation = 0.0;
  std::uint64_t stream = 0;
};

/// Decides where a fit goes on after each stage: which starts are compared, which shape goes on, when it
/// restarts from where, when it ends. A pure function of its arguments: the same state, the same branch. The
/// incumbent (`RestartState::best`) is replaced only by what has less merit function, and a fit ends with it.
/// State diagram: docs/theory/design.md.
class RestartPolicy {
 public:
  RestartPolicy(RestartRules rules, ContinuationSchedule schedule);

  /// Where a fit begins.
  FitBranch first() const;
  /// After `stage`, which ended with `now`.
  FitBranch after(std::size_t stage, const FitSnapshot& now, RestartState& state) const;
  /// Whether the incumbent is as good as the noise of the last stage's rays allows to tell.
  bool at_noise(const RestartState& state) const;

  const ContinuationSchedule& schedule() const { return schedule_; }

 private:
  FitBranch after_search(const FitSnapshot& now, RestartState& state) const;
  FitBranch after_screening(std::size_t stage, const FitSnapshot& now, RestartState& state) const;
  FitBranch after_last(const FitSnapshot& now, RestartState& state) const;
  FitBranch next_after(std::size_t stage, const FitSnapshot& now, RestartState& state) const;
  FitBranch leave_screening(RestartState& state) const;
  bool worth_searching(const RestartState& state) const;
  FitBranch next_search(RestartState& state) const;
  FitBranch begin_search(RestartState& state) const;
  FitBranch restart(RestartState& state) const;
  FitBranch begin_guess(std::size_t start) const;

  RestartRules rules_;
  ContinuationSchedule schedule_;
};

}  // namespace lucerna
