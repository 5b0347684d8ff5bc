// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/spherical_triangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "lucerna/random.h"
#include "tests/support/random_direction.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

Direction random_direction(std::uint64_t seed, std::uint64_t i) {
  Rng rng(seed, i);
  return test::random_direction(rng);
}

bool inside(const SphericalTriangle& t, const Vec3& d, double tolerance) {
  const double sign = dot(t.a, cross(t.b, t.c)) > 0.0 ? 1.0 : -1.0;
  return sign * dot(cross(t.a, t.b), d) > -tolerance && sign * dot(cross(t.b, t.c), d) > -tolerance &&
         sign * dot(cross(t.c, t.a), d) > -tolerance;
}

TEST(SphericalTriangle, EveryLevelCoversTheSphere) {
  for (int depth = 0; depth <= 4; ++depth) {
    double sum = 0.0;
    for (std::uint32_t code = 0; code < kDirectionCodes; code += direction_span(depth)) {
      sum += direction_triangle(code, depth).solid_angle_sr();
    }
    EXPECT_NEAR(sum, 4.0 * std::numbers::pi, 1e-12) << depth;
  }
}

TEST(SphericalTriangle, CodesNameTheTriangleThatHoldsTheDirection) {
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const Direction d = random_direction(1, i);
    const std::uint32_t code = direction_code(d);
    for (int depth = 0; depth <= kDirectionDepth; ++depth) {
      EXPECT_TRUE(inside(direction_triangle(code, depth), d, 1e-14)) << i << " level " << depth;
    }
  }
  for (const Direction& axis : {Direction::from_unit({1, 0, 0}), Direction::from_unit({0, -1, 0}),
                                Direction::from_unit({0, 0, -1})}) {
    EXPECT_TRUE(inside(direction_triangle(direction_code(axis), kDirectionDepth), axis, 1e-14));
  }
}

TEST(SphericalTriangle, ChildSharesAreThoseOfTheTriangles) {
  for (int depth = 0; depth < kDirectionDepth; ++depth) {
    for (std::uint64_t i = 0; i < 50; ++i) {
      const std::uint32_t code = direction_code(random_direction(2, i)) & ~(direction_span(depth) - 1);
      const auto& shares = direction_child_shares(code, depth);
      EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1.0, 1e-12);
      for (std::uint32_t k = 0; k < 4; ++k) {
        const double share =
            direction_triangle(code + k * direction_span(depth + 1), depth + 1).solid_angle_sr() /
            direction_triangle(code, depth).solid_angle_sr();
        EXPECT_NEAR(shares[k], share, 1e-3);
      }
    }
  }
}

/// Counts of samples in the 64 descendants three levels down, with v bent by `power`.
std::vector<double> descendant_counts(std::uint32_t code, int depth, double power) {
  const SphericalTriangleSampler sampler(direction_triangle(code, depth));
  std::vector<double> counts(64, 0.0);
  for (std::uint64_t i = 0; i < 100'000; ++i) {
    Rng rng(3, i);
    const double u = rng.uniform(), v = std::pow(rng.uniform(), power);
    const std::uint32_t found = direction_code(sampler.sample(u, v));
    const std::uint32_t offset = (found - code) / direction_span(depth + 3);
    if (found >= code && offset < 64) counts[offset] += 1.0;
  }
  return counts;
}

TEST(SphericalTriangleStatistical, SamplesAreUniformAtEveryLevelAndBentOnesAreRejected) {
  for (const int depth : {0, 1, 4, 7}) {
    const std::uint32_t code =
        direction_code(Direction::from({0.3, -0.5, 0.6})) & ~(direction_span(depth) - 1);
    std::vector<double> expected(64);
    for (std::uint32_t k = 0; k < 64; ++k) {
      expected[k] = 100'000.0 *
                    direction_triangle(code + k * direction_span(depth + 3), depth + 3).solid_angle_sr() /
                    direction_triangle(code, depth).solid_angle_sr();
    }
    const auto counts = descendant_counts(code, depth, 1.0);
    EXPECT_NEAR(std::accumulate(counts.begin(), counts.end(), 0.0), 100'000.0, 5.0) << depth;
    EXPECT_GT(test::chi_square_p(counts, expected), test::kFalseAlarm) << depth;
    EXPECT_LT(test::chi_square_p(descendant_counts(code, depth, 1.1), expected), test::kFalseAlarm) << depth;
  }
}

TEST(SphericalTriangleStatistical, TheFinestTriangleIsStillSampledEvenly) {
  // Level 10 has no descendants in the code: the mean of the samples is the triangle's centroid.
  const SphericalTriangle t =
      direction_triangle(direction_code(Direction::from({0.2, 0.9, 0.4})), kDirectionDepth);
  const SphericalTriangleSampler sampler(t);
  Vec3 mean;
  constexpr int kSamples = 100'000;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    Rng rng(4, i);
    const double u = rng.uniform(), v = rng.uniform();
    const Direction d = sampler.sample(u, v);
    ASSERT_TRUE(inside(t, d, 1e-9));
    mean += d;
  }
  mean = mean / kSamples;
  const Vec3 centroid = (t.a + t.b + t.c) / 3.0;
  // A uniform triangle's points spread by edge / sqrt(18) or so; five standard errors.
  EXPECT_LT(length(mean - centroid), 5.0 * length(t.a - t.b) / std::sqrt(18.0 * kSamples));
}

}  // namespace
}  // namespace lucerna
