// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/parallel/parallel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "lucerna/core/io/error.h"

namespace lucerna {
namespace {

double harmonic_sum(int threads) {
  const ThreadLimit limit(threads);
  const auto parts = parallel_map_blocks<double>(1'000'001, 1000, [](std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t i = first; i < last; ++i) sum += 1.0 / (1.0 + static_cast<double>(i));
    return sum;
  });
  EXPECT_EQ(parts.size(), 1001u);
  return std::accumulate(parts.begin(), parts.end(), 0.0);
}

TEST(Parallel, SumsAreTheSameBitsForAnyNumberOfThreads) {
  const double one = harmonic_sum(1);
  EXPECT_EQ(one, harmonic_sum(2));
  EXPECT_EQ(one, harmonic_sum(7));
}

TEST(Parallel, NoItemsIsNoCall) {
  parallel_blocks(0, 10, [](std::size_t, std::size_t) { FAIL(); });
}

TEST(Parallel, ExceptionsReachTheCaller) {
  EXPECT_THROW(parallel_blocks(100, 1,
                               [](std::size_t i, std::size_t) {
                                 if (i == 57) throw InputError("57");
                               }),
               InputError);
}

}  // namespace
}  // namespace lucerna
