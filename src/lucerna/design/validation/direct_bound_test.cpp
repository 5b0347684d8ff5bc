// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/direct_bound.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/random.h"

namespace lucerna {
namespace {

/// A small rectangle about -z: its boxes are all of one size.
ErrorBoxes small_boxes() {
  return ErrorBoxes({Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), false, -0.01, 0.01, -0.01, 0.01});
}

bool left(std::size_t box) { return box % kErrorBoxes < kErrorBoxes / 2; }

/// Two equal replicates of which the sums are per box.
template <class Flux, class Direct>
std::vector<BoxSums> light(const ErrorBoxes& boxes, const Flux& flux, const Direct& direct) {
  BoxSums r;
  r.flux.assign(boxes.size(), 0.0);
  r.direct.assign(boxes.size(), 0.0);
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) {
    r.direct[b] = direct(b);
    r.flux[b] = flux(b) + r.direct[b];
  }
  r.emitted = 1.0;
  return {r, r};
}

/// All of the target on one side, direct light on the other: with D of it and F in all the best scale leaves
/// D / sqrt(D^2 + (F - D)^2).
TEST(DirectBound, OfLightWhereNoneIsWantedIsTheKnownOne) {
  const ErrorBoxes boxes = small_boxes();
  constexpr double kHalf = ErrorBoxes::kInside / 2.0, kDirect = 0.1, kAll = 0.8;
  std::vector<double> target(boxes.size(), 0.0);
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) target[b] = left(b) ? 1.0 / kHalf : 0.0;
  const auto sums = light(
      boxes, [&](std::size_t b) { return left(b) ? (kAll - kDirect) / kHalf : 0.0; },
      [&](std::size_t b) { return left(b) ? 0.0 : kDirect / kHalf; });
  const double expected = kDirect / std::hypot(kDirect, kAll - kDirect);
  EXPECT_NEAR(direct_light_bound(boxes, target, TargetMode::shape, sums), expected, 1e-3 * expected);
  // And this light is the best there is.
  EXPECT_NEAR(box_error(boxes, target, sums, TargetMode::shape).c48.value, expected, 1e-3 * expected);
  EXPECT_NEAR(direct_light_bound(boxes, target, TargetMode::absolute, sums), kDirect, 1e-3 * kDirect);
}

TEST(DirectBound, IsNoneWhereTheTargetIsBrighter) {
  const ErrorBoxes boxes = small_boxes();
  std::vector<double> target(boxes.size(), 0.0);
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) target[b] = 1.0 / ErrorBoxes::kInside;
  const auto sums = light(
      boxes, [](std::size_t) { return 0.5 / ErrorBoxes::kInside; },
      [](std::size_t b) { return left(b) ? 0.4 / ErrorBoxes::kInside : 0.0; });
  EXPECT_LT(direct_light_bound(boxes, target, TargetMode::shape, sums), 1e-6);
  EXPECT_EQ(direct_light_bound(boxes, target, TargetMode::absolute, sums), 0.0);
}

/// No light that contains the direct light has a smaller error.
TEST(DirectBound, IsNeverAboveAnErrorThatThereIs) {
  const ErrorBoxes boxes = small_boxes();
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(seed, 0);
    std::vector<double> target(boxes.size(), 0.0);
    for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) target[b] = std::pow(rng.uniform(), 3.0);
    const double stray = rng.uniform();
    const auto sums = light(
        boxes, [&](std::size_t b) { return 1e-4 * (target[b] + 0.1 * rng.uniform()); },
        [&](std::size_t) { return 1e-4 * stray * rng.uniform(); });
    for (const TargetMode mode : {TargetMode::shape, TargetMode::absolute}) {
      EXPECT_LE(direct_light_bound(boxes, target, mode, sums),
                box_error(boxes, target, sums, mode).c48.value + 1e-9)
          << seed;
    }
  }
}

}  // namespace
}  // namespace lucerna
