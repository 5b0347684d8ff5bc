// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/hit_kernels.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <variant>
#include <vector>

#include "lucerna/optics/shapes/smooth_shape.h"
#include "lucerna/random.h"
#include "lucerna/trace/kernels/hit_table.h"

namespace lucerna {
namespace {

struct SmoothMirror {
  std::variant<BsplineShape, RevolutionShape> shape;
  Aperture aperture;
};

/// As many as a row of knots or a square of them needs, uniform within `mm` of 0.
std::vector<double> rough_coefficients(int n, double mm, std::uint64_t seed) {
  std::vector<double> out;
  Rng rng(seed, 0);
  for (int i = 0; i < n; ++i) out.push_back(mm * (2.0 * rng.uniform() - 1.0));
  return out;
}

SmoothMirror rough_bspline(double focal_mm, const Aperture& a, int nx, int ny, double mm) {
  const KnotRow x{-a.half_x_mm(), 2.0 * a.half_x_mm() / nx, nx},
      y{-a.half_y_mm(), 2.0 * a.half_y_mm() / ny, ny};
  return {BsplineShape(focal_mm, x, y, rough_coefficients((nx + 3) * (ny + 3), mm, 1)), a};
}

SmoothMirror rough_revolution(double focal_mm, const Aperture& a, int n, double mm) {
  const KnotRow row{0.0, a.half_x_mm() / n, n};
  std::vector<double> c = rough_coefficients(row.coefficients(), mm, 2);
  c[0] = c[2];
  return {RevolutionShape(focal_mm, row, std::move(c)), a};
}

std::vector<SmoothMirror> rough_mirrors() {
  const Aperture square = Aperture::rectangle(100, 70, 8), round = Aperture::circle(100, 12);
  return {rough_bspline(15, square, 4, 7, 0.6), rough_bspline(4, round, 17, 17, 2.0),
          rough_revolution(15, round, 8, 0.5), rough_revolution(4, round, 20, 0.3)};
}

/// n rays from about the focus, from far outside, and from the mirror itself.
template <class Shape>
std::unique_ptr<HitRays> rays_about(const Shape& shape, std::size_t n) {
  auto rays = std::make_unique<HitRays>();
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(9, i);
    const auto within = [&](double mm) { return mm * (2.0 * rng.uniform() - 1.0); };
    Vec3 o{within(3.0), within(3.0), 15.0 + within(3.0)};
    Vec3 d = Direction::from({within(1.0), within(1.0), within(1.0)}).vec();
    double slope = 0.0;
    const bool on_mirror = i % 3 == 2;
    if (i % 3 == 1) {
      o = {within(80.0), within(80.0), within(80.0) - 50.0};
      d = Direction::from(Vec3{within(40.0), within(40.0), 5.0} - o).vec();
    }
    if (on_mirror) {
      o = {within(34.0), within(34.0), 0.0};
      const SurfacePoint p = smooth_point(shape, o.x, o.y);
      o.z = p.z_mm;
      slope = d.z - p.dzdx * d.x - p.dzdy * d.y;
    }
    // Only what leaves the front starts there.
    const double turn = on_mirror && slope < 0.0 ? -1.0 : 1.0;
    rays->x[i] = o.x, rays->y[i] = o.y, rays->z[i] = o.z;
    rays->dx[i] = turn * d.x, rays->dy[i] = turn * d.y, rays->dz[i] = turn * d.z;
    rays->on_mirror[i] = on_mirror ? 1.0 : 0.0;
    rays->slope[i] = turn * slope;
  }
  return rays;
}

void search(const HitKernels& k, const HitMirror<BsplineHitTable>& m, const HitRays& r, std::size_t n,
            HitEnds& e) {
  k.bspline(m, r, n, e);
}
void search(const HitKernels& k, const HitMirror<RevolutionHitTable>& m, const HitRays& r, std::size_t n,
            HitEnds& e) {
  k.revolution(m, r, n, e);
}

TEST(HitKernels, AllInstructionSetsFindTheSameBits) {
  for (const SmoothMirror& rough : rough_mirrors()) {
    std::visit(
        [&](const auto& family) {
          const auto view = family.view();
          const auto mirror = hit_mirror(view, rough.aperture);
          for (const std::size_t n : {std::size_t{1}, std::size_t{13}, kHitBatch}) {
            const auto rays = rays_about(view, n);
            const auto one = std::make_unique<HitEnds>(), many = std::make_unique<HitEnds>();
            search(scalar_hit_kernels(), mirror, *rays, n, *one);
            int ends[4] = {};
            for (const char* isa : {"avx2", "avx512"}) {
              const HitKernels* const kernels = hit_kernels_named(isa);
              if (kernels == nullptr) continue;
              search(*kernels, mirror, *rays, n, *many);
              for (std::size_t i = 0; i < n; ++i) {
                ASSERT_EQ(many->what[i], one->what[i]) << isa << " ray " << i;
                if (one->what[i] == kHitNothing) continue;
                ASSERT_EQ(many->t[i], one->t[i]) << isa << " ray " << i;
              }
            }
            for (std::size_t i = 0; i < n; ++i) ++ends[one->what[i]];
            if (n < kHitBatch) continue;
            EXPECT_GT(ends[kHitNothing], 50);
            EXPECT_GT(ends[kHitFront], 50);
            EXPECT_GT(ends[kHitBack], 10);
            EXPECT_EQ(ends[kHitFailed], 0);
          }
        },
        rough.shape);
  }
}

}  // namespace
}  // namespace lucerna
