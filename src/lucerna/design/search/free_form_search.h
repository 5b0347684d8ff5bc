// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lucerna/design/fit/fit_record.h"
#include "lucerna/design/fit/found_shape.h"
#include "lucerna/design/fit/free_form_fit.h"
#include "lucerna/design/search/candidate_order.h"
#include "lucerna/design/search/fits_ahead.h"
#include "lucerna/design/search/free_form_state.h"

namespace lucerna {

/// How finely the light of a start is transported: rays of the source in so many cells across, to so many
/// bins across, in so many rounds.
struct StartLight {
  std::uint64_t rays = std::uint64_t{1} << 19;
  int cells = 40, bins = 36, rounds = 4;
};

/// What a point source's mirror would be for a fit's target, with the knots and the symmetry of `family`; see
/// transport_guess. Grows the problem's rays.
std::optional<DesignShape> free_form_guess(const FitProblem& problem, const DesignShape& family,
                                           const TransportChoice& choice, const StartLight& light = {});

/// Finds a free form or a trough by successive halving: candidates (the given mirror; a point source's
/// mirrors of both signs at several vertex distances) are fitted roughly, the best of them finely (the best
/// of the first few before the others begin), the best of these to the end. Then, as long as there is time,
/// the best is fitted on with more rays, before neighbours of it where it is an approach or noise is a good
/// part of its error, and after some of them elsewhere. A given mirror of few knots that is to have no more
/// is first brought near the target (approach.h), any other of few knots where no mirror of a point source
/// comes to it; other starts of it then too, where all are far or the approach is the nearest, until one
/// is at the target. A given mirror keeps its knots as long as they bring it near the noise or the target.
/// Knots are only ever refined. Every decision depends on the state alone: a search that is stopped after any
/// step and taken up from its state continues bit-identically.
///
/// Where the problem's rays are shared with peers, the rough levels of the candidates to come are fitted by
/// one process each, before their turn. The steps that follow repeat them, so that the search has the same
/// states as one process; what the search does not come to is lost.
class FreeFormSearch {
 public:
  /// `given` with its own knots; `max_intervals`: knots along the longer side that the search may refine to
  /// (those of `given` at least). `max_rays`: of an evaluation. `problem` must outlive it.
  FreeFormSearch(const FitProblem& problem, const DesignShape& given, int max_intervals,
                 std::uint64_t max_rays, FreeFormState state = {});

  /// One trial step, or the beginning of a candidate; nothing where that has no start.
  std::optional<FitRecord> step(Progress& progress = no_progress());
  /// Nothing is left to gain: the best is at the noise of the most rays, no candidate has a start, or
  /// FitProblem::max_failed_restarts neighbours have had their turn and none of them is worth going on with.
  bool done() const;
  /// It is done because so many candidates in a row have no start.
  bool out_of_candidates() const;
  /// Rays that the next step will trace, at most.
  std::uint64_t next_rays() const;

  /// The best so far: of the finest level that any came to.
  DesignShape best() const;
  const FreeFormState& state() const { return state_; }

  /// How finely level `number` fits.
  FreeFormLevel level(int number) const;
  /// The transport that candidate `number` of the first ones begins with.
  TransportChoice first_choice(int number) const;

 private:
  CandidateOrder order() const { return {rules_, state_}; }
  /// What a candidate that is not the given mirror begins with.
  TransportChoice choice(int number) const;
  /// What an approach begins with: the given mirror, then in turn what a few modes make of it (mirrors
  /// but troughs) and a copy perturbed at random.
  InitialGuess start_of_approach(int restart);
  /// What an approach leads to.
  DesignShape approached(int restart);
  /// Counts what a shape cost.
  DesignShape paid_for(FoundShape found);
  /// The given mirror, or what an approach makes of it, whichever is nearer to the target.
  DesignShape nearer_of_given();
  /// Begins a level of the next candidate, unless it has no start.
  void choose(Progress& progress);
  /// Begins the rough level of a candidate, unless it has no start.
  void begin_candidate(const FreeFormSnapshot& candidate, Progress& progress);
  FreeFormSnapshot candidate(int number) const;
  /// The next candidates that were not fitted ahead, `max` at most, if nothing changes what the choice of
  /// them depends on.
  std::vector<FreeFormSnapshot> upcoming(std::size_t max) const;
  /// Whether rough levels are fitted ahead.
  bool looks_ahead() const;
  /// Fits the rough level of the next candidates, each by one of the peers.
  void fit_ahead();
  /// The rough level of a candidate, to an end that depends on no other candidate.
  RoughFit rough_fit(const FreeFormSnapshot& candidate) const;
  /// The next step of the rough level that was fitted ahead.
  FitRecord replayed();
  /// One trial step from the point at work.
  bool advance(Progress& progress);
  /// The point at work, in the state, as a line of the history.
  FitRecord measured(bool accepted);
  /// Makes a shape the point at work of the fit, and counts that.
  void evaluate_at(const DesignShape& shape, std::uint64_t rays);
  /// Whether what an approach led to, just evaluated, is still far from the target.
  bool has_too_few_knots(const FreeFormSnapshot& approach) const;
  /// `snapshot`: the candidate, its transport, and the level that begins.
  void begin(const DesignShape& shape, const FreeFormSnapshot& snapshot, Progress& progress);
  /// A level for a shape of that many knots: with fewer bins and less smoothing where derivatives would be
  /// noise, as the snapshot's were, and with derivatives of fewer rays where they would not.
  FreeFormLevel level_after(const FreeFormSnapshot& before, int number, const DesignShape& shape) const;
  void finish();
  bool level_ended() const;
  std::optional<DesignShape> start_of(const FreeFormSnapshot& snapshot);
  DesignShape shape_of(const FreeFormSnapshot& snapshot) const;
  void forget_what_cannot_win();

  const FitProblem& problem_;
  DesignShape given_;
  int max_intervals_;
  std::uint64_t max_rays_;
  double unit_mm_;
  CandidateRules rules_;
  FreeFormState state_;
  std::optional<FreeFormFit> fit_;
  std::optional<FreeFormPoint> point_;
  /// Rough levels that wait for the turn of their candidates; and the one whose turn it is.
  std::vector<RoughFit> ahead_;
  std::optional<RoughReplay> replay_;
};

}  // namespace lucerna
