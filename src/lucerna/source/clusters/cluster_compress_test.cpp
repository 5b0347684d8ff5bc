// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_compress.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source/emitters/warp.h"
#include "tests/support/random_direction.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

RaySet seeded_rays(EmitterKind kind, std::size_t n, std::uint64_t seed,
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

RayBlock drawn_from(const SourceModel& model, std::size_t n) {
  return draw_rays(model, Sequence(SequenceKind::random, 99), n);
}

TEST(CompressClusters, SameSeedSameBytesForAnyNumberOfThreads) {
  const RaySet rays = seeded_rays(EmitterKind::led, 150'000, 1);
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
  RaySet rays = seeded_rays(EmitterKind::disk, 30'000, 2, BoundingSurface::sphere(4.0));
  rays.header.set_flux(337.0);
  for (std::size_t i = 0; i < rays.rays.size(); ++i) rays.rays.weight[i] = static_cast<float>(i % 3);
  const auto model = compress_clusters(rays);
  EXPECT_NEAR(model->flux() / 337.0, 1.0, 1e-12);
  EXPECT_EQ(model->training_rays(), 20'000u);
  const RayBlock out = drawn_from(*model, 1000);
  for (const float w : out.weight) EXPECT_EQ(w, 1.0f);
  ClusterOptions options;
  options.flux = 12.5;
  EXPECT_EQ(compress_clusters(rays, options)->flux(), 12.5);
}

/// Lambertian rays from the eight faces of |x| + |y| + |z| = 3, |x + y + z| = 3 the brightest: every start is
/// exactly coplanar with thousands of others.
RaySet octahedron_rays(std::size_t n, std::uint64_t seed) {
  RaySet set;
  set.header.set_flux(10.0);
  set.rays.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(seed, i);
    double a = rng.uniform(), b = rng.uniform();
    if (a + b > 1.0) {
      a = 1.0 - a;
      b = 1.0 - b;
    }
    const auto sign = [&] { return rng.uniform() < 0.35 ? -1.0 : 1.0; };
    const Vec3 normal{sign(), sign(), sign()};
    const Vec3 p{3.0 * a * normal.x, 3.0 * b * normal.y, 3.0 * (1.0 - a - b) * normal.z};
    const double u = rng.uniform(), v = rng.uniform();
    const Frame face = Frame::from_z(Direction::from(normal), p);
    set.rays.set(i, {p, Direction::from(face.vector(warp::cosine_hemisphere(u, v)))});
    set.rays.weight[i] = 1.0f;
  }
  return set;
}

struct SurfaceCase {
  std::string_view name;
  std::optional<EmitterKind> kind;  // none: the octahedron
  std::optional<BoundingSurface> surface;
  MeshSurfaceKind found;

  RaySet rays(std::size_t n, std::uint64_t seed) const {
    return kind ? seeded_rays(*kind, n, seed, surface) : octahedron_rays(n, seed);
  }
  // GoogleTest looks for this name. NOLINTNEXTLINE(readability-identifier-naming)
  friend void PrintTo(const SurfaceCase& c, std::ostream* out) { *out << c.name; }
};

class CompressClustersStatistical : public testing::TestWithParam<SurfaceCase> {};

// A model of rays on their own surface shows them nearly as they are on a near plane. Rays moved by a tenth
// of that view are further off than that.
TEST_P(CompressClustersStatistical, SurfacesGiveBackTheirRays) {
  constexpr std::size_t kRays = 60'000;
  const RaySet rays = GetParam().rays(kRays, 3);
  const auto model = compress_clusters(rays);
  const MeshSurface& surface = model->data().surface;
  EXPECT_EQ(surface.kind, GetParam().found) << to_string(surface.kind);
  const RayBlock truth = GetParam().rays(kRays, 4).rays, out = drawn_from(*model, kRays);
  const RaySetComparison r = compare_ray_sets(truth, out, &rays.rays);
  const auto bound = [](const ViewDifference& near) { return 0.13 + 4.0 * near.standard_error; };
  EXPECT_LT(r.near.excess, bound(r.near));
  for (std::size_t i = 0; i < out.size(); i += 97) {
    EXPECT_LT(length(surface.put_back(out.origin_mm(i)) - out.origin_mm(i)), 1e-5)
        << "starts off the surface";
  }
  RayBlock moved = out;
  const Views views(truth);
  const ViewWindow& window = views.window(ViewKind::near);
  const auto step = static_cast<float>(0.1 * (window.high[0] - window.low[0]));
  for (float& x : moved.x_mm) x += step;
  const RaySetComparison wrong = compare_ray_sets(truth, moved, &rays.rays);
  EXPECT_GT(wrong.near.excess, bound(wrong.near));
}

INSTANTIATE_TEST_SUITE_P(
    Surfaces, CompressClustersStatistical,
    testing::Values(
        SurfaceCase{"plane", EmitterKind::disk, BoundingSurface::plane(0.0), MeshSurfaceKind::plane},
        SurfaceCase{"sphere", EmitterKind::cosine, {}, MeshSurfaceKind::sphere},
        SurfaceCase{"cylinder", EmitterKind::cylinder, {}, MeshSurfaceKind::cylinder},
        SurfaceCase{"box", EmitterKind::filament, BoundingSurface::box({12, 4, 4}), MeshSurfaceKind::box},
        SurfaceCase{"half_a_box", EmitterKind::rectangle, BoundingSurface::box({2, 2, 2}),
                    MeshSurfaceKind::hull},
        SurfaceCase{"octahedron", {}, {}, MeshSurfaceKind::hull}),
    [](const auto& p) { return std::string(p.param.name); });

TEST(CompressClusters, ALargestSizeIsKeptAndItsRoomUsed) {
  const RaySet rays = seeded_rays(EmitterKind::filament, 60'000, 7);
  const auto run = [&](std::optional<std::uint64_t> largest, ClusterStatistics& s) {
    ClusterOptions options;
    options.max_bytes = largest;
    return encode_nfl(compress_clusters(rays, options, no_progress(), &s)->to_nfl());
  };
  ClusterStatistics plain, s;
  const std::string file = run({}, plain);
  EXPECT_EQ(file.size(), plain.bytes);
  EXPECT_EQ(file, run(plain.bytes, s)) << "a ceiling that is not reached changes nothing";
  EXPECT_EQ(run(4'000, s).size(), s.bytes);
  EXPECT_LE(s.bytes, 4'000u);
  EXPECT_GT(s.bytes, 3'400u) << "room is used";
  EXPECT_GT(s.penalty_nats, plain.penalty_nats);
}

TEST(CompressClusters, ASizeToUseUpRefinesToo) {
  const RaySet rays = seeded_rays(EmitterKind::led, 30'000, 7);
  ClusterStatistics plain, coarse, fine;
  ClusterOptions options;
  const auto model = compress_clusters(rays, options, no_progress(), &plain);
  options.target_bytes = plain.bytes * 3 / 4;
  compress_clusters(rays, options, no_progress(), &coarse);
  options.target_bytes = 6 * plain.bytes;
  const auto large = compress_clusters(rays, options, no_progress(), &fine);
  EXPECT_LE(coarse.bytes, plain.bytes * 3 / 4);
  EXPECT_GT(coarse.bytes, plain.bytes * 3 / 5);
  EXPECT_LE(fine.bytes, 6 * plain.bytes);
  EXPECT_GT(fine.bytes, 5 * plain.bytes);
  EXPECT_LT(fine.penalty_nats, plain.penalty_nats);
  EXPECT_GT(fine.clusters, plain.clusters);
  // More than there is to tell: every ray a triangle of its own, and no error.
  options.target_bytes = 1'000'000'000;
  compress_clusters(seeded_rays(EmitterKind::led, 3'000, 7), options, no_progress(), &fine);
  EXPECT_LT(fine.bytes, 300'000u);
  options.max_bytes = 5000;
  EXPECT_THROW(compress_clusters(rays, options), UsageError);
}

TEST(CompressClusters, AMostNumberOfClustersIsKept) {
  const RaySet rays = seeded_rays(EmitterKind::phong500, 60'000, 7);
  ClusterStatistics plain, few;
  ClusterOptions options;
  compress_clusters(rays, options, no_progress(), &plain);
  options.max_clusters = 100;
  const auto model = compress_clusters(rays, options, no_progress(), &few);
  EXPECT_GT(plain.clusters, 200u);
  EXPECT_LE(model->triangles(), 200u);
  EXPECT_GE(few.clusters, options.min_clusters);
  EXPECT_GT(few.cluster_price, plain.cluster_price);
  options.max_clusters = options.min_clusters - 1;
  EXPECT_THROW(compress_clusters(rays, options), UsageError);
}

/// Rays of an isotropic source, all from points that `start` gives.
template <class Start>
RaySet rays_from(std::size_t n, const Start& start) {
  RaySet set;
  set.header.set_flux(10.0);
  set.rays.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(11, i);
    const Direction direction = test::random_direction(rng);
    set.rays.set(i, {start(rng), direction});
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
  const RayBlock out = drawn_from(*line, 20'000);
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
    EXPECT_EQ(drawn_from(*few, 100).size(), 100u);
  }
}

TEST(CompressClusters, GapsBetweenEmittersAreNearlyDark) {
  // Two squares in a plane, 3 mm apart.
  const auto model = compress_clusters(rays_from(100'000, [](Rng& rng) {
    return Vec3{(rng.uniform() < 0.5 ? -2.5 : 1.5) + rng.uniform(), rng.uniform(), 0.0};
  }));
  const RayBlock out = drawn_from(*model, 100'000);
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

// docs/theory/clusters.md has the numbers of the code.
TEST(CompressClusters, TheDefaultsAreThoseOfTheirPage) {
  const ClusterOptions o;
  std::string page = test::slurp(test::source_dir() / "docs/theory/clusters.md");
  std::replace(page.begin(), page.end(), '\n', ' ');
  const auto blanks = [](char a, char b) { return a == ' ' && b == ' '; };
  page.erase(std::unique(page.begin(), page.end(), blanks), page.end());
  const auto expect = [&](const std::string& words) { EXPECT_TRUE(test::has(page, words)) << words; };
  expect(fmt::format("| price of a cluster, splits | {:g} |", o.cluster_price));
  expect(fmt::format("below {:g} splits of {:g} nats", o.cluster_price, o.penalty_nats));
  expect(fmt::format("a split must gain {:g} nats", o.penalty_nats));
  expect(
      fmt::format("| leaves of the octree, at most | {},{:03} |", o.max_leaves / 1000, o.max_leaves % 1000));
  expect(fmt::format("leaves of at most {} rays", o.min_rays_per_leaf));
  expect(fmt::format("on {} M (2^{}) of the rays", o.removal_rays >> 20, std::countr_zero(o.removal_rays)));
  expect(fmt::format("| rays of the removal | {} M |", o.removal_rays >> 20));
  expect(fmt::format("| clusters that always stay | {} |", o.min_clusters));
  expect(fmt::format("| step of stored weights | 2^(1/{}) |", 16 / o.level_step));
}

struct Stopper final : Progress {
  void update(std::string_view, std::uint64_t, std::uint64_t) override { ++steps; }
  bool stop_requested() const override { return steps > 2; }
  int steps = 0;
};

TEST(CompressClusters, StopsWhenAsked) {
  Stopper stopper;
  EXPECT_THROW(compress_clusters(seeded_rays(EmitterKind::led, 20'000, 1), {}, stopper), Interrupted);
}

}  // namespace
}  // namespace lucerna
