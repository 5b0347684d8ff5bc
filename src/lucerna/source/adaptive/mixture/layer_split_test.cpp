// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/mixture/layer_split.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source/emitters/warp.h"

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

/// A filament along x, and an eighth of its light as from its image in a mirror at z = 1.3 mm.
RayBlock filament_and_image(std::size_t n) {
  RayBlock rays;
  rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(7, i);
    const double phi = 2.0 * std::numbers::pi * rng.uniform(), along = 6.0 * (rng.uniform() - 0.5);
    const Vec3 out{0.0, std::cos(phi), std::sin(phi)};
    const double u = rng.uniform(), v = rng.uniform();
    Vec3 p = 0.3 * out + Vec3{along, 0, 0};
    Direction d = warp::about(Direction::from_unit(out), warp::cosine_hemisphere(u, v));
    if (rng.uniform() < 0.125) {
      p.z = 2.6 - p.z;
      d = Direction::from({d.x(), d.y(), -d.z()});
    }
    rays.set(i, {p, d});
    rays.weight[i] = 1.0F;
  }
  return rays;
}

// What the first support leaves over looks as if it came from between the two. Searched for anew, the second
// is where its light starts.
TEST(LayerSplitSlow, TheImageOfAFilamentIsWhereItIs) {
  const RayBlock rays = filament_and_image(60'000);
  const auto split = split_of(rays);
  ASSERT_TRUE(split.has_value());
  const auto z_of_axis = [](const BoundedSupport& on) {
    EXPECT_TRUE(on.support.kind == SupportKind::axis || on.support.kind == SupportKind::cylinder)
        << to_string(on.support.kind);
    EXPECT_GT(std::abs(on.support.world_from_support.ez().x), 0.99);
    return on.support.world_from_support.origin_mm().z;
  };
  EXPECT_NEAR(z_of_axis(split->first()), 0.0, 0.1);
  EXPECT_NEAR(z_of_axis(split->second()), 2.6, 0.15);
}

}  // namespace
}  // namespace lucerna
