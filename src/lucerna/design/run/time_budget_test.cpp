// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/time_budget.h"

#include <gtest/gtest.h>

#include "tests/support/local_peers.h"

namespace lucerna {
namespace {

TEST(TimeBudget, ASearchMayUseAllThatIsNotNeededLater) {
  TimeBudget ample(1e9);
  ample.begin_search(1.0, 1'000'000);
  EXPECT_FALSE(ample.spent(0, 1'000'000));
  EXPECT_FALSE(ample.spent(1'000'000, 1'000'000));
  EXPECT_GT(ample.left_s(), 1e8);

  TimeBudget none(0.0);
  none.begin_search(0.0, 0);
  EXPECT_TRUE(none.spent(1, 1));
  EXPECT_LE(none.left_s(), 0.0);
}

TEST(TimeBudget, TheFirstOfSeveralProcessesDecides) {
  test::on_peers(3, [](Peers& peers) {
    const bool first = peers.rank() == 0;
    TimeBudget spent(first ? 0.0 : 1e9, &peers);
    EXPECT_TRUE(spent.spent(0, 1));
    TimeBudget ample(first ? 1e9 : 0.0, &peers);
    EXPECT_FALSE(ample.spent(0, 1));
  });
}

/// What follows has a third of the time at most, however long it would take.
TEST(TimeBudget, WhatFollowsHasAThirdAtMost) {
  TimeBudget time(1e6);
  time.begin_search(1e9, 0);
  EXPECT_FALSE(time.spent(1, 1));
  EXPECT_GT(time.left_s(), 0.9e6);
}

/// Steps are foreseen by their rays: one of 10^15 of them would take more than is left.
TEST(TimeBudget, ForeseesAStepThatWouldTakeTooLong) {
  TimeBudget time(100.0);
  time.begin_search(0.0, 0);
  EXPECT_EQ(time.rays_after_s(), 0.0);
  volatile double work = 0.0;
  for (int i = 0; i < 1'000'000; ++i) work = work + 1.0;  // some time for one ray
  EXPECT_TRUE(time.spent(1, 1'000'000'000'000'000));
}

}  // namespace
}  // namespace lucerna
