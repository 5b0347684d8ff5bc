// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/codec/range_coder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lucerna/random.h"

namespace lucerna {
namespace {

TEST(RangeCoder, BitsComeBackAndCostTheirEntropy) {
  for (const double p : {0.5, 0.1, 0.01, 0.0}) {
    constexpr int kBits = 60000;
    Rng draw(1, 1);
    std::vector<bool> bits;
    for (int i = 0; i < kBits; ++i) bits.push_back(draw.uniform() < p);
    RangeEncoder encoder;
    AdaptiveBit model;
    for (const bool b : bits) encoder.bit(model, b);
    const std::string bytes = encoder.finish();
    RangeDecoder decoder(bytes);
    model = {};
    for (const bool b : bits) ASSERT_EQ(decoder.bit(model), b);
    EXPECT_FALSE(decoder.overrun());
    const double entropy = p > 0.0 ? -p * std::log2(p) - (1 - p) * std::log2(1 - p) : 0.0;
    EXPECT_LT(8.0 * static_cast<double>(bytes.size()), 1.02 * kBits * entropy + 0.012 * kBits + 64.0) << p;
  }
}

TEST(RangeCoder, SymbolsComeBack) {
  RangeEncoder encoder;
  AdaptiveSymbol<6> a;
  AdaptiveSymbol<2> b;
  Rng draw(2, 1);
  std::vector<std::uint32_t> numbers;
  for (int i = 0; i < 5000; ++i) numbers.push_back(draw.bits());
  for (const std::uint32_t x : numbers) a.encode(encoder, x & 63u), b.encode(encoder, x >> 6 & 3u);
  const std::string bytes = encoder.finish();
  RangeDecoder decoder(bytes);
  a = {}, b = {};
  for (const std::uint32_t x : numbers) {
    ASSERT_EQ(a.decode(decoder), x & 63u);
    ASSERT_EQ(b.decode(decoder), x >> 6 & 3u);
  }
}

TEST(RangeCoder, CarriesRunThroughManyBytes) {
  // Long runs of the improbable symbol drive the interval to its upper end, where carries happen.
  for (int run = 1; run < 200; ++run) {
    RangeEncoder encoder;
    AdaptiveBit model;
    for (int i = 0; i < 300; ++i) encoder.bit(model, i >= run);
    for (int i = 0; i < run; ++i) encoder.bit(model, true);
    encoder.bit(model, false);
    const std::string bytes = encoder.finish();
    RangeDecoder decoder(bytes);
    model = {};
    for (int i = 0; i < 300; ++i) ASSERT_EQ(decoder.bit(model), i >= run);
    for (int i = 0; i < run; ++i) ASSERT_TRUE(decoder.bit(model));
    ASSERT_FALSE(decoder.bit(model));
  }
}

TEST(RangeCoder, SaysWhenTheBytesEnd) {
  RangeEncoder encoder;
  AdaptiveBit model;
  Rng draw(3, 1);
  for (int i = 0; i < 1000; ++i) encoder.bit(model, draw.uniform() < 0.5);
  const std::string bytes = encoder.finish().substr(0, 50);
  RangeDecoder decoder(bytes);
  model = {};
  for (int i = 0; i < 1000; ++i) decoder.bit(model);
  EXPECT_TRUE(decoder.overrun());
}

}  // namespace
}  // namespace lucerna
