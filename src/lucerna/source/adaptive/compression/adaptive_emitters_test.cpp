// SPDX-License-Identifier: Apache-2.0
// What the adaptive method must show on every analytic emitter: samples that agree with the density, starts
// on the stated surface, next to no light where the source does not shine.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lucerna/ray_comparison.h"
#include "lucerna/ray_file.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "tests/support/data_dir.h"
#include "tests/support/print_parameters.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

RaySet few_drawn(EmitterKind kind, std::size_t n) {
  EmitterOptions options;
  options.kind = kind;
  const auto emitter = make_emitter(options);
  RaySet set;
  set.rays = draw_rays(*emitter, Sequence(SequenceKind::random, 3), n);
  set.header.set_flux(emitter->flux());
  return set;
}

/// Light cannot come from outside of these: the emitters themselves.
bool shines(EmitterKind kind, const Ray& ray) {
  const Vec3& d = ray.direction.vec();
  const Vec3 at = std::abs(d.z) > 1e-9 ? ray.at(-ray.origin_mm.z / d.z) : Vec3{1e9, 0, 0};
  const double tolerance = 1e-5;
  BoundingSurface body = BoundingSurface::sphere(1.0 + tolerance);
  switch (kind) {
    case EmitterKind::disk:
      return d.z > 0.0 && std::hypot(at.x, at.y) < 1.0 + tolerance;
    case EmitterKind::rectangle:
      return d.z > 0.0 && std::max(std::abs(at.x), std::abs(at.y)) < 0.5 + tolerance;
    case EmitterKind::led:
      return d.z > 0.0 && std::hypot(at.x, at.y) < 2.5 + tolerance;
    case EmitterKind::cylinder:
      body = BoundingSurface::cylinder(1.0 + tolerance, 6.0 + tolerance);
      break;
    case EmitterKind::filament:
      body = BoundingSurface::cylinder(0.66 + tolerance, 8.12 + tolerance);
      body.world_from_surface = Frame({0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {});
      break;
    case EmitterKind::sphere:
      break;
    default:
      return dot(ray.origin_mm, d) > 0.0;  // from the sphere, outwards
  }
  return body.exit_distance_mm(ray).has_value();
}

/// Counts and expectations on grids of the four numbers of a focal support: all four, and pairs of them.
class Grids {
 public:
  explicit Grids(const TreeBox& box) : box_(box) {
    for (Grid& g : grids_) {
      std::size_t cells = 1;
      for (std::size_t k = 0; k < 4; ++k) cells *= g.bins[k];
      g.sum.assign(cells + 1, 0.0);
      g.squares = g.found = g.sum;
    }
  }

  /// A sampled ray.
  void count(const std::array<double, 4>& c) {
    for (Grid& g : grids_) g.found[cell(g, c)] += 1.0;
  }
  /// A point of the integral of the density.
  void expect(const std::array<double, 4>& c, double density) {
    for (Grid& g : grids_) {
      g.sum[cell(g, c)] += density;
      g.squares[cell(g, c)] += density * density;
    }
  }
  /// The smallest p-value of the grids. The integrals' own variance counts beside that of the samples.
  double p(double rays, double points) const {
    double min = 1.0;
    const double scale = rays * box_.volume() / points;
    for (const Grid& g : grids_) {
      double chi2 = 0.0, thin_found = 0.0, thin = 0.0, thin_noise = 0.0;
      int cells = 0;
      for (std::size_t i = 0; i + 1 < g.found.size(); ++i) {
        const double e = scale * g.sum[i], noise = scale * scale * g.squares[i];
        if (e < 25.0) {
          thin_found += g.found[i], thin += e, thin_noise += noise;
          continue;
        }
        chi2 += (g.found[i] - e) * (g.found[i] - e) / (e + noise), ++cells;
      }
      if (thin > 0.0) chi2 += (thin_found - thin) * (thin_found - thin) / (thin + thin_noise), ++cells;
      EXPECT_GT(cells, 8);
      min = std::min(min, test::gamma_q(0.5 * cells, 0.5 * chi2));
    }
    return min;
  }

 private:
  struct Grid {
    std::array<std::size_t, 4> bins;
    std::vector<double> sum, squares, found;
  };
  std::size_t cell(const Grid& g, const std::array<double, 4>& c) const {
    std::size_t at = 0;
    for (std::size_t d = 0; d < 4; ++d) {
      const double t = (c[d] - box_.low[d]) / box_.width(d);
      if (!(t >= 0.0 && t < 1.0)) return g.found.size() - 1;
      at = at * g.bins[d] + static_cast<std::size_t>(t * static_cast<double>(g.bins[d]));
    }
    return at;
  }
  TreeBox box_;
  std::vector<Grid> grids_{{{4, 4, 4, 4}, {}, {}, {}},
                           {{12, 12, 1, 1}, {}, {}, {}},
                           {{1, 1, 12, 12}, {}, {}, {}},
                           {{12, 1, 12, 1}, {}, {}, {}},
                           {{1, 12, 1, 12}, {}, {}, {}}};
};

/// Agreement of samples, moved along x by `moved` of the size of the source, with the density.
double moved_agreement(const AdaptiveModel& model, const RayBlock& rays, double moved) {
  constexpr std::uint64_t kRays = 100'000, kPoints = 400'000;
  Support about;
  about.world_from_support = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, summarize(rays).virtual_focus->point_mm);
  TreeBox box{{0, 0, -1, -std::numbers::pi}, {0, 0, 1, std::numbers::pi}};
  for (std::size_t i = 0; i < rays.size(); i += 10) {
    const auto p = about.to_chart(rays.ray(i));
    for (std::size_t d = 0; d < 2; ++d) {
      box.low[d] = std::min(box.low[d], p->c[d]), box.high[d] = std::max(box.high[d], p->c[d]);
    }
  }
  Grids grids(box);
  const Sequence even(SequenceKind::random, 6), random(SequenceKind::random, 8);
  for (std::uint64_t i = 0; i < kPoints; ++i) {
    const auto u = even.point<4>(i);
    ChartPoint p;
    for (std::size_t d = 0; d < 4; ++d) p.c[d] = box.low[d] + u[d] * box.width(d);
    grids.expect(p.c, model.pdf_etendue(about.from_chart(p)));
  }
  for (std::uint64_t i = 0; i < kRays; ++i) {
    Ray ray = model.sample(random.point<4>(i));
    ray.origin_mm.x += moved * box.width(0);
    grids.count(about.to_chart(ray)->c);
  }
  return grids.p(static_cast<double>(kRays), static_cast<double>(kPoints));
}

class AdaptiveEmittersSlow : public testing::TestWithParam<EmitterKind> {};

TEST_P(AdaptiveEmittersSlow, SamplesAreWhatTheModelSays) {
  const RaySet rays = few_drawn(GetParam(), 100000);
  const auto model = compress_adaptive(rays, {});
  ASSERT_TRUE(model->has_etendue());
  EXPECT_NEAR(model->flux() / *rays.header.flux(), 1.0, 1e-6);
  const RayBlock out = draw_rays(*model, Sequence(SequenceKind::random, 77), 300000);
  std::size_t dark = 0;
  double off = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double far = 1.0 + length(out.origin_mm(i));
    off = std::max(off, std::abs(model->data().surface.outside_mm(out.origin_mm(i))) / far);
    dark += shines(GetParam(), out.ray(i)) ? 0 : 1;
    weight += static_cast<double>(out.weight[i]);
  }
  EXPECT_LT(off, 1e-5);
  EXPECT_LT(static_cast<double>(dark) / weight, 0.003);
  EXPECT_NEAR(weight / static_cast<double>(out.size()), 1.0, 1e-6);
  EXPECT_GT(moved_agreement(*model, rays.rays, 0.0), test::kFalseAlarm);
  EXPECT_LT(moved_agreement(*model, rays.rays, 0.03), test::kFalseAlarm) << "a wrong sampler passes";
}

INSTANTIATE_TEST_SUITE_P(All, AdaptiveEmittersSlow,
                         testing::Values(EmitterKind::disk, EmitterKind::rectangle, EmitterKind::cylinder,
                                         EmitterKind::sphere, EmitterKind::filament, EmitterKind::led,
                                         EmitterKind::phong500, EmitterKind::phong25, EmitterKind::cosine),
                         [](const auto& parameter) { return std::string(to_string(parameter.param)); });

TEST(AdaptiveEmittersData, HalfOfTheMeasuredLedIsBetteredByItsModel) {
  LUCERNA_DATA_FILE(path, "rayfiles/rayfile_LERTDUW_S2WP_green_100k_20161013_IES_TM25.TM25RAY");
  const RaySet all = read_ray_set(path);
  RaySet train;
  RayBlock truth;
  train.header.set_flux(1.0);
  for (RayBlock* half : {&train.rays, &truth}) half->resize(0, all.rays.extra.size());
  for (std::size_t i = 0; i < all.rays.size(); ++i) (i % 2 == 0 ? truth : train.rays).append(all.rays, i);
  train.rays.extra.clear(), truth.extra.clear();
  const auto model = compress_adaptive(train, {.max_bytes = 64000});
  EXPECT_LE(encode_nfl(model->to_nfl()).size(), 64000u);
  const RayBlock out = draw_rays(*model, Sequence(SequenceKind::random, 77), 2000000);
  const RaySetComparison c = compare_ray_sets(truth, out, &train.rays);
  // The true excess is not known better than to its standard error: it must be below raw even so.
  for (const ViewKind v : kViewKinds) EXPECT_LT(c[v].excess, c[v].raw) << to_string(v);
}

}  // namespace
}  // namespace lucerna
