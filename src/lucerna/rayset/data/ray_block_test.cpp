// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/rays.h"

namespace lucerna {
namespace {

RayBlock random_block(std::size_t n, std::size_t columns, std::uint64_t seed) {
  RayBlock block;
  block.resize(n, columns);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(seed, i);
    block.set(i, {{rng.uniform(), rng.uniform(), rng.uniform()}, Direction::from({rng.uniform(), 1.0, 0.5})});
    block.weight[i] = static_cast<float>(rng.uniform());
    for (auto& column : block.extra) column[i] = static_cast<float>(rng.uniform());
  }
  return block;
}

TEST(RayBlock, AppendingRayByRayOrAllAtOnceIsTheSame) {
  const RayBlock a = random_block(7, 2, 1), b = random_block(5, 2, 2);
  RayBlock whole = a, piecewise = a;
  whole.append(b);
  for (std::size_t i = 0; i < b.size(); ++i) piecewise.append(b, i);
  EXPECT_EQ(whole.size(), 12u);
  EXPECT_EQ(whole, piecewise);
  RayBlock from_nothing;
  from_nothing.append(a);
  EXPECT_EQ(from_nothing, a);
}

TEST(RayBlock, LargeColumnsLieEquallyFarApart) {
  const auto gap = [](const std::vector<float>& a, const std::vector<float>& b) {
    return reinterpret_cast<std::uintptr_t>(b.data()) - reinterpret_cast<std::uintptr_t>(a.data());
  };
  for (const std::size_t n : {20'000u, 99'999u, 1'000'000u, 9'999'999u}) {
    std::vector<float> first(n), between(100), second(n);
    first = {};
    first.shrink_to_fit();  // leaves a hole of one column
    RayBlock block;
    if (n % 3 == 0) {
      block.reserve(n);
    } else {
      block.resize(n, 1);
    }
    EXPECT_EQ(gap(block.x_mm, block.y_mm), gap(block.y_mm, block.z_mm)) << n;
    EXPECT_EQ(gap(block.kx, block.ky), gap(block.ky, block.kz)) << n;
    block.resize(n, 1);
    EXPECT_EQ(block.z_mm, std::vector<float>(n));
  }
}

TEST(RayBlock, MixedColumnsAndMissingRaysAreOurBug) {
  RayBlock a = random_block(2, 1, 1);
  const RayBlock b = random_block(2, 0, 2);
  EXPECT_THROW(a.append(b), std::logic_error);
  EXPECT_THROW(a.append(a, 2), std::logic_error);
}

TEST(RayBlock, SetAndGetAgreeToFloat) {
  RayBlock a = random_block(3, 0, 1);
  const Ray ray{{1.0, -2.0, 3.5}, Direction::from({1, 2, 3})};
  a.set(1, ray);
  EXPECT_EQ(a.origin_mm(1), ray.origin_mm);
  EXPECT_LT(length(a.direction(1).vec() - ray.direction.vec()), 1e-7);
  EXPECT_NEAR(length(a.direction(1)), 1.0, 1e-15);
}

}  // namespace
}  // namespace lucerna
