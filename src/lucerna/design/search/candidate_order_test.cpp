// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/candidate_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/random.h"

namespace lucerna {
namespace {

/// A candidate that came to the end of a level. One above 0 began with a transport.
FreeFormSnapshot ended(int candidate, int level, double cost) {
  FreeFormSnapshot m;
  m.candidate = candidate;
  m.level = level;
  m.cost = cost;
  m.error = std::sqrt(cost / error_share(level));
  m.error_to_noise = 10.0;
  if (candidate > 0) m.transport = {-1.0, 10.0};
  m.parameters = {1.0};
  return m;
}

FreeFormSnapshot approach(int number, int level, double cost) {
  FreeFormSnapshot m = ended(kFirstApproach + number, level, cost);
  m.transport = {};
  return m;
}

/// The first candidates after their rough level; what these cost.
FreeFormState after_rough(const std::vector<double>& costs) {
  FreeFormState s;
  for (const double cost : costs) s.done.push_back(ended(s.begun++, 0, cost));
  return s;
}

/// All first candidates but the approaches, which did not help.
FreeFormState after_first_candidates() {
  FreeFormState s;
  for (int n = 0; n < kFirstNeighbour; ++n) {
    if (n < kFirstApproach || n >= kAfterApproaches) s.done.push_back(ended(n, 0, 1e-3 * (1 + n)));
  }
  s.begun = kFirstNeighbour;
  return s;
}

/// "2 1": candidate and level of the next promotion; "new 3": the candidate that begins.
std::string next(const CandidateRules& rules, const FreeFormState& s) {
  const CandidateOrder order(rules, s);
  const FreeFormSnapshot* m = order.next_promotion();
  if (m == nullptr) return "new " + std::to_string(order.next_number(s.begun));
  return std::to_string(m->candidate) + " " + std::to_string(m->level + 1);
}

constexpr CandidateRules kManyKnots{.max_neighbours = 6}, kFewKnots{.has_few_knots = true};

TEST(CandidateOrder, TheBestOfAFewIsFittedFinelyFirst) {
  EXPECT_EQ(next(kManyKnots, {}), "new 0");
  FreeFormState s = after_rough({4e-3, 2e-3});
  EXPECT_EQ(next(kManyKnots, s), "new 2");
  s = after_rough({4e-3, 2e-3, 3e-3});
  EXPECT_EQ(next(kManyKnots, s), "1 1");
  s.done.push_back(ended(1, 1, 1e-4));
  EXPECT_EQ(next(kManyKnots, s), "new " + std::to_string(kAfterApproaches)) << "the others begin";
}

TEST(CandidateOrder, AMirrorOfFewKnotsIsApproachedWhereNoneIsNear) {
  for (const auto& [cost, is_near] : {std::pair{1e-4, true}, {2e-3, false}}) {
    const FreeFormState s = after_rough({5e-3, cost, 6e-3});
    EXPECT_EQ(next(kFewKnots, s), is_near ? "1 1" : "new " + std::to_string(kFirstApproach)) << cost;
    EXPECT_EQ(next(kManyKnots, s), "1 1") << cost;
  }
  // The given mirror is the nearest of them, or it has no approach at all: a face, or one whose knots are
  // fixed, which is brought near as candidate 0.
  const FreeFormState s = after_rough({1e-4, 2e-4, 3e-4});
  EXPECT_EQ(next(kFewKnots, s), "new " + std::to_string(kFirstApproach));
  EXPECT_EQ(next({.has_few_knots = true, .is_face = true}, s), "0 1");
  EXPECT_EQ(next({.has_few_knots = true, .keeps_its_knots = true}, s), "0 1");
}

// A wide source's 60 s would be over before any mirror came to the end.
TEST(CandidateOrder, TheBetterOfTwoApproachesComesToTheEndBeforeOthersBegin) {
  for (const int better : {0, 1}) {
    FreeFormState s = after_rough({3e-3, 4e-3, 5e-3});
    s.done.push_back(approach(0, 0, better == 0 ? 2e-3 : 2.5e-3));
    s.begun = kFirstApproach + 1;
    EXPECT_EQ(next(kFewKnots, s), "new " + std::to_string(kFirstApproach + 1));
    s.done.push_back(approach(1, 0, better == 1 ? 2e-3 : 2.5e-3));
    s.begun = kFirstApproach + 2;
    for (const int level : {1, 2}) {
      EXPECT_EQ(next(kFewKnots, s), std::to_string(kFirstApproach + better) + " " + std::to_string(level));
      s.done.push_back(approach(better, level, 1e-3));
    }
    EXPECT_EQ(next(kFewKnots, s), "new " + std::to_string(kFirstApproach + 2));
  }
}

// One that is at the target needs no other beside it.
TEST(CandidateOrder, AnApproachThatIsNearGoesOnAlone) {
  FreeFormState s = after_rough({3e-3, 4e-3, 5e-3});
  FreeFormSnapshot near = approach(0, 0, 1e-6);
  near.error_to_noise = 1.0;
  s.done.push_back(near);
  s.begun = kFirstApproach + 1;
  EXPECT_EQ(next(kFewKnots, s), std::to_string(kFirstApproach) + " 1");
}

TEST(CandidateOrder, ThreeAreFittedFinelyAndTheBestToTheEnd) {
  FreeFormState s = after_first_candidates();
  for (const int candidate : {0, 1, 2}) {
    EXPECT_EQ(next(kManyKnots, s), std::to_string(candidate) + " 1");
    s.done.push_back(ended(candidate, 1, candidate == 1 ? 1e-4 : 2e-4));
  }
  EXPECT_EQ(next(kManyKnots, s), "1 2");
  // One that costs four times the best does not go on, be it among the best three.
  s = after_first_candidates();
  s.done[1].cost = s.done[2].cost = 0.1;
  s.done.push_back(ended(0, 1, 1e-4));
  s.done.push_back(ended(kAfterApproaches, 1, 1e-4));
  for (FreeFormSnapshot& m : s.done) {
    if (m.level == 0 && m.candidate >= kAfterApproaches) m.cost = 0.1;
  }
  EXPECT_EQ(next(kManyKnots, s), "0 2");
}

TEST(CandidateOrder, MoreRaysFollowAtOnceWhereNoiseIsMuchOfTheError) {
  FreeFormState s = after_first_candidates();
  for (const int candidate : {0, 1, 2}) s.done.push_back(ended(candidate, 1, 1e-4 * (1 + candidate)));
  s.done.push_back(ended(0, 2, 1e-4));
  s.done.back().error_to_noise = 1.2;
  EXPECT_EQ(next(kManyKnots, s), "0 3");
  s.done.back().error_to_noise = 10.0;
  for (; s.begun < kFirstNeighbour + 4; ++s.begun)
    EXPECT_EQ(next(kManyKnots, s), "new " + std::to_string(s.begun)) << "neighbours first";
  EXPECT_EQ(next(kManyKnots, s), "0 3");
}

TEST(CandidateOrder, AChosenStartGoesToTheEndBeforeTheOthersBegin) {
  const CandidateRules chosen{.start_is_chosen = true};
  FreeFormState s = after_rough({2e-3});
  EXPECT_EQ(next(chosen, s), "new 1");
  s = after_rough({2e-3, 3e-3});
  for (const int level : {1, 2}) {
    EXPECT_EQ(next(chosen, s), "0 " + std::to_string(level));
    s.done.push_back(ended(0, level, 1e-4));
  }
  EXPECT_EQ(next(chosen, s), "new 2");
}

TEST(CandidateOrder, ARoughLevelThatLeadsNowhereHasTwoSteps) {
  const FreeFormState s = after_rough({1e-3});
  const CandidateOrder order(kManyKnots, s);
  EXPECT_FALSE(order.is_hopeless(ended(1, 0, 4.1e-3), 1));
  EXPECT_TRUE(order.is_hopeless(ended(1, 0, 4.1e-3), 2));
  EXPECT_FALSE(order.is_hopeless(ended(1, 0, 3.9e-3), 2));
  EXPECT_FALSE(order.is_hopeless(ended(1, 1, 4.1e-3), 2));
}

TEST(CandidateOrder, EndsAfterEightInARowThatHaveNoStart) {
  FreeFormState s = after_first_candidates();
  for (FreeFormSnapshot& m : s.done) m.parameters.clear();
  s.failed = 7;
  EXPECT_FALSE(CandidateOrder(kManyKnots, s).is_at_end());
  s.failed = 8;
  EXPECT_TRUE(CandidateOrder(kManyKnots, s).is_out_of_candidates());
  EXPECT_TRUE(CandidateOrder(kManyKnots, s).is_at_end());
}

/// A whole search whose candidates cost what chance says; expects of each step what holds for any costs.
void expect_sound_search(const CandidateRules& rules, Rng& rng) {
  FreeFormState s;
  const CandidateOrder order(rules, s);
  std::set<std::pair<int, int>> had;
  const int most = kFreeFormLevels * (kFirstNeighbour + rules.max_neighbours);
  for (int step = 0; !order.is_at_end(); ++step) {
    ASSERT_LT(step, most) << "it never ends";
    FreeFormSnapshot m;
    if (const FreeFormSnapshot* from = order.next_promotion()) {
      ASSERT_FALSE(from->parameters.empty()) << "what was forgotten is taken up";
      m = *from;
      ++m.level;
      ASSERT_LT(m.level, kFreeFormLevels);
      ASSERT_TRUE(had.contains({m.candidate, m.level - 1}));
    } else {
      const int number = order.next_number(s.begun);
      ASSERT_GE(number, s.begun);
      s.begun = number + 1;
      s.failed = rng.uniform() < 0.3 ? s.failed + 1 : 0;
      if (s.failed > 0) continue;
      m = ended(number, 0, 1.0);
      if (number >= kFirstApproach && number < kAfterApproaches) m.transport = {};
    }
    m.cost = std::pow(10.0, -2.0 - m.level - 2.0 * rng.uniform());
    m.error = std::sqrt(m.cost / error_share(m.level));
    m.error_to_noise = 1.0 + 3.0 * rng.uniform();
    ASSERT_TRUE(had.insert({m.candidate, m.level}).second) << "fitted twice";
    s.done.push_back(m);
    for (FreeFormSnapshot& each : s.done) {
      if (order.is_over(each)) each.parameters.clear();
    }
  }
}

TEST(CandidateOrder, WhateverCandidatesCostItEndsAndFitsNoneTwice) {
  Rng rng(7, 0);
  for (int i = 0; i < 2000 && !::testing::Test::HasFailure(); ++i) {
    const CandidateRules rules{.has_few_knots = rng.uniform() < 0.5,
                               .keeps_its_knots = rng.uniform() < 0.3,
                               .is_face = rng.uniform() < 0.2,
                               .start_is_chosen = rng.uniform() < 0.2,
                               .max_neighbours = static_cast<int>(8.0 * rng.uniform())};
    expect_sound_search(rules, rng);
  }
}

}  // namespace
}  // namespace lucerna
