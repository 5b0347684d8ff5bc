// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/number_batch.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

TEST(NumberBatch, IsTheSequenceToTheBit) {
  std::array<BitColumn, 4> bits;
  for (const SequenceKind kind : {SequenceKind::random, SequenceKind::sobol}) {
    for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{0x123456789ABCDEF0}}) {
      // Aligned, not aligned, across 2^32 and the end of 64 bits.
      for (const std::uint64_t first : {0ull, 128ull, 1000003ull, 4294967200ull, 1ull << 40, ~0ull - 60}) {
        const Sequence sequence(kind, seed);
        number_batch(sequence, first, bits);
        for (std::size_t i = 0; i < kSupportBatch; ++i) {
          const auto u = sequence.point<4>(first + i);
          for (std::size_t d = 0; d < 4; ++d)
            ASSERT_EQ(unit_from_bits(bits[d][i]), u[d]) << first << " " << i;
        }
      }
    }
  }
}

}  // namespace
}  // namespace lucerna
