// SPDX-License-Identifier: Apache-2.0
#include "lucerna/simd/dispatch.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

struct Table {
  int lanes;
};
template <int lanes>
const Table& table() {
  static constexpr Table kTable{lanes};
  return kTable;
}
constexpr Dispatch<Table> kAll{table<1>, table<4>, table<8>, table<16>};

TEST(Dispatch, TakesTheWidestThatTheProcessorRuns) {
  EXPECT_EQ(kAll.best().lanes, has_avx512() ? 16 : has_avx2() ? 8 : 4);
  EXPECT_EQ((Dispatch<Table>{.scalar = table<1>, .portable = table<4>}.best().lanes), 4);
  EXPECT_EQ((Dispatch<Table>{.scalar = table<1>}.best().lanes), 1);
}

TEST(Dispatch, NamesWhatThereIs) {
  EXPECT_EQ(kAll.named("scalar"), &table<1>());
  EXPECT_EQ(kAll.named("portable"), &table<4>());
  EXPECT_EQ(kAll.named("avx2"), has_avx2() ? &table<8>() : nullptr);
  EXPECT_EQ(kAll.named("avx512"), has_avx512() ? &table<16>() : nullptr);
  EXPECT_EQ(kAll.named("sse9"), nullptr);
  EXPECT_EQ((Dispatch<Table>{.scalar = table<1>}.named("portable")), nullptr);
}

}  // namespace
}  // namespace lucerna
