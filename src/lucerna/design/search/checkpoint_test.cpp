// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/checkpoint.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {

namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::vector<std::uint64_t> bits_of(const std::vector<double>& v) {
  std::vector<std::uint64_t> bits;
  for (const double x : v) bits.push_back(std::bit_cast<std::uint64_t>(x));
  return bits;
}

/// Any finite double, its bits at random.
double any_double(Rng& rng) {
  double x = 0.0;
  do {
    const auto bits = static_cast<std::uint64_t>(rng.uniform() * 0x1p32) << 32 |
                      static_cast<std::uint64_t>(rng.uniform() * 0x1p32);
    x = std::bit_cast<double>(bits);
  } while (!std::isfinite(x));
  return x;
}

std::vector<double> any_doubles(Rng& rng) {
  std::vector<double> v(1 + static_cast<std::size_t>(rng.uniform() * 30.0));
  for (double& x : v) x = any_double(rng);
  return v;
}

FitSnapshot any_mark(Rng& rng) {
  return {any_double(rng),
          any_double(rng),
          any_double(rng),
          1 + static_cast<int>(100 * rng.uniform()),
          static_cast<int>(100 * rng.uniform()),
          any_doubles(rng)};
}

void expect_same(const FitSnapshot& a, const FitSnapshot& b) {
  EXPECT_EQ(bits_of({a.cost, a.error_to_noise, a.merit}), bits_of({b.cost, b.error_to_noise, b.merit}));
  EXPECT_EQ(a.intervals_x, b.intervals_x);
  EXPECT_EQ(a.intervals_y, b.intervals_y);
  EXPECT_EQ(bits_of(a.parameters), bits_of(b.parameters));
}

void expect_same(const RestartState& a, const RestartState& b) {
  EXPECT_EQ(a.begun, b.begun);
  EXPECT_EQ(a.failed, b.failed);
  expect_same(a.screened, b.screened);
  expect_same(a.best, b.best);
  expect_same(a.found, b.found);
  EXPECT_EQ(a.searches, b.searches);
  EXPECT_EQ(a.searches_left, b.searches_left);
  EXPECT_EQ(a.conjugate, b.conjugate);
  EXPECT_EQ(bits_of({a.incumbent_cost}), bits_of({b.incumbent_cost}));
}

FreeFormSnapshot any_candidate(Rng& rng) {
  return {static_cast<int>(1e9 * rng.uniform()),
          static_cast<int>(kFreeFormLevels * rng.uniform()),
          {any_double(rng), any_double(rng)},
          any_double(rng),
          any_double(rng),
          any_double(rng),
          any_double(rng),
          1 + static_cast<int>(100 * rng.uniform()),
          1 + static_cast<int>(100 * rng.uniform()),
          1 + static_cast<int>(100 * rng.uniform()),
          any_double(rng),
          static_cast<std::uint64_t>(rng.uniform() * 0x1p63),
          any_doubles(rng)};
}

void expect_same(const FreeFormSnapshot& a, const FreeFormSnapshot& b) {
  EXPECT_EQ(a.candidate, b.candidate);
  EXPECT_EQ(a.level, b.level);
  const auto numbers = [](const FreeFormSnapshot& m) {
    return bits_of({m.transport.sign, m.transport.vertex_distance_mm, m.cost, m.error, m.early_cost,
                    m.error_to_noise, m.derivative_noise});
  };
  EXPECT_EQ(numbers(a), numbers(b));
  EXPECT_EQ(a.bins, b.bins);
  EXPECT_EQ(a.derivative_rays, b.derivative_rays);
  EXPECT_EQ(a.intervals_x, b.intervals_x);
  EXPECT_EQ(a.intervals_y, b.intervals_y);
  EXPECT_EQ(bits_of(a.parameters), bits_of(b.parameters));
}

TEST(Checkpoint, AFreeFormStateSurvivesToTheBit) {
  Rng rng(12, 0);
  const auto count = [&] { return static_cast<int>(1e9 * rng.uniform()); };
  for (int k = 0; k < 50; ++k) {
    FreeFormState s;
    s.now = any_candidate(rng);
    s.step = count();
    s.refused = count();
    s.lambda = any_double(rng);
    s.costs = any_doubles(rng);
    s.begun = count();
    s.failed = count();
    s.evaluations = count();
    s.total_rays = static_cast<std::uint64_t>(rng.uniform() * 0x1p63);
    for (int i = 0; i < k % 5; ++i) s.done.push_back(any_candidate(rng));
    const FreeFormState t = parse_search_checkpoint(checkpoint_text(s, "key"), "key");
    expect_same(t.now, s.now);
    EXPECT_EQ(t.step, s.step);
    EXPECT_EQ(t.refused, s.refused);
    EXPECT_EQ(bits_of({t.lambda}), bits_of({s.lambda}));
    EXPECT_EQ(bits_of(t.costs), bits_of(s.costs));
    EXPECT_EQ(t.begun, s.begun);
    EXPECT_EQ(t.failed, s.failed);
    EXPECT_EQ(t.evaluations, s.evaluations);
    EXPECT_EQ(t.total_rays, s.total_rays);
    ASSERT_EQ(t.done.size(), s.done.size());
    for (std::size_t i = 0; i < s.done.size(); ++i) expect_same(t.done[i], s.done[i]);
  }
}

/// All that a step depends on comes back to the bit.
TEST(Checkpoint, AStateSurvivesToTheBit) {
  Rng rng(11, 0);
  const auto count = [&] { return static_cast<int>(1e9 * rng.uniform()); };
  for (int k = 0; k < 100; ++k) {
    FitState s;
    s.parameters = any_doubles(rng);
    s.intervals_x = 1 + k;
    s.intervals_y = k;
    s.stage = count();
    s.step = count();
    s.lambda = any_double(rng);
    s.costs = any_doubles(rng);
    s.refused = count();
    s.evaluations = count();
    s.total_rays = static_cast<std::uint64_t>(rng.uniform() * 0x1p63);
    s.error_to_noise = any_double(rng);
    s.restart = {count(), count(),    any_mark(rng), any_mark(rng),  count(),
                 count(), k % 2 == 0, any_mark(rng), any_double(rng)};
    s.search_costs = any_doubles(rng);
    const FitState t = parse_checkpoint(checkpoint_text(s, "key"), "key");
    EXPECT_EQ(bits_of(t.parameters), bits_of(s.parameters));
    EXPECT_EQ(t.intervals_x, s.intervals_x);
    EXPECT_EQ(t.intervals_y, s.intervals_y);
    EXPECT_EQ(t.stage, s.stage);
    EXPECT_EQ(t.step, s.step);
    EXPECT_EQ(bits_of({t.lambda, t.error_to_noise}), bits_of({s.lambda, s.error_to_noise}));
    EXPECT_EQ(bits_of(t.costs), bits_of(s.costs));
    EXPECT_EQ(t.refused, s.refused);
    EXPECT_EQ(t.evaluations, s.evaluations);
    EXPECT_EQ(t.total_rays, s.total_rays);
    expect_same(t.restart, s.restart);
    EXPECT_EQ(bits_of(t.search_costs), bits_of(s.search_costs));
  }
}

TEST(Checkpoint, FitStateOutOfRangeIsInputError) {
  FitState state;
  state.parameters = {1.0, 2.0};
  const std::string text = checkpoint_text(state, "key");
  EXPECT_EQ(checkpoint_text(parse_checkpoint(text, "key"), "key"), text);
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"intervals_x 1", "intervals_x 0"},
           {"intervals_x 1", "intervals_x 2000000000"},
           {"intervals_y 1", "intervals_y -3"},
           {"stage 0", "stage -1"},
           {"step 0", "step -1"},
           {"starts 1", "starts 2147483647"},
           {"search_restarts 0", "search_restarts -2"},
           {"search_restarts_left 0", "search_restarts_left 2147483647"},
           {"twin 0", "twin 2"},
           {"gate 0 0 0 1 1", "gate 0 0 0 1 2000000000"}}) {
    EXPECT_THROW(parse_checkpoint(replaced(text, from, to), "key"), InputError) << to;
  }
}

TEST(Checkpoint, SearchStateOutOfRangeIsInputError) {
  FreeFormState state;
  state.now.candidate = 7;
  state.now.level = 3;
  const std::string text = checkpoint_text(state, "key");
  EXPECT_EQ(checkpoint_text(parse_search_checkpoint(text, "key"), "key"), text);
  const std::string none = checkpoint_text(FreeFormState{}, "key");
  EXPECT_EQ(checkpoint_text(parse_search_checkpoint(none, "key"), "key"), none);
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"now 7 3 ", "now 7 4 "},
                                                        {"now 7 3 ", "now 7 -1 "},
                                                        {"now 7 3 ", "now -2 3 "},
                                                        {" 1 1 1 0 0 of", " 1 0 1 0 0 of"},
                                                        {" 1 1 1 0 0 of", " 1 1 0 0 0 of"},
                                                        {" 1 1 1 0 0 of", " 1 1 1 nan 0 of"},
                                                        {" 1 1 1 0 0 of", " 1 1 1 0 -1 of"},
                                                        {"step 0", "step -1"},
                                                        {"begun 0", "begun 2147483647"}}) {
    EXPECT_THROW(parse_search_checkpoint(replaced(text, from, to), "key"), InputError) << to;
  }
}

}  // namespace

}  // namespace lucerna
