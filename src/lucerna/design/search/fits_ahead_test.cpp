// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/fits_ahead.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "lucerna/core/io/error.h"
#include "lucerna/design/search/checkpoint.h"

namespace lucerna {
namespace {

FreeFormSnapshot candidate(int number, double vertex_mm) {
  FreeFormSnapshot out;
  out.candidate = number;
  out.level = 0;
  out.transport = {-1.0, vertex_mm};
  return out;
}

RoughFit two_steps(int number, double vertex_mm) {
  RoughFit fit{number, {-1.0, vertex_mm}, {}};
  for (int step = 0; step < 2; ++step) {
    RoughStep s;
    s.state.now = candidate(number, vertex_mm);
    s.state.now.parameters = {0.1 * step, 1.0 / 3.0};
    s.state.step = step;
    s.state.costs = {0.1 + 0.2};
    s.state.evaluations = step + 1;
    s.state.total_rays = std::uint64_t{1000} * static_cast<std::uint64_t>(step + 1);
    s.record.error = 1.0 / 7.0;
    s.record.accepted = step == 0;
    fit.steps.push_back(s);
  }
  return fit;
}

TEST(FitsAhead, MessagesKeepAllBits) {
  const RoughFit fit = two_steps(3, 0.1);
  const RoughFit same = rough_fit_of(message_of(fit));
  EXPECT_EQ(same.candidate, 3);
  EXPECT_EQ(same.transport.vertex_distance_mm, 0.1);
  ASSERT_EQ(same.steps.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(checkpoint_text(same.steps[i].state, "k"), checkpoint_text(fit.steps[i].state, "k"));
    EXPECT_EQ(same.steps[i].record.error, fit.steps[i].record.error);
    EXPECT_EQ(same.steps[i].record.accepted, fit.steps[i].record.accepted);
  }
  EXPECT_TRUE(rough_fit_of(message_of({7, {}, {}})).steps.empty());
}

TEST(FitsAhead, OneThatWasToBeginOtherwiseIsNone) {
  const std::vector<RoughFit> fits{two_steps(3, 10.0), two_steps(4, 12.0)};
  EXPECT_TRUE(is_among(fits, candidate(4, 12.0)));
  EXPECT_FALSE(is_among(fits, candidate(4, 10.0)));
  EXPECT_FALSE(is_among(fits, candidate(5, 12.0)));
}

TEST(FitsAhead, OnesThatWereLeftOutGoWithTheTaken) {
  std::vector<RoughFit> fits{two_steps(3, 10.0), two_steps(4, 12.0), two_steps(5, 12.0)};
  EXPECT_EQ(taken_from(fits, candidate(4, 12.0)).candidate, 4);
  ASSERT_EQ(fits.size(), 1u);
  EXPECT_EQ(fits[0].candidate, 5);
  EXPECT_THROW(taken_from(fits, candidate(4, 12.0)), std::logic_error);
}

TEST(FitsAhead, StepsGoOnFromWhatTheSearchHadCost) {
  FreeFormState before;
  before.evaluations = 10;
  before.total_rays = 500;
  RoughReplay replay(two_steps(3, 10.0), before);
  EXPECT_TRUE(replay.has_start());
  EXPECT_EQ(replay.next().record.evaluations, 11);
  const RoughStep last = replay.next();
  EXPECT_EQ(last.state.total_rays, 2500u);
  EXPECT_EQ(last.record.total_rays, 2500u);
  EXPECT_THROW(replay.next(), std::logic_error);
  EXPECT_FALSE(RoughReplay(RoughFit{}, before).has_start());
}

}  // namespace
}  // namespace lucerna
