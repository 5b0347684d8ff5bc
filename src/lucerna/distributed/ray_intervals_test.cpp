// SPDX-License-Identifier: Apache-2.0
#include "lucerna/distributed/ray_intervals.h"

#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

// Against a set of flags: any order of adding gives the same intervals, and what is missing is the rest.
TEST(RayIntervals, AreTheSetThatWasAdded) {
  constexpr std::uint64_t kRays = 60;
  Rng rng(1, 0);
  for (int run = 0; run < 500; ++run) {
    RayIntervals set;
    std::vector<bool> flags(kRays, false);
    for (int k = 0; k < 12; ++k) {
      const std::uint64_t first = rng.bits() % kRays, last = first + 1 + rng.bits() % (kRays - first);
      bool taken = false;
      for (std::uint64_t i = first; i < last; ++i) taken = taken || flags[i];
      ASSERT_EQ(set.overlaps({first, last}), taken);
      if (taken) continue;
      set.add({first, last});
      for (std::uint64_t i = first; i < last; ++i) flags[i] = true;
    }
    std::uint64_t count = 0;
    for (std::uint64_t i = 0; i < kRays; ++i) {
      count += flags[i] ? 1 : 0;
      ASSERT_EQ(set.overlaps({i, i + 1}), flags[i]);
    }
    ASSERT_EQ(set.count(), count);
    for (std::size_t k = 1; k < set.all().size(); ++k)
      ASSERT_LT(set.all()[k - 1].last, set.all()[k].first) << "neighbours are joined";
    RayIntervals rest;
    const std::uint64_t chunk = 1 + rng.bits() % 20;
    for (const RayInterval& c : set.missing({0, kRays}, chunk)) {
      EXPECT_EQ(c.first / chunk, (c.last - 1) / chunk) << "no chunk goes over a border";
      rest.add(c);
    }
    ASSERT_FALSE(rest.overlaps(set));
    rest.add(set);
    ASSERT_EQ(rest.all(), (std::vector<RayInterval>{{0, kRays}}));
  }
}

TEST(RayIntervals, ChunksKeepWithinTheRange) {
  RayIntervals done;
  done.add({0, 5});
  done.add({25, 100});
  EXPECT_EQ(done.missing({3, 30}, 10), (std::vector<RayInterval>{{5, 10}, {10, 20}, {20, 25}}));
  EXPECT_EQ(RayIntervals().missing({7, 9}, 10), (std::vector<RayInterval>{{7, 9}}));
}

TEST(RayIntervals, WhatIsThereIsNotAddedTwice) {
  RayIntervals done;
  done.add({10, 20});
  EXPECT_THROW(done.add({19, 21}), std::exception);
  EXPECT_THROW(done.add({5, 5}), std::exception);
}

}  // namespace
}  // namespace lucerna
