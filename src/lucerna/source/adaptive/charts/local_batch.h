// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/simd/vector_clones.h"
#include "lucerna/source/adaptive/charts/support_batch.h"

namespace lucerna {

/// A ray of a batch in the frame of a surface: start o, direction d.
struct LocalRay {
  double ox, oy, oz, dx, dy, dz;
};

LUCERNA_ALWAYS_INLINE inline LocalRay local_ray(const Frame& f, const RayBatch& r, std::size_t i) {
  const Vec3 &ex = f.ex(), &ey = f.ey(), &ez = f.ez(), &o = f.origin_mm();
  const double x = r.x[i] - o.x, y = r.y[i] - o.y, z = r.z[i] - o.z;
  return {x * ex.x + y * ex.y + z * ex.z,
          x * ey.x + y * ey.y + z * ey.z,
          x * ez.x + y * ez.y + z * ez.z,
          r.kx[i] * ex.x + r.ky[i] * ex.y + r.kz[i] * ex.z,
          r.kx[i] * ey.x + r.ky[i] * ey.y + r.kz[i] * ey.z,
          r.kx[i] * ez.x + r.ky[i] * ez.y + r.kz[i] * ez.z};
}

}  // namespace lucerna
