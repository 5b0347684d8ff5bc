// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "lucerna/source/adaptive/charts/support.h"

namespace lucerna {

/// Rays per batch: arrays of doubles that stay in the first-level cache.
inline constexpr std::size_t kSupportBatch = 128;
using BatchColumn = std::array<double, kSupportBatch>;

/// Starts and directions of a batch as columns, mm.
struct RayBatch {
  BatchColumn x, y, z, kx, ky, kz;

  Ray ray(std::size_t i) const { return {{x[i], y[i], z[i]}, Direction::from_unit({kx[i], ky[i], kz[i]})}; }
  void set(std::size_t i, const Ray& r) {
    x[i] = r.origin_mm.x, y[i] = r.origin_mm.y, z[i] = r.origin_mm.z;
    kx[i] = r.direction.x(), ky[i] = r.direction.y(), kz[i] = r.direction.z();
  }
};

/// Support::from_chart for the entries of four columns, all of one chart, to within rounding (1e-9 in the
/// direction of an axis support, else 1e-12): polynomials instead of library functions, without branches, so
/// that compilers vectorise it. Always makes all kSupportBatch rays; entries that hold no number make none.
void rays_from_chart(const Support& support, std::uint32_t chart, const std::array<BatchColumn, 4>& c,
                     RayBatch& out);

/// start_on for the first `n` rays. The others have numbers, but may stay off the surface.
void start_batch_on(const BoundingSurface& surface, std::size_t n, RayBatch& rays);

}  // namespace lucerna
