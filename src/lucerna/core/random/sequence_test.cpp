// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

TEST(Sobol, EveryDimensionFillsEveryStratumOnce) {
  for (const std::uint64_t seed : {1ull, 2ull, 99ull}) {
    for (std::uint32_t d = 0; d < kSobolDimensions; ++d) {
      std::set<std::uint32_t> strata;
      for (std::uint64_t i = 0; i < 1024; ++i) strata.insert(owen_sobol_bits(i, d, seed) >> 22);
      EXPECT_EQ(strata.size(), 1024u) << "dimension " << d << ", seed " << seed;
    }
  }
}

TEST(Sobol, FirstTwoDimensionsAreANetInBaseTwo) {
  // 1024 points put one point in each elementary interval of every shape 2^-a x 2^-(10-a): a (0, 10, 2)-net.
  for (std::uint32_t a = 0; a <= 10; ++a) {
    std::set<std::uint64_t> cells;
    for (std::uint64_t i = 0; i < 1024; ++i) {
      const std::uint64_t x = a == 0 ? 0 : owen_sobol_bits(i, 0, 5) >> (32 - a);
      const std::uint64_t y = a == 10 ? 0 : owen_sobol_bits(i, 1, 5) >> (22 + a);
      cells.insert(x << 32 | y);
    }
    EXPECT_EQ(cells.size(), 1024u) << "shape " << a;
  }
}

double integration_error(SequenceKind kind) {
  // RMS over scramblings of the error of a smooth 4-dimensional integral, mean 1 by construction.
  double sum_squares = 0.0;
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    const Sequence sequence(kind, seed);
    double sum = 0.0;
    for (std::uint64_t i = 0; i < 4096; ++i) {
      double product = 1.0;
      for (const double u : sequence.point<4>(i)) product *= 0.5 + u;
      sum += product;
    }
    sum_squares += std::pow(sum / 4096.0 - 1.0, 2.0);
  }
  return std::sqrt(sum_squares / 16.0);
}

TEST(SobolStatistical, IntegratesSmoothFunctionsFarBetterThanRandomPoints) {
  EXPECT_LT(integration_error(SequenceKind::sobol), 0.05 * integration_error(SequenceKind::random));
}

TEST(Sobol, ScramblingsWithOtherSeedsDiffer) {
  EXPECT_NE(owen_sobol_bits(3, 0, 1), owen_sobol_bits(3, 0, 2));
  EXPECT_NE(owen_sobol_bits(3, 0, 1), owen_sobol_bits(3 + (1ull << 32), 0, 1));
}

TEST(Sequence, PointsAreInTheHalfOpenCubeAndRepeat) {
  for (const SequenceKind kind : {SequenceKind::random, SequenceKind::sobol}) {
    const Sequence sequence(kind, 42);
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const auto u = sequence.point<6>(i);
      EXPECT_EQ(u, sequence.point<6>(i));
      for (const double x : u) EXPECT_TRUE(x >= 0.0 && x < 1.0);
    }
  }
}

TEST(Sequence, NamesRoundTripAndOthersAreRefused) {
  EXPECT_EQ(sequence_kind(to_string(SequenceKind::sobol)), SequenceKind::sobol);
  EXPECT_EQ(sequence_kind("random"), SequenceKind::random);
  EXPECT_THROW(sequence_kind("halton"), UsageError);
}

}  // namespace
}  // namespace lucerna
