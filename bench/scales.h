// SPDX-License-Identifier: Apache-2.0
// The test of scales: how far illuminance on the plane of the focus is from the truth in cells of five sizes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/rays.h"
#include "lucerna/source.h"

namespace lucerna::bench {

inline constexpr std::array<double, 5> kScalesUm{12.0, 24.0, 48.0, 96.0, 240.0};

/// The share of a source's flux that crosses z = 0 at coordinates below x and y, exactly.
using ShareBelow = double (*)(double x_mm, double y_mm);

/// Illuminance of rays on z = 0 in cells of 12 um about the origin; what is farther out than 2.88 mm is one
/// more cell. Coarser cells are sums of these.
class PlaneCells {
 public:
  void add(const RayBlock& rays) {
    const auto parts = parallel_map_blocks<std::vector<double>>(
        rays.size(), rays.size() / 4 + 1, [&](std::size_t first, std::size_t last) {
          std::vector<double> part(kSide * kSide + 1, 0.0);
          for (std::size_t i = first; i < last; ++i)
            part[cell(rays.ray(i))] += static_cast<double>(rays.weight[i]);
          return part;
        });
    for (const auto& part : parts) {
      for (std::size_t i = 0; i < part.size(); ++i) weight_[i] += part[i];
    }
  }

  /// Sum over cells of `scale` * 12 um of |share - exact share|.
  double l1(ShareBelow exact, std::size_t scale) const {
    double total = 0.0, seen = 0.0, exactly_seen = 0.0, sum = 0.0;
    for (const double w : weight_) total += w;
    const auto edge = [](std::size_t i) { return kCellMm * (static_cast<double>(i) - 0.5 * kSide); };
    for (std::size_t y = 0; y < kSide; y += scale) {
      for (std::size_t x = 0; x < kSide; x += scale) {
        double w = 0.0;
        for (std::size_t j = y; j < y + scale; ++j) {
          for (std::size_t i = x; i < x + scale; ++i) w += weight_[j * kSide + i];
        }
        const double a = edge(x), b = edge(x + scale), c = edge(y), d = edge(y + scale);
        const double share = exact(b, d) - exact(a, d) - exact(b, c) + exact(a, c);
        sum += std::abs(w / total - share), seen += w / total, exactly_seen += share;
      }
    }
    return sum + std::abs(seen - exactly_seen);
  }

 private:
  static constexpr std::size_t kSide = 480;  // divisible by every scale
  static constexpr double kCellMm = 1e-3 * kScalesUm[0];
  static std::size_t cell(const Ray& ray) {
    const Vec3& d = ray.direction.vec();
    const Vec3 at = ray.at(-ray.origin_mm.z / d.z);
    const double x = std::floor(at.x / kCellMm) + kSide / 2, y = std::floor(at.y / kCellMm) + kSide / 2;
    const bool inside = x >= 0.0 && y >= 0.0 && x < kSide && y < kSide;
    return inside ? static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x) : kSide * kSide;
  }
  std::vector<double> weight_ = std::vector<double>(kSide * kSide + 1, 0.0);
};

/// L1 at the five scales.
inline std::array<double, 5> l1_of_scales(const PlaneCells& cells, ShareBelow exact) {
  std::array<double, 5> l1{};
  for (std::size_t k = 0; k < l1.size(); ++k)
    l1[k] = cells.l1(exact, static_cast<std::size_t>(std::lround(kScalesUm[k] / kScalesUm[0])));
  return l1;
}

}  // namespace lucerna::bench
