// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lucerna/design/fit.h"

namespace lucerna {

std::vector<FitStage> ladder(const DesignShape& shape, const TentBins& bins, std::uint64_t rays, bool far) {
  const int nx = shape.intervals_x(), ny = shape.intervals_y(), k = bins.count();
  std::vector<FitStage> stages;
  const auto add = [&](int count, double widen, int log_rays, double gain) {
    if ((std::uint64_t{1} << log_rays) <= rays) stages.push_back({nx, ny, count, widen, std::uint64_t{1} << log_rays, 30, gain});
  };
  if (far) {
    add(k / 6, 1.5, 16, 0.02);
    add(k / 4, 1.2, 16, 0.02);
  }
  add(k / 3, 1.0, 16, 0.03);
  add(k / 3, 1.0, 18, 0.03);
  add(k / 2, 1.0, 18, 0.03);
  add(k / 2, 1.0, 20, 0.03);
  add(k , 1.0, 20, 0.03);
  return stages;
}

}  // namespace lucerna
