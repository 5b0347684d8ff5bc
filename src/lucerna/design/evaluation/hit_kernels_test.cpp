// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/hit_kernels.h"

#include <gtest/gtest.h>

#include <memory>
#include <variant>
#include <vector>

#include "lucerna/design/evaluation/smooth_path.h"
#include "lucerna/design/shape/design_shape.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

DesignShape rough_by(const DesignShape& plain, double mm, std::uint64_t seed) {
  Eigen::VectorXd p = plain.parameters();
  Rng rng(seed, 0);
  for (double& x : p) x = mm * (2.0 * rng.uniform() - 1.0);
  return plain.with(p);
}

std::vector<DesignShape> shapes() {
  const Aperture square = Aperture::rectangle(100, 70, 8), round = Aperture::circle(100, 12);
  return {rough_by(DesignShape::bspline(15, square, 4, 7), 0.6, 1),
          rough_by(DesignShape::bspline(4, round, 17, 17), 2.0, 2),
          rough_by(DesignShape::revolution(15, round, 8), 0.5, 3),
          rough_by(DesignShape::revolution(4, round, 20), 0.3, 4)};
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
  for (const DesignShape& shape : shapes()) {
    std::visit(
        [&](const auto& family) {
          const auto view = family.view();
          const auto mirror = hit_mirror(view, shape.aperture());
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
        shape.family());
  }
}

}  // namespace
}  // namespace lucerna
