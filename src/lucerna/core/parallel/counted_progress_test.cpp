// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/parallel/counted_progress.h"

#include <gtest/gtest.h>

#include "lucerna/core/parallel/parallel.h"
#include "tests/support/one_at_a_time.h"

namespace lucerna {
namespace {

TEST(CountedProgress, CallsOneAtATimeWithGrowingCounts) {
  test::OneAtATime watch;
  CountedProgress counted(watch, "work", 0, 64);
  const ThreadLimit limit(4);
  parallel_blocks(64, 1, [&](std::size_t, std::size_t) { counted.add(1); });
  EXPECT_EQ(watch.calls, 64);
  EXPECT_EQ(watch.overlaps, 0);
  EXPECT_EQ(watch.falls, 0);
}

// What the test above would see: the same calls without the lock.
TEST(CountedProgress, CallsOfThreadsWouldMeet) {
  test::OneAtATime watch;
  const ThreadLimit limit(4);
  parallel_blocks(64, 1, [&](std::size_t i, std::size_t) { watch.update("work", i, 64); });
  EXPECT_GT(watch.overlaps + watch.falls, 0);
}

}  // namespace
}  // namespace lucerna
