// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/height_field/height_mipmap.h"

#include <algorithm>
#include <limits>

#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

HeightMipmap::HeightMipmap(const Reflector& reflector, int levels)
    : levels_(levels),
      region_(reflector.aperture.bounds()),
      cells_(static_cast<std::size_t>(levels) + 1),
      convex_(cells_.size()) {
  const std::size_t n = std::size_t{1} << levels;
  step_x_mm_ = (region_.x1_mm - region_.x0_mm) / static_cast<double>(n);
  step_y_mm_ = (region_.y1_mm - region_.y0_mm) / static_cast<double>(n);
  // Rounding in a ray's height against rounding in a surface's: far below any optical length.
  const double tolerance_mm = 1e-9 * (1.0 + reflector.aperture.outer_radius_mm());
  constexpr double kNothing = std::numeric_limits<double>::infinity();

  std::vector<HeightRange>& finest = cells_.back();
  std::vector<char>& finest_convex = convex_.back();
  finest.resize(n * n);
  finest_convex.resize(n * n);
  parallel_blocks(n, 8, [&](std::size_t first, std::size_t last) {
    for (std::size_t iy = first; iy < last; ++iy) {
      for (std::size_t ix = 0; ix < n; ++ix) {
        const Rectangle r{line_x_mm(levels, ix), line_x_mm(levels, ix + 1), line_y_mm(levels, iy),
                          line_y_mm(levels, iy + 1)};
        HeightRange& cell = finest[iy * n + ix];
        finest_convex[iy * n + ix] = reflector.surface->convex_over(r) ? 1 : 0;
        if (reflector.aperture.misses(r)) {
          cell = {kNothing, -kNothing};
        } else {
          cell = reflector.surface->range(r);
          cell.low_mm -= tolerance_mm;
          cell.high_mm += tolerance_mm;
        }
      }
    }
  });
  for (int level = levels; level-- > 0;) {
    const std::vector<HeightRange>& fine = cells_[static_cast<std::size_t>(level) + 1];
    std::vector<HeightRange>& coarse = cells_[static_cast<std::size_t>(level)];
    const std::size_t m = std::size_t{1} << level;
    // Surfaces are smooth: convex on both sides of a border is convex across it.
    const std::vector<char>& fine_convex = convex_[static_cast<std::size_t>(level) + 1];
    std::vector<char>& coarse_convex = convex_[static_cast<std::size_t>(level)];
    coarse.resize(m * m);
    coarse_convex.resize(m * m);
    for (std::size_t iy = 0; iy < m; ++iy) {
      for (std::size_t ix = 0; ix < m; ++ix) {
        const HeightRange* a = &fine[4 * iy * m + 2 * ix];
        const HeightRange* b = a + 2 * m;
        coarse[iy * m + ix] = {std::min({a[0].low_mm, a[1].low_mm, b[0].low_mm, b[1].low_mm}),
                               std::max({a[0].high_mm, a[1].high_mm, b[0].high_mm, b[1].high_mm})};
        const char* c = &fine_convex[4 * iy * m + 2 * ix];
        coarse_convex[iy * m + ix] = c[0] & c[1] & c[2 * m] & c[2 * m + 1];
      }
    }
  }
}

}  // namespace lucerna
