// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/mixture/layer_split.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"

namespace lucerna {
namespace {

/// A die, and a share of the light from a tube about it.
RayBlock die_in_a_tube(std::size_t n, double share) {
  EmitterOptions die, wall;
  die.kind = EmitterKind::rectangle;
  wall.kind = EmitterKind::cylinder;
  wall.radius_mm = 1.5;
  wall.length_mm = 2.0;
  RayBlock rays = draw_rays(*make_emitter(die), Sequence(SequenceKind::random, 3), n);
  const RayBlock stray = draw_rays(*make_emitter(wall), Sequence(SequenceKind::random, 4), n);
  for (std::size_t i = 0; i < n; ++i) {
    if (Rng(5, i).uniform() < share) rays.set(i, stray.ray(i));
  }
  return rays;
}

std::optional<LayerSplit> split_of(const RayBlock& rays) {
  SearchResult first = search_support(rays, {}, 1, no_progress());
  polish(first, rays, 1, no_progress());
  return split_layers(rays, first, {}, 2, no_progress());
}

TEST(LayerSplit, OneSupportIsEnoughForOneDie) {
  EXPECT_FALSE(split_of(die_in_a_tube(20000, 0.0)).has_value());
}

TEST(LayerSplitSlow, ADieAndItsTubeAreToldApart) {
  const RayBlock rays = die_in_a_tube(60000, 0.1);
  const auto split = split_of(rays);
  ASSERT_TRUE(split.has_value());
  EXPECT_GT(split->gain_nats(), 4.0 * split->gain_error());
  const std::vector<float> part = split->second_responsibilities(rays);
  // Which of the two was found first is chance; every ray's own layer is what counts.
  double of_die = 0.0, of_wall = 0.0, dies = 0.0, walls = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_GE(part[i], 0.0f);
    ASSERT_LE(part[i], 1.0f);
    const bool wall = std::abs(std::hypot(rays.x_mm[i], rays.y_mm[i]) - 1.5f) < 1e-3f;
    (wall ? of_wall : of_die) += static_cast<double>(part[i]);
    (wall ? walls : dies) += 1.0;
  }
  // Much of the wall's light has lines that the die's has too: a perfect classifier could not part them all.
  // A split that knows nothing has 0 here.
  EXPECT_GT(std::abs(of_wall / walls - of_die / dies), 0.35);
}

}  // namespace
}  // namespace lucerna
