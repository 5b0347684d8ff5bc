// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "lucerna/design/fit/fit_problem.h"

namespace lucerna {

/// Whether `profile_search` can look: a mirror of revolution, a target in rings about its axis, few enough
/// parameters for chance to find its way, and no limits or bodies, which the table does not know.
bool can_search_profiles(const FitProblem& problem, const DesignShape& shape);

/// Where a search is: the best of the present round and its cost, evaluations so far, rays of the last and of
/// all.
struct ProfileProgress {
  DesignShape best;
  double cost = 0.0;
  int evaluations = 0;
  std::uint64_t rays = 0, total_rays = 0;
};
/// Called after every few evaluations; false ends the search.
using ProfileWatch = std::function<bool(const ProfileProgress&)>;

/// Evaluations of a whole search.
inline constexpr int kProfileEvaluations = 11;

/// Basins of a mirror of revolution, the cheapest first: up to 3000 shapes about the given one are fitted on
/// a table of what its zones throw (zone_table.h), the best hop on from where they ended, and those ahead are
/// traced. What the trace shows beside the table (second reflections), light and derivatives, is added to the
/// table near there, and the hops go on: space mapping (Bandler et al. 2004), two rounds: few shapes,
/// then fewer with more rays (at most `rays`). Deterministic: the same for any number
/// of threads. Costs about ten seconds of processor time with 2^22 rays. Ends early, with `whole` false,
/// where `watch` says so.
std::vector<InitialGuess> profile_search(const FitProblem& problem, const DesignShape& shape,
                                         std::uint64_t rays, const ProfileWatch& watch, bool& whole);

}  // namespace lucerna
