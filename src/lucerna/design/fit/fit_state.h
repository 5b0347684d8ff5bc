// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace lucerna {

/// A shape that a fit keeps, with its cost; without parameters: none yet.
struct FitSnapshot {
  double cost = 0.0, error_to_noise = 0.0;
  /// What ends are compared by: the cost, with light beside the window weighed less than on the way.
  double merit = 0.0;
  int intervals_x = 1, intervals_y = 1;
  std::vector<double> parameters;
  bool exists() const { return !parameters.empty(); }
};

/// What decides where a fit goes on after a stage (restart_policy.h).
struct RestartState {
  /// Guesses and restarts that were begun so far; and how many restarts in a row have gained nothing.
  int begun = 1, failed = 0;
  /// The best at the screening stage; and at the end of the schedule: the incumbent.
  FitSnapshot screened, best;
  /// Restarts of the search so far, and how many more there may be now; whether the present one is the
  /// conjugate of the one before; the best that any came to; and the cost that the next has to beat.
  int searches = 0, searches_left = 0;
  bool conjugate = false;
  FitSnapshot found;
  double incumbent_cost = 0.0;
};

/// All that a fit's next step depends on; a checkpoint holds exactly this.
struct FitState {
  std::vector<double> parameters;
  int intervals_x = 1, intervals_y = 1;
  int stage = 0, step = 0;
  double lambda = 1e-2;
  /// Costs after the last accepted steps of this stage, newest last.
  std::vector<double> costs;
  /// Steps in a row that were refused.
  int refused = 0;
  int evaluations = 0;
  std::uint64_t total_rays = 0;
  /// Error over noise where the last stage ended.
  double error_to_noise = 0.0;
  RestartState restart;
  /// What a global search before the fit has paid for so far (optimizer.h).
  std::vector<double> search_costs;
};

}  // namespace lucerna
