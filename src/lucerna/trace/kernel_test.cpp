// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernel.h"

#include <gtest/gtest.h>
#if defined(__linux__)
#include <sys/mman.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "lucerna/core/error.h"
#include "lucerna/core/random.h"
#include "lucerna/trace/far_field.h"
#include "lucerna/trace/field_view.h"
#include "lucerna/trace/reference_tracer.h"
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
/// A copy of floats whose last one ends where a page that may not be read begins.
class Fenced {
 public:
  Fenced(const float* from, std::size_t n) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    const std::size_t bytes = (n * sizeof(float) + page - 1) / page * page;
    size_ = bytes + 2 * page;
    // Before it too: places off the grid may be below 0.
    start_ = static_cast<char*>(mmap(nullptr, size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (start_ == MAP_FAILED || mprotect(start_ + page, bytes, PROT_READ | PROT_WRITE) != 0) std::abort();
    data_ = reinterpret_cast<float*>(start_ + page + bytes) - n;
    std::copy_n(from, n, data_);
  }
  ~Fenced() { munmap(start_, size_); }
  Fenced(const Fenced&) = delete;
  Fenced& operator=(const Fenced&) = delete;
  const float* data() const { return data_; }

 private:
  char* start_;
  std::size_t size_;
  float* data_;
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

TEST(Kernels, UnknownInstructionSetIsRefused) { EXPECT_THROW(kernels_named("mmx"), UsageError); }

}  // namespace
}  // namespace lucerna
