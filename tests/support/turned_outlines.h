// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "lucerna/geometry.h"
#include "lucerna/optics/shapes/outline.h"
#include "lucerna/random.h"

namespace lucerna::test {

using OutlineCorners = std::vector<OutlinePoint>;

/// A collimator's outline with a pocket, a ball and a ring that does not touch the axis.
inline std::vector<OutlineCorners> turned_outlines() {
  OutlineCorners ball, ring;
  for (int i = 0; i <= 60; ++i) {
    const double a = std::numbers::pi * (i / 60.0 - 0.5);
    ball.push_back({i == 0 || i == 60 ? 0.0 : 10.0 * std::cos(a), 10.0 * std::sin(a)});
    if (i < 60) ring.push_back({12.0 + 3.0 * std::cos(2.0 * a), 3.0 * std::sin(2.0 * a)});
  }
  return {{{0, 4}, {2, 4}, {2, 0.1}, {3, 0.1}, {6, 4}, {9, 9}, {11, 14}, {11, 15}, {0, 15}}, ball, ring};
}

/// From within a cube of half side `reach` about the origin, anywhere.
inline Ray ray_across(Rng& rng, double reach) {
  const auto one = [&] { return 2.0 * rng.uniform() - 1.0; };
  return {{reach * one(), reach * one(), reach * one()}, Direction::from({one(), one(), one()})};
}

}  // namespace lucerna::test
