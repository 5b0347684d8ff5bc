// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/kernel.h"

#include <gtest/gtest.h>
#if defined(__linux__)
#include <sys/mman.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/engines/reference_tracer.h"
#include "lucerna/trace/kernels/field_view.h"
#include "lucerna/trace/tally/flux_quanta.h"
#include "tests/support/available_kernels.h"
#include "tests/support/random_direction.h"
#include "tests/support/test_mirrors.h"

namespace lucerna {
namespace {

using test::available_kernels;
using test::random_direction;

// Rays exactly along the axis, also on cell borders, and along the grid lines.
TEST(Kernels, RaysAlongTheAxesOfTheGrid) {
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::rectangle(64.0, 64.0));
  const HeightField field(mirror, 64);
  const FieldView view = view_of(field);
  for (const Kernels* kernels : available_kernels()) {
    auto in = std::make_unique<LocalRays>();
    auto out = std::make_unique<LocalHits>();
    for (std::size_t i = 0; i < kBatch; ++i) {
      const auto along = static_cast<float>(i % 63) - 31.5F + (i % 3 == 0 ? 0.5F : 0.0F);
      const float zero = i % 2 == 0 ? 0.0F : -0.0F;
      in->x[i] = i < 256 ? along : 0.0F;
      in->y[i] = i < 256 ? 0.25F * along : along;
      in->z[i] = i < 256 ? 90.0F : 20.0F;
      in->dx[i] = i < 256 ? zero : (i % 2 == 0 ? 1.0F : -1.0F);
      in->dy[i] = zero;
      in->dz[i] = i < 256 ? -1.0F : zero;
      in->on_mirror[i] = 0;
    }
    kernels->intersect(view, *in, kBatch, *out);
    for (std::size_t i = 0; i < kBatch; ++i) {
      const double x = in->x[i], y = in->y[i];
      const double side = std::sqrt(std::max(0.0, 1200.0 - y * y));
      const bool there = i < 256 || (side <= 32.0 && y * y < 1200.0);
      ASSERT_EQ(out->state[i], there ? kFront : kMiss) << kernels->isa << ", ray " << i;
      if (there) {
        EXPECT_NEAR(out->t[i], i < 256 ? 90.0 - (x * x + y * y) / 60.0 : side, 1e-3) << i;
      }
    }
  }
}

// Rims belong to the mirror: rays exactly over them, parallel to the axis or to the rim, hit.
TEST(Kernels, RaysAlongTheBordersOfTheAperture) {
  for (const Aperture& aperture : {Aperture::rectangle(64.0, 48.0), Aperture::circle(64.0)}) {
    const bool box = aperture.shape() == ApertureShape::rectangle;
    const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, aperture);
    const HeightField field(mirror, 64);
    const FieldView view = view_of(field);
    const ReferenceTracer reference(mirror);
    for (const Kernels* kernels : available_kernels()) {
      auto in = std::make_unique<LocalRays>();
      auto out = std::make_unique<LocalHits>();
      const auto half_y = static_cast<float>(aperture.half_y_mm());
      for (std::size_t i = 0; i < kBatch; ++i) {
        const float zero = i % 2 == 0 ? 0.0F : -0.0F, side = i % 4 < 2 ? 1.0F : -1.0F;
        const float t = box ? static_cast<float>(i / 8 % 33) / 16.0F - 1.0F : 0.0F;  // corners too
        const bool level = box && i % 16 > 7;  // along the rim of x = +-32, below the corner's height
        in->x[i] = i % 8 < 4 ? side * 32.0F : t * 32.0F;
        in->y[i] = i % 8 < 4 ? t * half_y : side * half_y;
        in->z[i] = 90.0F;
        in->dx[i] = zero;
        in->dy[i] = zero;
        in->dz[i] = -1.0F;
        in->on_mirror[i] = 0;
        if (level) {
          in->x[i] = side * 32.0F;
          in->y[i] = 0.0F;
          in->z[i] = 20.0F;
          in->dy[i] = i % 2 == 0 ? 1.0F : -1.0F;
          in->dz[i] = zero;
        }
      }
      kernels->intersect(view, *in, kBatch, *out);
      for (std::size_t i = 0; i < kBatch; ++i) {
        const double x = in->x[i], y = in->y[i];
        const bool level = in->dz[i] == 0.0F;
        const double expected = level ? std::sqrt(1200.0 - 1024.0) : 90.0 - (x * x + y * y) / 60.0;
        ASSERT_EQ(out->state[i], kFront) << kernels->isa << ", ray " << i << ": " << x << ", " << y;
        EXPECT_NEAR(out->t[i], expected, 1e-3) << i;
        const auto hit =
            reference.first_hit({{x, y, in->z[i]}, Direction::from({in->dx[i], in->dy[i], in->dz[i]})});
        ASSERT_TRUE(hit && hit->front) << i << ": " << x << ", " << y;
        EXPECT_NEAR(hit->t_mm, expected, 1e-9);
      }
    }
  }
}

#if defined(__linux__)
/// A copy of numbers whose last one ends where a page that may not be read begins.
template <class T>
class Fenced {
 public:
  Fenced(const T* from, std::size_t n) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t bytes = (n * sizeof(T) + page - 1) / page * page;
    size_ = bytes + 2 * page;
    // Before it too: places off the grid may be below 0.
    start_ = static_cast<char*>(mmap(nullptr, size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (start_ == MAP_FAILED || mprotect(start_ + page, bytes, PROT_READ | PROT_WRITE) != 0) std::abort();
    data_ = reinterpret_cast<T*>(start_ + page + bytes) - n;
    std::copy_n(from, n, data_);
  }
  ~Fenced() { munmap(start_, size_); }
  Fenced(const Fenced&) = delete;
  Fenced& operator=(const Fenced&) = delete;
  const T* data() const { return data_; }

 private:
  char* start_;
  std::size_t size_;
  T* data_;
};

// Lanes that are done keep places off the grid and gather along with the others: they must stay within the
// arrays. Rays that leave by the last row, beside others that go on, did not before.
TEST(Kernels, FinishedLanesReadWithinTheArrays) {
  const Reflector mirror = conic_reflector(ConicPreset::ellipse, 25.0, 120.0, Aperture::circle(90.0, 12.0));
  const HeightField field(mirror, 64);
  FieldView view = view_of(field);
  const Fenced vertices(view.vertices, 3 * field.vertices().size());
  const Fenced nodes(view.nodes, 4 * field.nodes().size());
  view.vertices = vertices.data();
  view.nodes = nodes.data();
  Rng rng(5, 0);
  for (const Kernels* kernels : available_kernels()) {
    auto in = std::make_unique<LocalRays>();
    auto out = std::make_unique<LocalHits>();
    std::size_t hits = 0;
    for (int batch = 0; batch < 200; ++batch) {
      for (std::size_t i = 0; i < kBatch; ++i) {
        const Direction d = random_direction(rng);
        in->x[i] = static_cast<float>(80.0 * rng.uniform() - 40.0);
        in->y[i] = static_cast<float>(80.0 * rng.uniform() - 40.0);
        in->z[i] = static_cast<float>(40.0 * rng.uniform());
        in->dx[i] = static_cast<float>(d.x());
        in->dy[i] = static_cast<float>(d.y());
        in->dz[i] = static_cast<float>(d.z());
        in->on_mirror[i] = 0;
      }
      kernels->intersect(view, *in, kBatch, *out);
      for (std::size_t i = 0; i < kBatch; ++i) hits += out->state[i] != kMiss;
    }
    EXPECT_GT(hits, 20000u);
  }
}

// An array of statuses may end with the last of them, wherever in a vector that is.
TEST(Kernels, PartingReadsNoFateBehindTheLast) {
  const std::vector<std::int32_t> all(40, kEscaped);
  for (const Kernels* kernels : available_kernels()) {
    for (std::size_t n = 1; n <= all.size(); ++n) {
      const Fenced statuses(all.data(), n);
      auto rays = std::make_unique<WorldRays>(), out = std::make_unique<WorldRays>();
      std::size_t out_count = 0;
      EXPECT_EQ(kernels->compact(*rays, statuses.data(), n, *out, out_count), 0u)
          << kernels->isa << ", " << n;
      EXPECT_EQ(out_count, n) << kernels->isa;
    }
  }
}
#endif

TEST(Kernels, FarFieldCellsAreThoseOfTheGrid) {
  const FarFieldGrid grid({"far", 5.0, 1.0});
  Rng rng(3, 0);
  for (const Kernels* kernels : available_kernels()) {
    auto rays = std::make_unique<WorldRays>();
    alignas(64) std::int32_t cell[kBatch];
    int wrong = 0;
    for (int batch = 0; batch < 100; ++batch) {
      for (std::size_t i = 0; i < kBatch; ++i) {
        Direction d = random_direction(rng);
        if (i < 6)
          d = Direction::from({i == 0   ? 1.0
                               : i == 1 ? -1.0
                                        : 0.0,
                               i == 2   ? 1.0
                               : i == 3 ? -1.0
                                        : 0.0,
                               i == 4   ? 1.0
                               : i == 5 ? -1.0
                                        : 0.0});
        rays->dx[i] = static_cast<float>(d.x());
        rays->dy[i] = static_cast<float>(d.y());
        rays->dz[i] = static_cast<float>(d.z());
      }
      kernels->far_field_cells(*rays, kBatch, 72, 181, cell);
      for (std::size_t i = 0; i < kBatch; ++i) {
        const Direction d = Direction::from({rays->dx[i], rays->dy[i], rays->dz[i]});
        const bool same = static_cast<std::size_t>(cell[i]) == grid.cell(d);
        wrong += !same;
        if (i < 6) {
          EXPECT_TRUE(same) << kernels->isa << ": axis " << i;
        }
      }
    }
    EXPECT_LE(wrong, 5) << kernels->isa << ": directions on a border, to rounding";
  }
}

/// Rays from everywhere, in a mirror's frame.
void fill_rays(Rng& rng, LocalRays& in) {
  for (std::size_t i = 0; i < kBatch; ++i) {
    const Direction d = random_direction(rng);
    in.x[i] = static_cast<float>(100.0 * rng.uniform() - 50.0);
    in.y[i] = static_cast<float>(100.0 * rng.uniform() - 50.0);
    in.z[i] = static_cast<float>(80.0 * rng.uniform() - 20.0);
    in.dx[i] = static_cast<float>(d.x());
    in.dy[i] = static_cast<float>(d.y());
    in.dz[i] = static_cast<float>(d.z());
    in.on_mirror[i] = 0;
  }
}

/// Hits and reflected rays of one kernel.
struct Reflected {
  LocalHits hits;
  WorldRays rays;
  alignas(64) float cosine[kBatch];
};
void reflect_all(const Kernels& kernels, const FieldView& field, const LocalRays& in, Reflected& out) {
  const FrameView same{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  kernels.intersect(field, in, kBatch, out.hits);
  kernels.reflect(same, in, out.hits, kBatch, out.rays, out.cosine);
}

// "scalar" is what a GPU compiles; so this is as near as a machine without one comes to its rays.
TEST(Kernels, ScalarAgreesRayByRayWithEveryInstructionSet) {
  auto in = std::make_unique<LocalRays>();
  auto one = std::make_unique<Reflected>(), many = std::make_unique<Reflected>();
  for (const Kernels* kernels : available_kernels()) {
    std::size_t rays = 0, hits = 0, differ = 0;
    for (const Reflector& mirror : height_fields()) {
      const HeightField field(mirror, 256);
      Rng rng(19, 0);
      for (int batch = 0; batch < 40; ++batch, rays += kBatch) {
        fill_rays(rng, *in);
        reflect_all(scalar_kernels(), view_of(field), *in, *one);
        reflect_all(*kernels, view_of(field), *in, *many);
        for (std::size_t i = 0; i < kBatch; ++i) {
          if (one->hits.state[i] == kMiss && many->hits.state[i] == kMiss) continue;
          ++hits;
          bool same =
              one->hits.state[i] == many->hits.state[i] && std::abs(one->hits.t[i] - many->hits.t[i]) < 1e-4F;
          if (same && one->hits.state[i] == kFront) {
            same = std::abs(one->rays.dx[i] - many->rays.dx[i]) < 1e-5F &&
                   std::abs(one->rays.dy[i] - many->rays.dy[i]) < 1e-5F &&
                   std::abs(one->rays.dz[i] - many->rays.dz[i]) < 1e-5F;
          }
          differ += same ? 0 : 1;
        }
      }
    }
    EXPECT_GT(hits, 40000u);
    // Rays that graze: their distance is the less certain the flatter they are.
    EXPECT_LE(static_cast<double>(differ), 1e-4 * static_cast<double>(rays)) << kernels->isa;
    RecordProperty(kernels->isa, std::to_string(differ) + " of " + std::to_string(rays));
  }
}

/// Rays whose hits with two fields differ; `reflected` counts those that start on the mirror.
struct Disagreements {
  std::size_t rays = 0, hits = 0, reflected = 0, differ = 0;
  Disagreements& operator+=(const Disagreements& o) {
    rays += o.rays;
    hits += o.hits;
    reflected += o.reflected;
    differ += o.differ;
    return *this;
  }
};

/// Rays from everywhere, and what becomes of those that are reflected, with two views of one mirror.
Disagreements compare(const Kernels& kernels, const FieldView& a, const FieldView& b, int batches) {
  auto in = std::make_unique<LocalRays>();
  auto first = std::make_unique<Reflected>(), second = std::make_unique<Reflected>();
  Disagreements d;
  Rng rng(23, 0);
  for (int batch = 0; batch < batches; ++batch) {
    fill_rays(rng, *in);
    for (const bool reflected : {false, true}) {
      reflect_all(kernels, a, *in, *first);
      reflect_all(kernels, b, *in, *second);
      for (std::size_t i = 0; i < kBatch; ++i) {
        ++d.rays;
        d.reflected += in->on_mirror[i] != 0;
        d.hits += first->hits.state[i] != kMiss;
        const bool both_miss = first->hits.state[i] == kMiss && second->hits.state[i] == kMiss;
        d.differ += first->hits.state[i] != second->hits.state[i] ||
                    (!both_miss && std::abs(first->hits.t[i] - second->hits.t[i]) > 1e-3F);
      }
      if (reflected) break;
      for (std::size_t i = 0; i < kBatch; ++i) {
        if (second->hits.state[i] != kFront) continue;
        const WorldRays& r = second->rays;
        in->x[i] = r.x[i];
        in->y[i] = r.y[i];
        in->z[i] = r.z[i];
        in->dx[i] = r.dx[i];
        in->dy[i] = r.dy[i];
        in->dz[i] = r.dz[i];
        in->on_mirror[i] = 1;
      }
    }
  }
  return d;
}

/// What skips the tree because it falls or rises faster than the surface, against what the tree finds;
/// `bound` is said to be the surface's gradient bound.
Disagreements against_tree(const Kernels& kernels, const HeightField& field, float bound) {
  FieldView tried = view_of(field), by_tree = tried;
  tried.gradient_bound = bound;
  by_tree.gradient_bound = 1e9F;
  return compare(kernels, tried, by_tree, 20);
}

// On a rough surface a bound that does not hold is found out.
TEST(Kernels, WhatSkipsTheTreeMeetsWhatTheTreeFinds) {
  HeightField rough(height_fields().front(), 64);
  Rng rng(29, 0);
  for (FieldVertex& v : rough.vertices()) v.z_mm = static_cast<float>(2.0 * rng.uniform());
  rough.rebuild();
  for (const Kernels* kernels : available_kernels()) {
    Disagreements all = against_tree(*kernels, rough, rough.gradient_bound());
    for (const Reflector& mirror : height_fields()) {
      const HeightField field(mirror, 256);
      all += against_tree(*kernels, field, field.gradient_bound());
    }
    EXPECT_GT(all.hits, 30000u);
    EXPECT_GT(all.reflected, 5000u);
    EXPECT_LE(static_cast<double>(all.differ), 3e-5 * static_cast<double>(all.rays)) << kernels->isa;
    const Disagreements wrong = against_tree(*kernels, rough, 0.1F);
    EXPECT_GT(static_cast<double>(wrong.differ), 5e-4 * static_cast<double>(wrong.rays)) << kernels->isa;
  }
}

TEST(Kernels, RaysEnterInTheLuminairesFrameAndNothingIsMissed) {
  constexpr std::size_t kRays = 509;
  const FrameView turned{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {1, 2, 3}};
  Rng rng(7, 0);
  std::vector<std::vector<float>> in(7, std::vector<float>(kRays));
  for (auto& array : in) {
    for (float& x : array) x = static_cast<float>(rng.uniform());
  }
  const RayArrays arrays{in[0].data(), in[1].data(), in[2].data(), in[3].data(),
                         in[4].data(), in[5].data(), in[6].data()};
  for (const Kernels* kernels : available_kernels()) {
    auto out = std::make_unique<WorldRays>();
    bool all_finite = false;
    const std::int64_t quanta = kernels->enter(turned, arrays, kRays, 0.75, *out, all_finite);
    EXPECT_TRUE(all_finite);
    double flux = 0.0;
    for (std::size_t i = 0; i < kRays; ++i) {
      EXPECT_FLOAT_EQ(out->x[i], 1.0F - in[1][i]) << kernels->isa;
      EXPECT_FLOAT_EQ(out->y[i], 2.0F + in[0][i]);
      EXPECT_FLOAT_EQ(out->z[i], 3.0F + in[2][i]);
      EXPECT_FLOAT_EQ(out->dx[i], -in[4][i]);
      EXPECT_FLOAT_EQ(out->dy[i], in[3][i]);
      EXPECT_FLOAT_EQ(out->dz[i], in[5][i]);
      EXPECT_FLOAT_EQ(out->flux[i], 0.75F * in[6][i]);
      EXPECT_EQ(out->number[i], static_cast<int>(i));
      EXPECT_EQ(out->mirror[i], -1);
      flux += static_cast<double>(out->flux[i]);
    }
    EXPECT_NEAR(static_cast<double>(quanta), flux * kQuantaPerRay, kRays);
    for (const std::size_t lane : {std::size_t{0}, std::size_t{100}, kRays - 1}) {
      for (std::size_t a = 0; a < 6; ++a) {
        const float before = std::exchange(in[a][lane], a % 2 == 0 ? NAN : INFINITY);
        kernels->enter(turned, arrays, kRays, 0.75, *out, all_finite);
        EXPECT_FALSE(all_finite) << kernels->isa << ", array " << a << ", ray " << lane;
        in[a][lane] = before;
      }
    }
  }
}

TEST(Kernels, FatesAddUpAndPartingKeepsTheOrder) {
  constexpr std::size_t kRays = 509;
  Rng rng(8, 0);
  auto hits = std::make_unique<LocalHits>();
  auto rays = std::make_unique<WorldRays>();
  std::vector<std::int32_t> reflections(kRays), status(kRays);
  std::vector<double> throughput(kRays);
  for (std::size_t i = 0; i < kRays; ++i) {
    hits->state[i] = static_cast<std::int32_t>(3.0 * rng.uniform());
    reflections[i] = static_cast<std::int32_t>(3.0 * rng.uniform());
    status[i] = i % 7 == 0 ? 4 : kEscaped;  // some met mirror 4 before
    if (status[i] == 4) hits->state[i] = kMiss;
    throughput[i] = rng.uniform();
    rays->flux[i] = static_cast<float>(2.0 * rng.uniform());
    rays->number[i] = static_cast<std::int32_t>(1000 + i);
    for (float* array : {rays->x, rays->y, rays->z, rays->dx, rays->dy, rays->dz})
      array[i] = static_cast<float>(rng.uniform());
  }
  for (const Kernels* kernels : available_kernels()) {
    auto now = std::make_unique<WorldRays>(*rays);
    std::vector<std::int32_t> statuses = status;
    const MirrorSums sums = kernels->resolve_hits(*hits, reflections.data(), 2, throughput.data(), 5, kRays,
                                                  now->flux, statuses.data());
    double before = 0.0, after = 0.0;
    std::int64_t lost_rays = 0, reflected = 0;
    std::vector<std::size_t> stay, leave;
    for (std::size_t i = 0; i < kRays; ++i) {
      before += static_cast<double>(rays->flux[i]);
      const bool front = hits->state[i] == kFront, last = front && reflections[i] == 2;
      const std::int32_t expected = hits->state[i] == kMiss ? status[i] : front && !last ? 5 : kTerminated;
      ASSERT_EQ(statuses[i], expected) << kernels->isa << ", ray " << i;
      EXPECT_FLOAT_EQ(now->flux[i],
                      rays->flux[i] * (expected == 5 ? static_cast<float>(throughput[i]) : 1.0F));
      if (expected != kTerminated) after += static_cast<double>(now->flux[i]);
      lost_rays += last;
      reflected += expected == 5;
      if (expected >= 0) stay.push_back(i);
      if (expected == kEscaped) leave.push_back(i);
    }
    EXPECT_EQ(sums.lost_rays, lost_rays);
    EXPECT_EQ(sums.reflections, reflected);
    EXPECT_NEAR(static_cast<double>(sums.face + sums.back + sums.lost), (before - after) * kQuantaPerRay,
                2.0 * kRays);
    auto out = std::make_unique<WorldRays>();
    const WorldRays settled = *now;
    std::size_t out_count = 2;
    ASSERT_EQ(kernels->compact(*now, statuses.data(), kRays, *out, out_count), stay.size()) << kernels->isa;
    ASSERT_EQ(out_count, 2 + leave.size());
    const auto same = [&](const WorldRays& a, std::size_t i, std::size_t of) {
      return a.number[i] == settled.number[of] && a.x[i] == settled.x[of] && a.y[i] == settled.y[of] &&
             a.z[i] == settled.z[of] && a.dx[i] == settled.dx[of] && a.dy[i] == settled.dy[of] &&
             a.dz[i] == settled.dz[of] && a.flux[i] == settled.flux[of];
    };
    for (std::size_t k = 0; k < stay.size(); ++k) {
      EXPECT_TRUE(same(*now, k, stay[k])) << kernels->isa << ", ray " << k;
      EXPECT_EQ(now->mirror[k], statuses[stay[k]]);
    }
    for (std::size_t k = 0; k < leave.size(); ++k) EXPECT_TRUE(same(*out, 2 + k, leave[k])) << kernels->isa;
  }
}

TEST(Kernels, UnknownInstructionSetIsRefused) { EXPECT_THROW(kernels_named("mmx"), UsageError); }

}  // namespace
}  // namespace lucerna
