// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/candidate_order.h"

#include <algorithm>
#include <array>

namespace lucerna {

namespace {

/// An approach is tried where the candidates before it stay kDoubtful from the target (relative error), for
/// a point source's mirror is no guide for a source that is long or wide; and where the given mirror is the
/// nearest of them. Further approaches, from other starts, follow where the best is kFarError from it, or
/// is an approach itself and not at it: they end in basins of their own, and how near they are once refined
/// spreads by a factor of four in error.
constexpr double kDoubtful = 0.05, kFarError = 0.15;
/// Approaches follow until one is within kNear and so many times the noise: its family may hold the target.
constexpr double kAtNoise = 1.15;
/// So many of them are compared roughly before the best goes ahead: the first is of the given mirror, the
/// second of a mirror that may be far from it.
constexpr int kApproachesCompared = 2;
/// A given mirror that is this near (relative error) goes on alone.
constexpr double kNear = 0.01;
/// The given mirror keeps its own knots as long as a level ends below so many times the noise, or near.
constexpr double kEnoughKnots = 2.0;
/// Where the given shape was chosen among others, the better of it and a point source's at its distance is
/// fitted to the end before the others begin.
constexpr int kChosenCandidates = 2;
/// How many candidates are fitted finely.
constexpr int kFittedFinely = 3;
/// A neighbour of the best goes on where its cost is at most so many times the best's at that level.
constexpr double kWorthOn = 1.1;
/// More rays help where the error is less than so many times the noise; else so many neighbours come first.
constexpr double kNoisy = 1.6;
constexpr int kNeighboursBefore = 4;
/// A candidate that after so many rough steps that were accepted costs so many times the best of the rough
/// level goes no further.
constexpr std::size_t kHopelessAfter = 2;
constexpr double kHopeless = 4.0;
/// An approach that after the first fine steps costs so many times what the best had cost by then goes no
/// further: it would need many more steps than there are.
constexpr double kSlow = 2.0;
/// Candidates in a row that have no start, after which there are no others.
constexpr int kMaxFailed = 8;
/// Mirrors that are fitted roughly come nearer to the target later, but the light that they lose stays lost.
constexpr std::array<double, kFreeFormLevels> kErrorShare{0.3, 1.0, 1.0, 1.0};

}  // namespace

double error_share(int level) { return kErrorShare[static_cast<std::size_t>(level)]; }

const FreeFormSnapshot* CandidateOrder::best_of(int level) const {
  const FreeFormSnapshot* best = nullptr;
  for (const FreeFormSnapshot& m : state_.done) {
    if (m.level == level && (best == nullptr || m.cost < best->cost)) best = &m;
  }
  return best;
}

bool CandidateOrder::was_at(int candidate, int level) const {
  return std::any_of(state_.done.begin(), state_.done.end(),
                     [&](const FreeFormSnapshot& m) { return m.candidate == candidate && m.level == level; });
}

const FreeFormSnapshot* CandidateOrder::best_waiting(int level) const {
  const FreeFormSnapshot* best = nullptr;
  for (const FreeFormSnapshot& m : state_.done) {
    if (m.level != level || m.parameters.empty() || was_at(m.candidate, level + 1)) continue;
    if (best == nullptr || m.cost < best->cost) best = &m;
  }
  return best;
}

bool CandidateOrder::is_approach(const FreeFormSnapshot& candidate) {
  return !candidate.transport.exists() && candidate.candidate >= kFirstApproach;
}

bool CandidateOrder::may_approach() const {
  return rules_.has_few_knots && !rules_.keeps_its_knots && !rules_.is_face;
}

bool CandidateOrder::worth_an_approach() const {
  const FreeFormSnapshot* best = best_of(kRoughLevel);
  if (best == nullptr || !may_approach()) return false;
  if (is_approach(*best)) return best->error > kNear || best->error_to_noise > kAtNoise;
  const double near = state_.begun <= kFirstApproach ? kDoubtful : kFarError;
  return best->candidate == 0 || best->error > near;
}

bool CandidateOrder::others_are_to_be_approached() const {
  return state_.begun < kAfterApproaches && worth_an_approach();
}

bool CandidateOrder::approach_is_alone() const {
  if (others_are_to_be_approached()) return false;
  const FreeFormSnapshot *approach = nullptr, *other = nullptr;
  for (const FreeFormSnapshot& m : state_.done) {
    if (m.level != kRoughLevel) continue;
    const FreeFormSnapshot*& best = is_approach(m) ? approach : other;
    if (best == nullptr || m.cost < best->cost) best = &m;
  }
  return approach != nullptr && other != nullptr && other->cost > kHopeless * approach->cost;
}

bool CandidateOrder::given_is_stuck() const {
  if (!may_approach()) return false;
  return std::any_of(state_.done.begin(), state_.done.end(), [](const FreeFormSnapshot& m) {
    return m.candidate == 0 && m.level == kFineLevel && m.error_to_noise > kEnoughKnots;
  });
}

int CandidateOrder::next_number(int number) const {
  // So near, only its own family may come nearer.
  if (number == 1 && given_is_stuck()) number = kFirstApproach;
  const bool is_approach = number >= kFirstApproach && number < kAfterApproaches;
  return is_approach && !worth_an_approach() ? kAfterApproaches : number;
}

bool CandidateOrder::is_decided() const {
  const FreeFormSnapshot* given = best_of(kRoughLevel);
  const bool near = state_.begun == 1 && given != nullptr &&
                    given->cost < error_share(kRoughLevel) * kNear * kNear && !given_is_stuck();
  return near || (rules_.start_is_chosen && state_.begun >= kChosenCandidates);
}

const FreeFormSnapshot* CandidateOrder::ahead_of_others() const {
  const int few = worth_an_approach() ? kFirstApproach + kApproachesCompared : kFirstApproach;
  if (state_.begun < few) return nullptr;
  const FreeFormSnapshot* best = best_of(kFineLevel);
  if (best == nullptr) return best_waiting(kRoughLevel);
  return is_approach(*best) ? best_waiting(kFineLevel) : nullptr;
}

bool CandidateOrder::wants_more_rays(const FreeFormSnapshot& best) const {
  const int neighbours_before = std::min(kNeighboursBefore, rules_.max_neighbours);
  return best.error_to_noise < kNoisy || is_approach(best) ||
         state_.begun >= kFirstNeighbour + neighbours_before;
}

const FreeFormSnapshot* CandidateOrder::next_promotion() const {
  // First candidates are compared roughly, and a search that has little time ends with a fine mirror.
  const bool decided = is_decided();
  const FreeFormSnapshot* end = best_of(kEndLevel);
  if (state_.begun < kFirstNeighbour && !decided && !approach_is_alone() && end == nullptr)
    return ahead_of_others();
  if (end != nullptr && is_approach(*end) && others_are_to_be_approached()) return nullptr;
  // The best few are fitted finely, and the best of these to the end.
  const FreeFormSnapshot* rough = best_waiting(kRoughLevel);
  const auto fitted_finely = std::count_if(state_.done.begin(), state_.done.end(),
                                           [](const FreeFormSnapshot& m) { return m.level == kFineLevel; });
  const bool hopeful = rough != nullptr && rough->cost < kHopeless * best_of(kRoughLevel)->cost;
  if (hopeful && fitted_finely < (decided ? 1 : kFittedFinely)) return rough;
  const FreeFormSnapshot* fine = best_waiting(kFineLevel);
  if (end == nullptr) return fine;
  if (is_approach(*end) && fine != nullptr && fine == best_of(kFineLevel)) return fine;
  // It goes on with more rays where noise is a good part of its error, else after some neighbours; then the
  // others, while they may win, and neighbours.
  if (wants_more_rays(*end) && !was_at(end->candidate, kMoreRaysLevel)) return end;
  if (state_.begun < kFirstNeighbour) return nullptr;
  if (fine != nullptr && fine->cost < kWorthOn * best_of(kFineLevel)->cost) return fine;
  if (rough != nullptr && rough->cost < kWorthOn * best_of(kRoughLevel)->cost) return rough;
  return nullptr;
}

bool CandidateOrder::knots_suffice(const FreeFormSnapshot& candidate) const {
  if (candidate.transport.exists()) return false;
  if (candidate.level == kRoughLevel) return true;
  const bool own = candidate.candidate == 0 || rules_.has_fixed_few_knots();
  return candidate.cost < error_share(candidate.level - 1) * kNear * kNear ||
         (own && candidate.error_to_noise < kEnoughKnots);
}

bool CandidateOrder::is_hopeless(const FreeFormSnapshot& rough, std::size_t accepted) const {
  const FreeFormSnapshot* best = best_of(kRoughLevel);
  return rough.level == kRoughLevel && best != nullptr && accepted >= kHopelessAfter &&
         rough.cost > kHopeless * best->cost;
}

bool CandidateOrder::is_slow_approach() const {
  const FreeFormSnapshot* best = best_of(kFineLevel);
  const FreeFormSnapshot& now = state_.now;
  return now.level == kFineLevel && now.early_cost > 0.0 && is_approach(now) && best != nullptr &&
         best->early_cost > 0.0 && now.early_cost > kSlow * best->early_cost;
}

bool CandidateOrder::is_over(const FreeFormSnapshot& candidate) const {
  if (was_at(candidate.candidate, candidate.level + 1)) return true;
  return candidate.level < kEndLevel && best_of(kMoreRaysLevel) != nullptr &&
         candidate.cost > kWorthOn * best_of(candidate.level)->cost;
}

bool CandidateOrder::is_out_of_candidates() const {
  return state_.failed >= kMaxFailed && state_.begun >= kFirstNeighbour && next_promotion() == nullptr;
}

bool CandidateOrder::is_at_end() const {
  const bool had_all = state_.begun - kFirstNeighbour >= rules_.max_neighbours;
  return (!state_.now.exists() && had_all && next_promotion() == nullptr) || is_out_of_candidates();
}

}  // namespace lucerna
