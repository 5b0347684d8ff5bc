// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/restart_policy.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// The fit is at its end where its squared error is at most the noise's and this share more, or twice the
/// scatter of the noise's own estimate if that is more (48 rings tell it to 20 % only).
constexpr double kEndShare = 0.1;

/// A restart has failed unless it brings the error down to this share of the incumbent's.
constexpr double kGain = 0.97;

/// A restart that ends a stage above so many times the incumbent's error does not go on to the next, which
/// has more rays.
constexpr double kEndedAbove = 1.5;

/// A shape above so many times the noise at the screening stage, but with less than this error, is near the
/// target in what seems another basin: the search looks for the right one, with so many restarts before the
/// fit goes on and so many in a restart of the fit.
constexpr double kSettledOverNoise = 1.15, kNearError = 0.06;
constexpr int kSearchesAtScreening = 24, kSearchesLater = 3;

/// A restart of the search goes on to the screening stage where its error is at most this share of the
/// incumbent's.
constexpr double kSearchGain = 0.95;

/// A restart of the search that ends above so many times the incumbent's error is so far off that its
/// conjugate is too.
constexpr double kConjugateShare = 1.4;

/// Size of the search's perturbations, in those of the fit's restarts.
constexpr double kSearchPerturbation = 2.0;

/// Random streams of the search begin here, beyond those of the fit's restarts.
constexpr std::uint64_t kSearchStream = std::uint64_t{1} << 33;

FitBranch branch_to(FitBranch::Kind kind, std::size_t stage, FitSnapshot snapshot = {}) {
  return {.kind = kind, .stage = stage, .start = {}, .snapshot = std::move(snapshot)};
}

/// `snapshot` begins anew.
FitBranch begin_snapshot(const FitSnapshot& snapshot, std::size_t stage) {
  return branch_to(FitBranch::Kind::begin, stage, snapshot);
}

}  // namespace

RestartRules restart_rules(const FitProblem& problem) {
  RestartRules rules;
  rules.guesses.clear();
  for (const InitialGuess& s : problem.guesses) rules.guesses.push_back(s.entry);
  rules.compared = problem.compared;
  rules.max_failed = problem.max_failed_restarts;
  rules.perturbation = problem.perturbation;
  rules.bins = problem.bins.size();
  return rules;
}

RestartPolicy::RestartPolicy(RestartRules rules, ContinuationSchedule schedule)
    : rules_(std::move(rules)), schedule_(std::move(schedule)) {
  LUCERNA_CHECK(!rules_.guesses.empty(), "a fit without starts");
}

FitBranch RestartPolicy::begin_guess(std::size_t start) const {
  FitBranch branch = branch_to(FitBranch::Kind::begin, schedule_.entry(rules_.guesses[start]));
  branch.start = start;
  return branch;
}

FitBranch RestartPolicy::first() const { return begin_guess(0); }

FitBranch RestartPolicy::after(std::size_t stage, const FitSnapshot& now, RestartState& state) const {
  if (schedule_[stage].search) return schedule_[stage + 1].search ? FitBranch{} : after_search(now, state);
  if (schedule_[stage].screening) return after_screening(stage, now, state);
  return next_after(stage, now, state);
}

FitBranch RestartPolicy::next_after(std::size_t stage, const FitSnapshot& now, RestartState& state) const {
  if (stage + 1 == schedule_.size()) return after_last(now, state);
  const bool compared = stage > schedule_.screening() && state.best.exists();
  if (!compared || now.cost <= kEndedAbove * kEndedAbove * state.best.cost) return {};
  ++state.failed;
  return restart(state);
}

FitBranch RestartPolicy::after_screening(std::size_t stage, const FitSnapshot& now,
                                         RestartState& state) const {
  const bool better = !state.screened.exists() || now.cost < state.screened.cost;
  if (better) state.screened = now;
  if (state.best.exists()) return better ? next_after(stage, now, state) : next_search(state);
  const auto begun = static_cast<std::size_t>(state.begun);
  if (state.screened.error_to_noise > kGoodErrorToNoise &&
      begun < std::min(rules_.compared, rules_.guesses.size())) {
    ++state.begun;
    return begin_guess(begun);
  }
  if (worth_searching(state)) {
    if (state.searches == 0) state.searches_left = kSearchesAtScreening;
    if (state.searches_left > 0) return next_search(state);
  }
  return leave_screening(state);
}

bool RestartPolicy::worth_searching(const RestartState& state) const {
  return schedule_.search_stages() > 0 && rules_.max_failed > 0 &&
         state.screened.error_to_noise > kSettledOverNoise && state.screened.cost < kNearError * kNearError;
}

/// The best at the screening stage goes on.
FitBranch RestartPolicy::leave_screening(RestartState& state) const {
  const std::size_t next = schedule_.screening() + 1;
  if (next == schedule_.size()) return after_last(FitSnapshot(state.screened), state);
  return branch_to(FitBranch::Kind::restored, next, state.screened);
}

/// The next restart of the search, or its end.
FitBranch RestartPolicy::next_search(RestartState& state) const {
  if (state.searches_left > 0) {
    --state.searches_left;
    return begin_search(state);
  }
  if (!state.best.exists()) return leave_screening(state);
  ++state.failed;
  return restart(state);
}

/// First the incumbent, whose cost the others have to beat, and whose conjugate may be the right one.
FitBranch RestartPolicy::begin_search(RestartState& state) const {
  const int number = state.searches++;
  if (number == 0) {
    return begin_snapshot(state.best.exists() ? state.best : state.screened, schedule_.search_stages() - 1);
  }
  FitBranch branch = branch_to(FitBranch::Kind::begin, 0);
  branch.start = static_cast<std::size_t>(number) % rules_.guesses.size();
  branch.perturbation = kSearchPerturbation * rules_.perturbation;
  branch.stream = kSearchStream + static_cast<std::uint64_t>(number);
  return branch;
}

FitBranch RestartPolicy::after_search(const FitSnapshot& now, RestartState& state) const {
  const bool reference = state.searches == 1 && !state.conjugate;
  if (reference) state.incumbent_cost = now.cost;
  if (!state.found.exists() || now.cost < state.found.cost) state.found = now;
  state.conjugate = !state.conjugate && now.cost < kConjugateShare * kConjugateShare * state.incumbent_cost;
  if (state.conjugate) return branch_to(FitBranch::Kind::conjugate, schedule_.search_stages() - 1);
  if (state.found.cost < kSearchGain * kSearchGain * state.incumbent_cost) {
    state.incumbent_cost = state.found.cost;
    return begin_snapshot(state.found, schedule_.screening());
  }
  return next_search(state);
}

FitBranch RestartPolicy::after_last(const FitSnapshot& now, RestartState& state) const {
  const bool first = !state.best.exists();
  const bool gained = first || now.merit < kGain * kGain * state.best.merit;
  state.failed = gained ? 0 : state.failed + 1;
  if (first || now.merit < state.best.merit) state.best = now;
  return restart(state);
}

/// Another restart, or the end: alternately from the starts and from the incumbent, whose basin may have a
/// better neighbour.
FitBranch RestartPolicy::restart(RestartState& state) const {
  if (at_noise(state) || state.failed >= rules_.max_failed) {
    return branch_to(FitBranch::Kind::end, schedule_.size(), state.best);
  }
  const int number = state.begun++;
  const auto n = rules_.guesses.size(), k = static_cast<std::size_t>(number);
  if (k < n) return begin_guess(k);
  state.searches_left = 0;
  FitBranch branch;
  if (number % 3 == 2) {
    branch = begin_snapshot(state.best, schedule_.first_with(schedule_.last().intervals_x));
  } else if (schedule_.search_stages() > 0) {
    state.searches_left = kSearchesLater;
    return next_search(state);
  } else {
    branch.kind = FitBranch::Kind::begin;
    branch.start = k % n;
  }
  branch.perturbation = rules_.perturbation;
  branch.stream = static_cast<std::uint64_t>(number);
  return branch;
}

bool RestartPolicy::at_noise(const RestartState& state) const {
  const double scatter = std::sqrt(2.0 / static_cast<double>(rules_.bins));
  const double over = state.best.error_to_noise;
  return state.best.exists() && over * over <= 1.0 + std::max(kEndShare, 2.0 * scatter);
}

}  // namespace lucerna
