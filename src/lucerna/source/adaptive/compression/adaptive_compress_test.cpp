// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/compression/adaptive_compress.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/files/thinned_ray_set.h"
#include "lucerna/rayset/statistics/surface_guess.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

RaySet drawn(EmitterKind kind, std::size_t n, std::uint64_t seed = 3) {
  EmitterOptions options;
  options.kind = kind;
  const auto emitter = make_emitter(options);
  RaySet set;
  set.rays = draw_rays(*emitter, Sequence(SequenceKind::random, seed), n);
  set.header.set_flux(emitter->flux());
  return set;
}

RayBlock from_model(const AdaptiveModel& model, std::size_t n) {
  return draw_rays(model, Sequence(SequenceKind::random, 77), n);
}

TEST(AdaptiveCompress, RefusesWhatIsNoLight) {
  RaySet none;
  none.header.set_flux(1.0);
  EXPECT_THROW(compress_adaptive(none, {}), InputError);
  RaySet dark = drawn(EmitterKind::disk, 100);
  dark.rays.weight.assign(100, 0.0f);
  EXPECT_THROW(compress_adaptive(dark, {}), InputError);
  RaySet unstated = drawn(EmitterKind::disk, 100);
  unstated.header = {};
  EXPECT_THROW(compress_adaptive(unstated, {}), InputError);
  EXPECT_EQ(compress_adaptive(unstated, {.flux = 5.0})->flux(), 5.0);
}

TEST(AdaptiveCompress, TheRectangleIsFoundAndNearlyExact) {
  const RaySet rays = drawn(EmitterKind::rectangle, 10000);
  const auto model = compress_adaptive(rays, {});
  EXPECT_EQ(model->data().layers.front().support.kind, SupportKind::plane);
  EXPECT_NEAR(model->flux(), 1000.0, 1e-9);
  EXPECT_LT(encode_nfl(model->to_nfl()).size(), 1500u);
  const RayBlock drawn_rays = from_model(*model, 50000);
  std::size_t outside = 0;
  for (std::size_t i = 0; i < drawn_rays.size(); ++i) {
    const Vec3 p = drawn_rays.origin_mm(i);
    EXPECT_NEAR(p.z, 0.0, 1e-6);
    outside += std::max(std::abs(p.x), std::abs(p.y)) > 0.5001 ? 1 : 0;
  }
  EXPECT_LT(static_cast<double>(outside), 0.003 * static_cast<double>(drawn_rays.size()));
}

TEST(AdaptiveCompressSlow, EveryFileHasRoomForItsModel) {
  const RaySet rays = drawn(EmitterKind::filament, 20000);
  const auto free = compress_adaptive(rays, {});
  for (const std::uint64_t max : {4000u, 1500u, 1000u}) {
    const auto model = compress_adaptive(rays, {.max_bytes = max});
    EXPECT_LE(encode_nfl(model->to_nfl()).size(), max);
    EXPECT_LE(model->leaves(), free->leaves());
  }
  EXPECT_THROW(compress_adaptive(rays, {.max_bytes = 50}), InputError);
}

TEST(AdaptiveCompress, SameBitsForAnyNumberOfThreads) {
  const RaySet rays = drawn(EmitterKind::disk, 8000);
  const auto many = compress_adaptive(rays, {});
  const ThreadLimit one(1);
  EXPECT_EQ(encode_nfl(compress_adaptive(rays, {})->to_nfl()), encode_nfl(many->to_nfl()));
}

TEST(AdaptiveCompress, FewRaysAreEnoughForAModel) {
  for (const std::size_t n : {1u, 2u, 3u, 10u, 100u}) {
    const auto model = compress_adaptive(drawn(EmitterKind::led, n), {});
    const RayBlock rays = from_model(*model, 100);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      EXPECT_TRUE(is_finite(rays.origin_mm(i)));
      EXPECT_NEAR(length(Vec3{rays.kx[i], rays.ky[i], rays.kz[i]}), 1.0, 1e-6);
    }
  }
}

/// Rays through one point, on a sphere about it; on a segment; parallel.
RaySet special(int which, std::size_t n) {
  RaySet set = drawn(EmitterKind::point, n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(4, i);
    const Ray r = set.rays.ray(i);
    if (which == 0) set.rays.set(i, {r.at(5.0), r.direction});
    if (which == 1) set.rays.set(i, {{6.0 * rng.uniform(), 0, 1.0}, r.direction});
    if (which == 2) set.rays.set(i, {{rng.uniform(), rng.uniform(), 0.0}, Direction::from({0.2, 0.1, 1.0})});
  }
  return set;
}

TEST(AdaptiveCompress, FilesOfMoreRaysThanAreWantedAreThinnedOutEvenly) {
  const test::TempDir folder;
  const auto path = folder.path() / "rays.tm25ray";
  // The first half of the file is a disk, the other another one, 5 mm beside it.
  RaySet rays = drawn(EmitterKind::disk, 40'000);
  for (std::size_t i = 20'000; i < 40'000; ++i) rays.rays.x_mm[i] += 5.0f;
  write_ray_set(path, rays, "tm25");
  const auto right = [](const RayBlock& block) {
    std::size_t n = 0;
    for (const float x : block.x_mm) n += x > 2.5f ? 1 : 0;
    return static_cast<double>(n) / static_cast<double>(block.size());
  };
  const auto model = compress_adaptive(
      thinned_ray_set({path}, {.max_rays = 10'000, .only_wavelengths = true}, no_progress()).set, {});
  EXPECT_EQ(model->training_rays(), 10'000u);
  EXPECT_DOUBLE_EQ(model->flux(), *rays.header.flux());
  EXPECT_NEAR(right(from_model(*model, 100'000)), 0.5, 0.01);
}

TEST(AdaptiveCompress, PointsLinesAndParallelRaysStayThat) {
  for (const int which : {0, 1, 2}) {
    const auto model = compress_adaptive(special(which, 5000), {});
    EXPECT_FALSE(model->has_etendue()) << which;
    EXPECT_THROW(model->pdf_etendue({{}, Direction()}), InputError);
    const RayBlock rays = from_model(*model, 2000);
    double worst = 0.0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray r = rays.ray(i);
      const double past_end = std::max(-r.origin_mm.x, r.origin_mm.x - 6.0);
      if (which == 0) worst = std::max(worst, length(cross(r.origin_mm, r.direction.vec())));
      if (which == 0) worst = std::max(worst, std::abs(length(r.origin_mm) - 5.0));
      if (which == 1) worst = std::max({worst, std::hypot(r.origin_mm.y, r.origin_mm.z - 1.0), past_end});
      if (which == 2) worst = std::max(worst, angle_between(r.direction, Direction::from({0.2, 0.1, 1.0})));
    }
    EXPECT_LT(worst, 1e-3) << which << " " << describe(guess_surface(special(which, 5000).rays)) << " on "
                           << to_string(model->data().layers.front().support.kind) << " surface "
                           << to_string(model->data().surface.kind);
  }
}

TEST(AdaptiveCompress, UnequalWeightsAreFlux) {
  RaySet rays = drawn(EmitterKind::rectangle, 20000);
  // Half of the rays, one tenth of the flux, on the left.
  for (std::size_t i = 0; i < rays.rays.size(); ++i)
    rays.rays.weight[i] = rays.rays.x_mm[i] < 0.0f ? 1.0f : 9.0f;
  const RayBlock drawn_rays = from_model(*compress_adaptive(rays, {}), 50000);
  std::size_t left = 0;
  for (const float x : drawn_rays.x_mm) left += x < 0.0f ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(left) / static_cast<double>(drawn_rays.size()), 0.1, 0.01);
}

TEST(AdaptiveCompressSlow, AModelIsNearerToTheTruthThanItsRays) {
  const RaySet rays = drawn(EmitterKind::led, 100000);
  const RayBlock truth = drawn(EmitterKind::led, 2000000, 5).rays;
  const auto model = compress_adaptive(rays, {});
  const RaySetComparison c = compare_ray_sets(truth, from_model(*model, 2000000), &rays.rays);
  for (const ViewKind v : kViewKinds) EXPECT_LT(c[v].excess, 0.6 * c[v].raw) << to_string(v);
  EXPECT_LT(encode_nfl(model->to_nfl()).size(), 20000u);
}

TEST(AdaptiveCompressSlow, TurningAndMovingChangesNothingElse) {
  const RaySet upright = drawn(EmitterKind::led, 100000);
  const Frame placed = Frame::from_axis(Direction::from({1, 2, -0.5}), 0.4, {30, -20, 10});
  RaySet turned = upright;
  RayBlock truth = drawn(EmitterKind::led, 1000000, 5).rays, turned_truth = truth;
  for (std::size_t i = 0; i < turned.rays.size(); ++i) turned.rays.set(i, placed.ray(upright.rays.ray(i)));
  for (std::size_t i = 0; i < truth.size(); ++i) turned_truth.set(i, placed.ray(truth.ray(i)));
  const auto a = compare_ray_sets(truth, from_model(*compress_adaptive(upright, {}), 1000000), &upright.rays);
  const auto b =
      compare_ray_sets(turned_truth, from_model(*compress_adaptive(turned, {}), 1000000), &turned.rays);
  for (const ViewKind v : kViewKinds) {
    EXPECT_LT(b[v].excess, 0.6 * b[v].raw) << to_string(v);
    // Views of few cells (near) know an excess of a million rays no better than to their standard error.
    const double noise = 3.0 * std::max(a[v].standard_error, b[v].standard_error);
    EXPECT_NEAR(a[v].excess, b[v].excess, std::max(0.25 * a[v].raw, noise)) << to_string(v);
  }
}

TEST(AdaptiveCompressSlow, TheExactDisk) {
  const RaySet rays = drawn(EmitterKind::disk, 100000);
  const auto model = compress_adaptive(rays, {});
  const RayBlock out = from_model(*model, 1000000);
  std::size_t outside = 0, grazing = 0;
  std::vector<double> radiance;
  for (std::size_t i = 0; i < out.size(); ++i) {
    outside += std::hypot(out.x_mm[i], out.y_mm[i]) > 1.0f ? 1 : 0;
    grazing += std::hypot(out.kx[i], out.ky[i]) > 0.99f ? 1 : 0;
    if (i % 10 == 0) radiance.push_back(model->pdf_etendue(out.ray(i)));
  }
  const double n = static_cast<double>(out.size());
  EXPECT_LT(static_cast<double>(outside) / n, 0.003);
  EXPECT_NEAR(static_cast<double>(grazing) / n, 0.0199, 0.00199);
  // Étendue that the brightest half of the flux fills: the mean of 1 / radiance over that half of the rays.
  std::sort(radiance.begin(), radiance.end(), std::greater<>());
  double etendue = 0.0;
  for (std::size_t i = 0; i < radiance.size() / 2; ++i) etendue += 1.0 / radiance[i];
  etendue /= static_cast<double>(radiance.size());
  const double exact = 0.5 * std::numbers::pi * std::numbers::pi;
  EXPECT_NEAR(etendue, exact, 0.05 * exact);
}

}  // namespace
}  // namespace lucerna
