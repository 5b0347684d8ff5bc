// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/solid_kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/trace/engines/solid_rays.h"
#include "lucerna/trace/kernels/revolved_tree.h"
#include "lucerna/trace/kernels/solid_kernel.h"
#include "tests/support/turned_outlines.h"

namespace lucerna {
namespace {

std::vector<const SolidKernels*> all_solid_kernels_here() {
  std::vector<const SolidKernels*> out;
  for (const char* isa : {"scalar", "avx2", "avx512"}) {
    if (const SolidKernels* kernels = solid_kernels_named(isa)) out.push_back(kernels);
  }
  return out;
}

/// Rays near a body and from afar, along and across its axis, through it and along flat sides.
Ray odd_ray(Rng& rng, int i) {
  Ray ray = test::ray_across(rng, 16.0);
  if (i % 10 == 1) ray.direction = Direction::from({0, 0, 1});
  if (i % 10 == 2) ray.direction = Direction::from({ray.direction.x(), ray.direction.y(), 0.0});
  if (i % 10 == 3) ray.origin_mm = {0.0, 0.0, ray.origin_mm.z};
  if (i % 10 == 4) ray.origin_mm.z = 15.0;
  if (i % 10 == 5) ray.origin_mm = ray.at(-1e6);
  if (i % 10 == 6) ray.origin_mm = ray.at(1e3);
  return ray;
}

/// The first hit of one ray as a batch has it.
SurfaceHit hit_of(const SolidBatch& b, std::size_t i) { return {b.part[i], b.t[i], b.u[i], 0.0}; }

TEST(SolidKernels, AllFindTheFirstSidesOfSingleRays) {
  const auto batch = std::make_unique<SolidBatch>();
  for (const SolidKernels* kernels : all_solid_kernels_here()) {
    Rng rng(4, 0);
    int hits = 0;
    for (const test::OutlineCorners& shape : test::turned_outlines()) {
      // Of few sides, and of several levels.
      for (const double tolerance_mm : {1.0, 1e-3, 1e-7}) {
        const RevolvedTree tree(outline_sides(shape, 20.0, tolerance_mm));
        const RevolvedSurface surface{tree.view()};
        for (int turn = 0; turn < 100; ++turn) {
          const std::size_t n = turn == 0 ? 1 : turn == 1 ? 13 : kSolidBatch;
          const double t_min = turn % 2 == 0 ? 0.0 : kSolidStart;
          std::vector<Ray> rays;
          for (std::size_t i = 0; i < n; ++i) {
            rays.push_back(odd_ray(rng, static_cast<int>(i)));
            put_ray(rays[i], i, *batch);
            batch->t[i] = i % 7 == 0 ? 5.0 : 1e300;
          }
          kernels->first_sides(tree.blocks(), t_min, n, *batch);
          kernels->side_normals(tree.view().sides, n, *batch);
          for (std::size_t i = 0; i < n; ++i) {
            const SurfaceHit one = surface.first(rays[i], t_min, i % 7 == 0 ? 5.0 : 1e300);
            const SurfaceHit found = hit_of(*batch, i);
            ASSERT_EQ(found.part, one.part) << kernels->isa << ' ' << i;
            if (one.part < 0) continue;
            ++hits;
            ASSERT_EQ(found.t_mm, one.t_mm) << kernels->isa << ' ' << i;
            ASSERT_EQ(found.u, one.u) << kernels->isa << ' ' << i;
            const Vec3 at = rays[i].at(one.t_mm);
            ASSERT_EQ(outward_of(*batch, i), surface.outward(at, one)) << kernels->isa << ' ' << i;
            ASSERT_EQ((Vec3{batch->sx[i], batch->sy[i], batch->sz[i]}), surface.smooth(at, one));
          }
        }
      }
    }
    EXPECT_GT(hits, 10000) << kernels->isa;
  }
}

// Where float has no digits left for millimetres, what is no ring must not count as one.
TEST(SolidKernels, ABodyOfKilometresHasNoSidesThatAreNotThere) {
  const double r = 1e6;
  const RevolvedTree tree(outline_sides(test::OutlineCorners{{0, 0}, {r, 0}, {r, 10}, {0, 10}}, 0.0, 1e-3));
  const RingBlock& block = tree.blocks().levels[0][0];
  for (int k = 3; k < kRingBlock; ++k) EXPECT_LT(block.r2_high[k], -1e30F) << k;
  const auto batch = std::make_unique<SolidBatch>();
  for (const SolidKernels* kernels : all_solid_kernels_here()) {
    Rng rng(8, 0);
    for (std::size_t i = 0; i < kSolidBatch; ++i) {
      put_ray({{r * (rng.uniform() - 0.5), r * (rng.uniform() - 0.5), -1e3 * rng.uniform()},
               Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, 0.01 * rng.uniform()})},
              i, *batch);
      batch->t[i] = 1e300;
    }
    kernels->first_sides(tree.blocks(), 0.0, kSolidBatch, *batch);
    for (std::size_t i = 0; i < kSolidBatch; ++i) {
      ASSERT_LT(batch->part[i], 3) << kernels->isa << ' ' << i;
      ASSERT_EQ(batch->part[i], (RevolvedSurface{tree.view()}.first(ray_of(*batch, i), 0.0, 1e300).part))
          << i;
    }
  }
}

// More than the lists of a search hold: thin rings about each other, and rays that cross them all.
TEST(SolidKernels, RaysMayMeetManySides) {
  test::OutlineCorners comb{{0, 0}};
  for (int i = 1; i <= 200; ++i) {
    const double r = 0.1 * i;
    comb.insert(comb.end(), {{r, 0}, {r, 10}, {r + 0.05, 10}, {r + 0.05, 1}});
  }
  comb.insert(comb.end(), {{21, 1}, {21, -1}, {0, -1}});
  const RevolvedTree tree(outline_sides(comb, 0.0, 1e-3));
  const RevolvedSurface surface{tree.view()};
  const auto batch = std::make_unique<SolidBatch>();
  for (const SolidKernels* kernels : all_solid_kernels_here()) {
    Rng rng(5, 0);
    for (std::size_t i = 0; i < kSolidBatch; ++i) {
      put_ray({{-30.0, 4.0 * rng.uniform() - 2.0, 2.0 + 6.0 * rng.uniform()},
               Direction::from({1.0, 0.01 * rng.uniform(), 0.01 * rng.uniform()})},
              i, *batch);
      batch->t[i] = 1e300;
    }
    kernels->first_sides(tree.blocks(), 0.0, kSolidBatch, *batch);
    for (std::size_t i = 0; i < kSolidBatch; ++i) {
      const SurfaceHit one = surface.first(ray_of(*batch, i), 0.0, 1e300);
      ASSERT_EQ(batch->part[i], one.part) << kernels->isa << ' ' << i;
      ASSERT_EQ(batch->t[i], one.t_mm) << kernels->isa << ' ' << i;
    }
  }
}

/// Light at a boundary of any kind: smooth normals along, beside and against the surface's own, or none;
/// light on either side of it, along its normal, and beyond the critical angle.
void put_boundary(std::size_t i, Rng& rng, SolidBatch& b) {
  const auto any = [&] {
    return Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5});
  };
  const Direction d = any(), n = i % 9 == 0 ? d : i % 9 == 1 ? -d : any();
  const Vec3 smooth = i % 5 == 0   ? Vec3{}
                      : i % 5 == 1 ? n.vec()
                                   : 2.0 * n.vec() + (i % 5 == 2 ? 0.2 : 3.0) * any().vec();
  put_ray({{rng.uniform(), rng.uniform(), rng.uniform()}, d}, i, b);
  const double length_of = 0.5 + rng.uniform();
  b.nx[i] = length_of * n.x(), b.ny[i] = length_of * n.y(), b.nz[i] = length_of * n.z();
  b.sx[i] = smooth.x, b.sy[i] = smooth.y, b.sz[i] = smooth.z;
  b.t[i] = 10.0 * rng.uniform();
  // Now and then it is on the other side than it thinks.
  const bool inside = (dot(n, d) > 0.0) != (i % 11 == 0);
  b.inside[i] = inside ? 1.0 : 0.0;
  b.ratio[i] = i % 13 == 0 ? 1.0 : inside ? 1.0 / 1.6 : 1.6;
  b.chance[i] = rng.uniform();
}

TEST(SolidKernels, AllSendLightOnAsSingleRays) {
  const auto batch = std::make_unique<SolidBatch>(), before = std::make_unique<SolidBatch>();
  for (const SolidKernels* kernels : all_solid_kernels_here()) {
    Rng rng(6, 0);
    int reflected = 0, passed = 0, behind = 0;
    for (int turn = 0; turn < 50; ++turn) {
      const std::size_t n = turn == 0 ? 1 : turn == 1 ? 13 : kSolidBatch;
      for (std::size_t i = 0; i < n; ++i) put_boundary(i, rng, *batch);
      kernels->enter(n, *batch);
      for (std::size_t i = 0; i < n; ++i) {
        const Direction d = ray_of(*batch, i).direction;
        EXPECT_EQ(batch->inside[i] > 0.0, dot(outward_of(*batch, i), d.vec()) > 0.0);
        if (i % 11 == 0) batch->inside[i] = 1.0 - batch->inside[i];
        const Vec3 field = any_field(d, Direction::from(outward_of(*batch, i)), batch->chance[i]);
        ASSERT_EQ((Vec3{batch->fx[i], batch->fy[i], batch->fz[i]}), field) << kernels->isa << ' ' << i;
      }
      *before = *batch;
      kernels->cross_boundaries(n, *batch);
      for (std::size_t i = 0; i < n; ++i) {
        PolarisedRay light{ray_of(*before, i), {before->fx[i], before->fy[i], before->fz[i]}};
        const Vec3 outward = outward_of(*before, i), smooth{before->sx[i], before->sy[i], before->sz[i]};
        const bool inside = before->inside[i] > 0.0;
        const Direction d = light.ray.direction;
        const Vec3 at_mm = light.ray.at(before->t[i]);
        ASSERT_EQ(batch->behind[i] > 0.0, (dot(outward, d.vec()) > 0.0) != inside);
        ASSERT_EQ(ray_of(*batch, i).origin_mm, at_mm) << kernels->isa << ' ' << i;
        if (batch->behind[i] > 0.0) {
          ++behind;
          ASSERT_EQ(ray_of(*batch, i).direction, d);
          continue;
        }
        const BoundaryHit at = boundary_hit(d, outward, smooth, before->ratio[i]);
        const bool mirrored = cross_boundary(light, at, before->t[i], before->chance[i]);
        ++(mirrored ? reflected : passed);
        ASSERT_EQ(batch->reflected[i] > 0.0, mirrored) << kernels->isa << ' ' << i;
        ASSERT_EQ(ray_of(*batch, i).direction, light.ray.direction) << kernels->isa << ' ' << i;
        ASSERT_EQ((Vec3{batch->fx[i], batch->fy[i], batch->fz[i]}), light.field) << kernels->isa << ' ' << i;
        ASSERT_EQ((Vec3{batch->hx[i], batch->hy[i], batch->hz[i]}), at.normal.vec());
      }
    }
    EXPECT_GT(reflected, 500);
    EXPECT_GT(passed, 500);
    EXPECT_GT(behind, 200);
  }
}

}  // namespace
}  // namespace lucerna
