// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/cluster_compress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"
#include "lucerna/rayset/compare.h"
#include "lucerna/source/draw_rays.h"
#include "lucerna/source/emitter.h"

namespace lucerna {
namespace {

RaySet emitter_rays(EmitterKind kind, std::size_t n, std::uint64_t seed,
                    std::optional<BoundingSurface> surface = {}) {
  EmitterOptions options;
  options.kind = kind;
  options.surface = surface;
  const auto source = make_emitter(options);
  RaySet set;
  set.header.set_flux(source->flux());
  set.rays = draw_rays(*source, Sequence(SequenceKind::random, seed), n);
  return set;
}

RayBlock drawn(const SourceModel& model, std::size_t n) {
  return draw_rays(model, Sequence(SequenceKind::random, 99), n);
}

TEST(CompressClusters, SameSeedSameBytesForAnyNumberOfThreads) {
  const RaySet rays = emitter_rays(EmitterKind::led, 150'000, 1);
  const auto run = [&](int threads, std::uint64_t seed) {
    const ThreadLimit limit(threads);
    ClusterOptions options;
    options.seed = seed;
    options.removal_rays = 50'000;
    return encode_nfl(compress_clusters(rays, options)->to_nfl());
  };
  const std::string one = run(1, 7);
  EXPECT_EQ(one, run(2, 7));
  EXPECT_NE(one, run(2, 8));
}

TEST(CompressClusters, FluxIsExactWhateverTheWeights) {
  RaySet rays = emitter_rays(EmitterKind::disk, 30'000, 2, BoundingSurface::sphere(4.0));
  rays.header.set_flux(337.0);
  for (std::size_t i = 0; i < rays.rays.size(); ++i) rays.rays.weight[i] = static_cast<float>(i % 3);
  const auto model = compress_clusters(rays);
  EXPECT_NEAR(model->flux() / 337.0, 1.0, 1e-12);
  EXPECT_EQ(model->training_rays(), 20'000u);
  const RayBlock out = drawn(*model, 1000);
  for (const float w : out.weight) EXPECT_EQ(w, 1.0f);
  ClusterOptions options;
  options.flux = 12.5;
  EXPECT_EQ(compress_clusters(rays, options)->flux(), 12.5);
}

// A model of rays on their own surface shows them nearly as they are where directions change slowly over a
// cluster.
TEST(CompressClustersStatistical, SurfacesGiveBackTheirRays) {
  struct Case {
    EmitterKind kind;
    std::optional<BoundingSurface> surface;
    MeshSurfaceKind found;
  };
  const std::vector<Case> cases{
      {EmitterKind::disk, BoundingSurface::plane(0.0), MeshSurfaceKind::plane},
      {EmitterKind::cosine, {}, MeshSurfaceKind::sphere},
      {EmitterKind::cylinder, {}, MeshSurfaceKind::cylinder},
      {EmitterKind::rectangle, BoundingSurface::box({2, 2, 2}), MeshSurfaceKind::hull}};
  for (const Case& c : cases) {
    const RaySet rays = emitter_rays(c.kind, 100'000, 3, c.surface);
    const auto model = compress_clusters(rays);
    EXPECT_EQ(model->data().surface.kind, c.found);
    const RayBlock truth = emitter_rays(c.kind, 100'000, 4, c.surface).rays, out = drawn(*model, 100'000);
    const RaySetComparison r = compare_ray_sets(truth, out, &rays.rays);
    EXPECT_LT(r.near.excess, 0.12 + 4.0 * r.near.standard_error) << to_string(c.found);
    // Every start is on the surface.
    for (std::size_t i = 0; i < out.size(); i += 97) {
      EXPECT_LT(length(model->data().surface.put_back(out.origin_mm(i)) - out.origin_mm(i)), 1e-5);
    }
  }
}

TEST(CompressClusters, MaxBytesIsKept) {
  const RaySet rays = emitter_rays(EmitterKind::filament, 200'000, 7);
  for (const std::uint64_t size : {4'000ull, 20'000ull, 60'000ull}) {
    ClusterOptions options;
    options.max_bytes = size;
    ClusterStatistics s;
    const auto model = compress_clusters(rays, options, no_progress(), &s);
    EXPECT_LE(s.bytes, size);
    EXPECT_EQ(encode_nfl(model->to_nfl()).size(), s.bytes);
    EXPECT_GT(s.bytes, size / 3) << "room is used";
  }
}

/// Rays of an isotropic source, all from points that `start` gives.
template <class Start>
RaySet rays_from(std::size_t n, const Start& start) {
  RaySet set;
  set.header.set_flux(10.0);
  set.rays.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(11, i);
    const double z = 2.0 * rng.uniform() - 1.0, phi = 2.0 * std::numbers::pi * rng.uniform(),
                 s = std::sqrt(1.0 - z * z);
    set.rays.set(i, {start(rng), Direction::from({s * std::cos(phi), s * std::sin(phi), z})});
    set.rays.weight[i] = 1.0f;
  }
  return set;
}

TEST(CompressClusters, PointsLinesAndFewRaysAreOrdinaryInput) {
  const auto point = compress_clusters(rays_from(5000, [](Rng&) { return Vec3{1, 2, 3}; }));
  EXPECT_EQ(point->clusters(), 1u);
  for (const Ray ray : {point->sample({0.1, 0.2, 0.3, 0.4, 0.5, 0.6})}) {
    EXPECT_LT(length(ray.origin_mm - Vec3{1, 2, 3}), 1e-6);
    EXPECT_NEAR(point->pdf_solid_angle(ray.origin_mm, ray.direction), 0.25 / std::numbers::pi, 0.02);
    EXPECT_THROW(point->pdf_area(ray.origin_mm), InputError);
    EXPECT_THROW(point->pdf_etendue(ray), InputError);
  }
  const auto line = compress_clusters(rays_from(5000, [](Rng& rng) {
    return Vec3{4.0 * rng.uniform(), 1, 1};
  }));
  EXPECT_EQ(line->data().surface.kind, MeshSurfaceKind::line);
  double mean = 0.0, low = 1e9, high = -1e9;
  const RayBlock out = drawn(*line, 20'000);
  for (std::size_t i = 0; i < out.size(); ++i) {
    mean += static_cast<double>(out.x_mm[i]) / 20'000;
    low = std::min(low, static_cast<double>(out.x_mm[i]));
    high = std::max(high, static_cast<double>(out.x_mm[i]));
    EXPECT_NEAR(out.y_mm[i], 1.0f, 1e-5f);
  }
  EXPECT_NEAR(mean, 2.0, 0.05);
  EXPECT_NEAR(low, 0.0, 0.05);
  EXPECT_NEAR(high, 4.0, 0.05);
  for (std::size_t n = 1; n <= 12; ++n) {
    const auto few = compress_clusters(rays_from(n, [](Rng& rng) {
      return Vec3{rng.uniform(), rng.uniform(), rng.uniform()};
    }));
    EXPECT_EQ(few->flux(), 10.0);
    EXPECT_EQ(drawn(*few, 100).size(), 100u);
  }
}

TEST(CompressClusters, GapsBetweenEmittersAreNearlyDark) {
  // Two squares in a plane, 3 mm apart.
  const auto model = compress_clusters(rays_from(100'000, [](Rng& rng) {
    return Vec3{(rng.uniform() < 0.5 ? -2.5 : 1.5) + rng.uniform(), rng.uniform(), 0.0};
  }));
  const RayBlock out = drawn(*model, 100'000);
  const auto between =
      std::count_if(out.x_mm.begin(), out.x_mm.end(), [](float x) { return x > -1.4f && x < 1.4f; });
  EXPECT_LT(static_cast<double>(between), 0.05 * 100'000);
}

TEST(CompressClusters, NothingToCompressIsAnError) {
  RaySet rays = rays_from(100, [](Rng&) { return Vec3{}; });
  rays.header.flux_lm.reset();
  EXPECT_THROW(compress_clusters(rays), InputError);
  rays.header.set_flux(1.0);
  for (float& w : rays.rays.weight) w = 0.0f;
  EXPECT_THROW(compress_clusters(rays), InputError);
  rays.rays.resize(0);
  EXPECT_THROW(compress_clusters(rays), InputError);
  ClusterOptions options;
  options.max_bytes = 10;
  EXPECT_THROW(compress_clusters(rays_from(100, [](Rng&) { return Vec3{}; }), options), UsageError);
}

struct Stopper final : Progress {
  void update(std::string_view, std::uint64_t, std::uint64_t) override { ++steps; }
  bool stop_requested() const override { return steps > 2; }
  int steps = 0;
};

TEST(CompressClusters, StopsWhenAsked) {
  Stopper stopper;
  EXPECT_THROW(compress_clusters(emitter_rays(EmitterKind::led, 20'000, 1), {}, stopper), Interrupted);
}

}  // namespace
}  // namespace lucerna
