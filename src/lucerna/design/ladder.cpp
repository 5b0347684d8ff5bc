// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lucerna/design/fit.h"

namespace lucerna {

std::vector<FitStage> ladder(const DesignShape& shape, const TentBins& bins, std::uint64_t rays, bool far) {
  const int nx = shape.intervals_x(), ny = shape.intervals_y(), k = bins.count();
  std::vector<FitStage> stages;
  const auto add = [&](int mx, int my, int count, double widen, int log_rays, double gain) {
    const std::uint64_t n = std::min(rays, std::uint64_t{1} << log_rays);
    if (!stages.empty()) {
      const FitStage& last = stages.back();
      if (last.rays == n && last.bins == count && last.intervals_x == mx && last.intervals_y == my) return;
    }
    stages.push_back({mx, my, count, widen, n, 30, gain});
  };
  if (shape.is_revolution()) {
    // A ring is one number: fewer rings than parameters would leave the shape open.
    const int few = std::min(nx, 4), coarse = std::min(k, std::max(k / 3, nx + 6));
    if (far) {
      add(few, ny, k / 3, 1.3, 16, 0.03);
      add(nx, ny, coarse, 1.3, 16, 0.02);
    }
    add(nx, ny, coarse, 1.0, 17, 0.02);
    add(nx, ny, k, 1.0, 18, 0.03);
    stages.back().gate = true;
    add(nx, ny, k, 1.0, 20, 0.02);
    return stages;
  }
  if (far) {
    const int few = 2, gentle = std::min(nx, few), gentle_y = std::min(ny, few);
    add(gentle, gentle_y, k / 6, 1.5, 16, 0.03);
    add(gentle, gentle_y, k / 4, 1.2, 16, 0.03);
    add(nx, ny, k / 6, 1.5, 16, 0.02);
    add(nx, ny, k / 4, 1.2, 16, 0.02);
  }
  add(nx, ny, k / 3, 1.0, 16, 0.03);
  add(nx, ny, k / 3, 1.0, 18, 0.03);
  stages.back().gate = true;
  add(nx, ny, k / 2, 1.0, 18, 0.03);
  add(nx, ny, k / 2, 1.0, 20, 0.03);
  add(nx, ny, k, 1.0, 20, 0.03);
  return stages;
}

}  // namespace lucerna
