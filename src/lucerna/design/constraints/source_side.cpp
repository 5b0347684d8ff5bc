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
constexpr std::size_t kSourceCells = 24;
constexpr double kDepth = 2.0;
/// How many cells a surface may be higher within one than its height and slope at the middle tell.
constexpr double kBend = 0.5;
/// A point source's mirror that has passed more of the source is none for it.
constexpr double kMostStartsBehind = 0.02;
/// Walls cost from 0.04 mm below them on; the given mirror costs nothing.
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

/// Square cells over places, along both sides.
class SquareCells {
 public:
  SquareCells(const std::vector<Vec3>& places, std::size_t count) : count_(count) {
    double x_high = -kNoBound, y_high = -kNoBound;
    for (const Vec3& p : places) {
      x_low_ = std::min(x_low_, p.x), x_high = std::max(x_high, p.x);
      y_low_ = std::min(y_low_, p.y), y_high = std::max(y_high, p.y);
    }
    edge_mm_ = std::max({x_high - x_low_, y_high - y_low_, 1e-9}) / static_cast<double>(count);
  }
  std::size_t size() const { return count_ * count_; }
  double edge_mm() const { return edge_mm_; }
  std::size_t of(double x, double y) const { return index(y - y_low_) * count_ + index(x - x_low_); }
  double x_mm(std::size_t cell) const {
    return x_low_ + edge_mm_ * (0.5 + static_cast<double>(cell % count_));
  }
  double y_mm(std::size_t cell) const {
    return y_low_ + edge_mm_ * (0.5 + static_cast<double>(cell / count_));
  }

 private:
  std::size_t index(double from_mm) const {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(from_mm / edge_mm_), 0, static_cast<int>(count_) - 1));
  }
  std::size_t count_;
  double x_low_ = kNoBound, y_low_ = kNoBound, edge_mm_ = 0.0;
};

/// The starts that a mirror which rises passes first.
std::vector<HeightBounds> heights_below_source(const DesignShape& given, const DesignRays& rays) {
  std::vector<Vec3> starts;
  for_each_start(given.aperture(), rays, [&](const Vec3& at, double) {
    if (given.at(at.x, at.y).z_mm < at.z) starts.push_back(at);
  });
  if (starts.empty()) return {};
  const SquareCells cells(starts, kSourceCells);
  std::vector<double> lowest_mm(cells.size(), kNoBound);
  for (const Vec3& at : starts) {
    double& low = lowest_mm[cells.of(at.x, at.y)];
    low = std::min(low, at.z);
  }
  std::vector<HeightBounds> out;
  for (const Vec3& at : starts) {
    if (at.z > lowest_mm[cells.of(at.x, at.y)] + kDepth * cells.edge_mm()) continue;
    out.push_back({at.x, at.y, -kNoBound, std::max(at.z, given.at(at.x, at.y).z_mm + kAboveGiven_mm)});
  }
  return out;
}

}  // namespace

double share_behind(const DesignShape& shape, const DesignRays& rays) {
  double behind = 0.0;
  const double all = for_each_start(shape.aperture(), rays, [&](const Vec3& at, double weight) {
    if (at.z < shape.at(at.x, at.y).z_mm) behind += weight;
  });
  return behind / all;
}

SourceSide::SourceSide(const DesignShape& given, const DesignRays& rays)
    : rays_(rays),
      given_behind_(share_behind(given, rays)),
      bounds_(heights_below_source(given, rays)),
      walls_({}, given, bounds_) {
  std::vector<Vec3> places;
  for (const HeightBounds& b : bounds_) places.push_back({b.x_mm, b.y_mm, b.high_mm});
  if (places.empty()) return;
  const SquareCells cells(places, kSourceCells);
  cell_mm_ = cells.edge_mm();
  std::vector<double> low_mm(cells.size(), kNoBound);
  for (const Vec3& p : places) low_mm[cells.of(p.x, p.y)] = std::min(low_mm[cells.of(p.x, p.y)], p.z);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (low_mm[i] < kNoBound) cells_.push_back({cells.x_mm(i), cells.y_mm(i), low_mm[i]});
  }
}

bool SourceSide::is_near(const DesignShape& shape) const {
  return std::ranges::any_of(cells_, [&](const Cell& c) {
    const SurfacePoint s = shape.at(c.x_mm, c.y_mm);
    return s.z_mm + cell_mm_ * (kBend + std::abs(s.dzdx) + std::abs(s.dzdy)) > c.low_mm;
  });
}

double SourceSide::cost(const DesignShape& shape, ResidualRows* rows) const {
  if (!is_near(shape)) return 0.0;
  const double past = std::max(0.0, share_behind(shape, rays_) - given_behind_) / kMaxBehind;
  return walls_.cost(shape, rows) + past * past;
}

std::optional<DesignShape> SourceSide::within(const DesignShape& shape) const {
  if (share_behind(shape, rays_) > given_behind_ + kMostStartsBehind) return std::nullopt;
  return walls_.held_nearby(shape);
}

}  // namespace lucerna
