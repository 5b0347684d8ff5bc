// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_directions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/random.h"

namespace lucerna {
namespace {

/// Directions of density ~ cos^n about +z; n < 0 = isotropic.
std::vector<DirectionSample> lobe(std::size_t n, double exponent, std::uint64_t seed) {
  std::vector<DirectionSample> samples(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(seed, i);
    const double u = rng.uniform(), c = exponent < 0.0 ? 2.0 * u - 1.0 : std::pow(u, 1.0 / (exponent + 1.0));
    const double phi = 2.0 * std::numbers::pi * rng.uniform(), s = std::sqrt(1.0 - c * c);
    samples[i] = {direction_code(Direction::from({s * std::cos(phi), s * std::sin(phi), c})), 1.0f};
  }
  std::sort(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.code < b.code; });
  return samples;
}

void expect_cover(const std::vector<DirectionLeaf>& leaves, double weight) {
  std::uint32_t next = 0;
  double sum = 0.0;
  for (const DirectionLeaf& leaf : leaves) {
    EXPECT_EQ(leaf.code, next);
    next += direction_span(leaf.depth);
    sum += leaf.weight;
  }
  EXPECT_EQ(next, kDirectionCodes);
  EXPECT_NEAR(sum, weight, 1e-9 * weight);
}

double gain_of(const std::vector<DirectionLeaf>& leaves, double penalty) {
  // Likelihood over the octants, from the leaves alone.
  std::array<double, 8> octants{};
  for (const DirectionLeaf& leaf : leaves) octants[leaf.code / direction_span(0)] += leaf.weight;
  double gain = -penalty * (static_cast<double>(leaves.size()) - 8.0) / 3.0;
  for (const DirectionLeaf& leaf : leaves) {
    if (leaf.weight == 0.0) continue;
    const double share =
        direction_triangle(leaf.code, leaf.depth).solid_angle_sr() / (0.5 * std::numbers::pi);
    gain += leaf.weight * std::log(leaf.weight / (octants[leaf.code / direction_span(0)] * share));
  }
  return gain;
}

TEST(DirectionTree, LeavesCoverTheSphereAndGainsAddUp) {
  for (const double exponent : {-1.0, 1.0, 30.0, 3000.0}) {
    const auto samples = lobe(20'000, exponent, 1);
    for (const double penalty : {3.0, 10.0, 100.0}) {
      const auto leaves = direction_tree(samples, penalty);
      expect_cover(leaves, 20'000.0);
      const double gain = direction_gain_nats(samples, penalty);
      // Shares below level 6 are rounded to a quarter.
      EXPECT_NEAR(gain, gain_of(leaves, penalty), 1e-3 * (gain + 1.0)) << exponent << " " << penalty;
    }
  }
}

TEST(DirectionTree, NoDirectionsAreEightEmptyOctants) {
  const auto leaves = direction_tree({}, 6.0);
  EXPECT_EQ(leaves.size(), 8u);
  expect_cover(leaves, 0.0);
}

TEST(DirectionTreeStatistical, NoiseIsNotSplitAndStructureIs) {
  // Three degrees of freedom a split: exp(-6) of 8 octants and their children make a false split rare.
  EXPECT_LE(direction_tree(lobe(10'000, -1.0, 2), 12.0).size(), 8u + 3u);
  EXPECT_EQ(direction_gain_nats(lobe(10'000, -1.0, 3), 25.0), 0.0);
  EXPECT_GT(direction_tree(lobe(10'000, 30.0, 2), 12.0).size(), 30u);
}

TEST(DirectionTree, OneDirectionEndsInOneFinestTriangle) {
  const std::vector<DirectionSample> samples(100, {direction_code(Direction::from({1, 2, 3})), 1.0f});
  const auto leaves = direction_tree(samples, 6.0);
  expect_cover(leaves, 100.0);
  const auto heaviest = std::max_element(leaves.begin(), leaves.end(),
                                         [](const auto& a, const auto& b) { return a.weight < b.weight; });
  EXPECT_EQ(heaviest->depth, kDirectionDepth);
  EXPECT_EQ(heaviest->weight, 100.0);
}

}  // namespace
}  // namespace lucerna
