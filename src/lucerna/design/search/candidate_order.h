// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>

#include "lucerna/design/search/first_choices.h"
#include "lucerna/design/search/free_form_state.h"

namespace lucerna {

/// Candidates are numbered: 0 the given mirror, then the first choices, approaches of the given mirror, the
/// other choices, and neighbours of the best without end.
inline constexpr int kFirstApproach = 1 + static_cast<int>(std::tuple_size_v<decltype(FirstChoices::before)>),
                     kApproaches = 8, kAfterApproaches = kFirstApproach + kApproaches,
                     kFirstNeighbour = kAfterApproaches +
                                       static_cast<int>(std::tuple_size_v<decltype(FirstChoices::after)>);

/// What of a problem decides which candidates there are.
struct CandidateRules {
  /// The given mirror is a matter for `approach`; and it is to have no more knots.
  bool has_few_knots = false, keeps_its_knots = false;
  /// The last face of a lens: the continuation of an approach has mirrors only.
  bool is_face = false;
  /// FitProblem::start_is_chosen.
  bool start_is_chosen = false;
  /// Neighbours that have their turn, at most.
  int max_neighbours = 1;

  bool has_fixed_few_knots() const { return has_few_knots && keeps_its_knots; }
};

/// Which candidate of a free-form search comes next, and on which level: decisions from what candidates cost
/// alone, so that they are the same in any process. Both arguments must outlive it.
class CandidateOrder {
 public:
  CandidateOrder(const CandidateRules& rules, const FreeFormState& state) : rules_(rules), state_(state) {}

  /// The best of those that came to the end of a level; null: none did.
  const FreeFormSnapshot* best_of(int level) const;
  /// The next one to be taken up a level; null where a new candidate is to begin.
  const FreeFormSnapshot* next_promotion() const;
  /// The number of the candidate at or after `number` that is next: approaches that do not help are left out.
  int next_number(int number) const;
  /// Nothing is left to begin or to take up; because so many candidates in a row have no start.
  bool is_at_end() const;
  bool is_out_of_candidates() const;

  /// A given mirror that was brought near.
  static bool is_approach(const FreeFormSnapshot& candidate);
  /// Whether the given mirror may be brought near as a candidate beside itself.
  bool may_approach() const;
  /// Whether further approaches come before the best of them goes on.
  bool others_are_to_be_approached() const;
  /// Whether a candidate keeps its knots on the next level; `candidate` has that level already.
  bool knots_suffice(const FreeFormSnapshot& candidate) const;
  /// Whether a rough level has shown that it leads nowhere; `accepted` steps of it were.
  bool is_hopeless(const FreeFormSnapshot& rough, std::size_t accepted) const;
  /// Whether an approach at work lags so far behind the best at its level that it may end.
  bool is_slow_approach() const;
  /// Whether a candidate that came to the end of a level will not be taken up from there.
  bool is_over(const FreeFormSnapshot& candidate) const;

 private:
  /// The best that came to the end of a level and not yet of the next; null: none waits.
  const FreeFormSnapshot* best_waiting(int level) const;
  bool was_at(int candidate, int level) const;
  /// Whether an approach of the given mirror may help: it came nearer than the candidates after it, or none
  /// came near; a further one, where none is at the target.
  bool worth_an_approach() const;
  /// Whether the given mirror was near, went on alone, and its few knots ended it above the noise.
  bool given_is_stuck() const;
  /// Whether what the approaches led to is so much better that no mirror of a point source needs to be tried.
  bool approach_is_alone() const;
  /// Whether those that have begun are enough to be fitted finely: no others are waited for.
  bool is_decided() const;
  /// While the first candidates are compared roughly: the best of the first few goes ahead.
  const FreeFormSnapshot* ahead_of_others() const;
  /// Whether the best of the last level but one goes on with more rays at once.
  bool wants_more_rays(const FreeFormSnapshot& best) const;

  const CandidateRules& rules_;
  const FreeFormState& state_;
};

/// What of the squared error counts where candidates are compared at a level.
double error_share(int level);

}  // namespace lucerna
