// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/constraints/source_side.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

namespace {

constexpr std::uint64_t kLookedAtBlocks = 16;
constexpr double kNoBound = std::numeric_limits<double>::infinity();
/// Cells along the longer side of the source, seen along the axis. Starts that are so many cells above the
/// lowest of theirs are passed after it.
constexpr int kSourceCells = 24;
constexpr double kDepth = 2.0;
/// Limits cost from a little inside on; the given mirror costs nothing.
constexpr double kAboveGiven_mm = 0.05;

/// Calls `f(point, weight)` for each start over the aperture; returns all light.
template <class F>
double for_each_start(const Aperture& aperture, const DesignRays& rays, const F& f) {
  double all = 0.0;
  for (std::uint64_t b = 0; b < std::min(kLookedAtBlocks, rays.size() / kBlockRays); ++b) {
    const DesignRays::Block& block = rays.block(b);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const Vec3 at{block.x_mm[i], block.y_mm[i], block.z_mm[i]};
      const auto weight = static_cast<double>(block.weight[i]);
      all += weight;
      if (weight > 0.0 && aperture.contains(at.x, at.y)) f(at, weight);
    }
  }
  return all;
}

}  // namespace

double share_behind(const DesignShape& shape, const DesignRays& rays) {
  double behind = 0.0;
  const double all = for_each_start(shape.aperture(), rays, [&](const Vec3& at, double weight) {
    if (at.z < shape.at(at.x, at.y).z_mm) behind += weight;
  });
  return behind / all;
}

std::vector<HeightBounds> heights_below_source(const DesignShape& given, const DesignRays& rays) {
  std::vector<Vec3> starts;
  double x_low = kNoBound, x_high = -kNoBound, y_low = kNoBound, y_high = -kNoBound;
  for_each_start(given.aperture(), rays, [&](const Vec3& at, double) {
    if (!(given.at(at.x, at.y).z_mm < at.z)) return;
    starts.push_back(at);
    x_low = std::min(x_low, at.x), x_high = std::max(x_high, at.x);
    y_low = std::min(y_low, at.y), y_high = std::max(y_high, at.y);
  });
  if (starts.empty()) return {};
  const double cell_mm = std::max({x_high - x_low, y_high - y_low, 1e-9}) / kSourceCells;
  const auto index = [&](double from_mm) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(from_mm / cell_mm), 0, kSourceCells - 1));
  };
  const auto cell = [&](const Vec3& at) { return index(at.y - y_low) * kSourceCells + index(at.x - x_low); };
  std::vector<double> lowest_mm(static_cast<std::size_t>(kSourceCells * kSourceCells), kNoBound);
  for (const Vec3& at : starts) lowest_mm[cell(at)] = std::min(lowest_mm[cell(at)], at.z);
  std::vector<HeightBounds> out;
  for (const Vec3& at : starts) {
    if (at.z > lowest_mm[cell(at)] + kDepth * cell_mm) continue;
    out.push_back({at.x, at.y, -kNoBound, std::max(at.z, given.at(at.x, at.y).z_mm + kAboveGiven_mm)});
  }
  return out;
}

}  // namespace lucerna
