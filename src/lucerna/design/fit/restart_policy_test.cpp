// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/restart_policy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "lucerna/random.h"

namespace lucerna {
namespace {

FitStage stage_of(bool search, bool screening) {
  FitStage s;
  s.search = search;
  s.screening = screening;
  return s;
}

/// Two stages of the search (or none), a coarse one, the screening stage, a fine one and the last.
ContinuationSchedule schedule(bool with_search) {
  std::vector<FitStage> stages;
  if (with_search) stages.assign(2, stage_of(true, false));
  for (const bool screening : {false, true, false, false}) stages.push_back(stage_of(false, screening));
  return ContinuationSchedule(stages);
}

RestartPolicy policy(bool with_search, int max_failed = 5) {
  RestartRules rules;
  rules.guesses.assign(7, InitialKnots::few_knots);
  rules.max_failed = max_failed;
  return {rules, schedule(with_search)};
}

/// How a fit goes whose stages end at random: what a policy said, and how.
struct Walk {
  std::vector<FitBranch> branches;
  /// Merit functions of all that came to the end; and of the incumbent after each stage.
  std::vector<double> ends, incumbents;
  RestartState state;
  bool ended = false;
};

/// A snapshot of error `error` with noise 0.01, distinguished by its parameter.
FitSnapshot snapshot(double error, double id) {
  const double cost = error * error;
  return {cost, error / 0.01, cost, 1, 1, {id}};
}

Walk walk(const RestartPolicy& policy, const std::function<double(Rng&)>& error, std::uint64_t seed) {
  Walk w;
  Rng rng(seed, 0);
  std::size_t stage = policy.first().stage;
  for (int k = 0; k < 20'000 && !w.ended; ++k) {
    const FitSnapshot now = snapshot(error(rng), k);
    if (stage + 1 == policy.schedule().size()) w.ends.push_back(now.merit);
    const FitBranch b = policy.after(stage, now, w.state);
    w.branches.push_back(b);
    w.incumbents.push_back(w.state.best.exists() ? w.state.best.merit
                                                 : std::numeric_limits<double>::infinity());
    w.ended = b.kind == FitBranch::Kind::end;
    stage = b.kind == FitBranch::Kind::next ? stage + 1 : b.stage;
  }
  return w;
}

double near(Rng& rng) { return 0.03 + 0.04 * rng.uniform(); }
double far(Rng& rng) { return 0.1 + 0.4 * rng.uniform(); }

bool same(const FitBranch& a, const FitBranch& b) {
  return a.kind == b.kind && a.stage == b.stage && a.start == b.start &&
         a.snapshot.parameters == b.snapshot.parameters && a.perturbation == b.perturbation &&
         a.stream == b.stream;
}

TEST(RestartPolicy, NeverLosesTheIncumbent) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Walk w = walk(policy(seed % 2 == 0), seed % 3 == 0 ? far : near, seed);
    ASSERT_TRUE(w.ended) << seed;
    ASSERT_FALSE(w.ends.empty()) << seed;
    EXPECT_TRUE(std::is_sorted(w.incumbents.rbegin(), w.incumbents.rend())) << seed;
    const double best = *std::min_element(w.ends.begin(), w.ends.end());
    EXPECT_EQ(w.state.best.merit, best) << seed;
    EXPECT_EQ(w.branches.back().snapshot.parameters, w.state.best.parameters) << seed;
  }
}

TEST(RestartPolicy, SameStateSameBranch) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Walk a = walk(policy(true), near, seed), b = walk(policy(true), near, seed);
    ASSERT_EQ(a.branches.size(), b.branches.size());
    EXPECT_TRUE(std::equal(a.branches.begin(), a.branches.end(), b.branches.begin(), same)) << seed;
  }
}

/// Each random copy has a stream of its own: no restart is a repetition of another.
TEST(RestartPolicy, NoTwoPerturbationsAreTheSame) {
  for (const bool with_search : {false, true}) {
    std::vector<std::uint64_t> streams;
    for (const FitBranch& b : walk(policy(with_search, 30), far, 3).branches) {
      if (b.perturbation > 0.0) streams.push_back(b.stream);
    }
    EXPECT_GT(streams.size(), 10u);
    std::sort(streams.begin(), streams.end());
    EXPECT_EQ(std::adjacent_find(streams.begin(), streams.end()), streams.end());
  }
}

TEST(RestartPolicy, StagesAreOfTheSchedule) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Walk w = walk(policy(true), near, seed);
    std::size_t stage = policy(true).first().stage;
    for (const FitBranch& b : w.branches) {
      stage = b.kind == FitBranch::Kind::next ? stage + 1 : b.stage;
      if (b.kind != FitBranch::Kind::end) {
        EXPECT_LT(stage, schedule(true).size());
      }
      if (b.kind == FitBranch::Kind::restored) {
        EXPECT_EQ(stage, schedule(true).screening() + 1);
      }
    }
  }
}

TEST(RestartPolicy, ComparesTheFirstStartsUntilOneIsGood) {
  const auto begun = [](double error) {
    RestartState state;
    const RestartPolicy p = policy(false);
    int n = 1;
    while (p.after(p.schedule().screening(), snapshot(error, 1), state).start) ++n;
    return n;
  };
  EXPECT_EQ(begun(0.3), 5);    // 30 times the noise: all that may be compared
  EXPECT_EQ(begun(0.014), 1);  // 1.4 times
}

TEST(RestartPolicy, EndsAtTheNoiseOrAfterRestartsThatGainNothing) {
  const RestartPolicy p = policy(false, 3);
  const std::size_t last = p.schedule().size() - 1;
  RestartState state;
  EXPECT_EQ(p.after(last, snapshot(0.0104, 1), state).kind, FitBranch::Kind::end);
  EXPECT_TRUE(p.at_noise(state));
  state = {};
  EXPECT_EQ(p.after(last, snapshot(0.3, 1), state).kind, FitBranch::Kind::begin);
  EXPECT_FALSE(p.at_noise(state));
  EXPECT_EQ(p.after(last, snapshot(0.299, 2), state).kind, FitBranch::Kind::begin);  // less than 3 % gained
  EXPECT_EQ(p.after(last, snapshot(0.28, 3), state).kind, FitBranch::Kind::begin);
  EXPECT_EQ(state.failed, 0);
  for (int k = 0; k < 2; ++k) EXPECT_EQ(p.after(last, snapshot(0.4, 4), state).kind, FitBranch::Kind::begin);
  const FitBranch end = p.after(last, snapshot(0.4, 5), state);
  EXPECT_EQ(end.kind, FitBranch::Kind::end);
  EXPECT_EQ(end.snapshot.parameters, std::vector<double>{3});
}

TEST(RestartPolicy, SearchesOnlyNearTheTargetAndAboveTheNoise) {
  const auto after_all_starts = [](double error, bool with_search) {
    RestartState state;
    const RestartPolicy p = policy(with_search);
    FitBranch b;
    do {
      b = p.after(p.schedule().screening(), snapshot(error, 1), state);
    } while (b.start);
    return b.kind;
  };
  EXPECT_EQ(after_all_starts(0.04, true), FitBranch::Kind::begin);  // the incumbent in the search
  EXPECT_EQ(after_all_starts(0.04, false), FitBranch::Kind::restored);
  EXPECT_EQ(after_all_starts(0.3, true), FitBranch::Kind::restored);
  EXPECT_EQ(after_all_starts(0.011, true), FitBranch::Kind::restored);
}

/// Every search restart near the incumbent is followed by its conjugate, and no conjugate by another.
TEST(RestartPolicy, TriesTheConjugateOfWhatIsNear) {
  const RestartPolicy p = policy(true);
  const std::size_t last_search = p.schedule().search_stages() - 1;
  RestartState state;
  state.screened = snapshot(0.04, 1);
  state.searches = 1;
  state.searches_left = 9;
  EXPECT_EQ(p.after(last_search, snapshot(0.04, 2), state).kind, FitBranch::Kind::conjugate);
  EXPECT_EQ(p.after(last_search, snapshot(0.041, 3), state).kind, FitBranch::Kind::begin);
  EXPECT_FALSE(p.after(last_search, snapshot(0.06, 4), state).kind == FitBranch::Kind::conjugate);  // too far
  EXPECT_EQ(p.after(last_search, snapshot(0.05, 5), state).kind, FitBranch::Kind::conjugate);
  const FitBranch better = p.after(last_search, snapshot(0.03, 6), state);
  EXPECT_EQ(better.kind, FitBranch::Kind::begin);
  EXPECT_EQ(better.stage, p.schedule().screening());
  EXPECT_EQ(better.snapshot.parameters, std::vector<double>{6});
}

}  // namespace
}  // namespace lucerna
