// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/height_field/height_field.h"

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "lucerna/core/cpu/huge_pages.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// Adini's piece on the unit square from height and gradient times cell size at its corners: value and
/// derivatives.
struct AdiniCorners {
  double z00, z10, z01, z11, p00, p10, p01, p11, q00, q10, q01, q11;
};

struct Bend {
  double value, slope;
};

/// The cubic u (1 - u) [(1 - u) a - u b]: zero at both ends, with slopes a and b there.
Bend bend(double u, double a, double b) {
  const double w = 1.0 - u;
  return {u * w * (w * a - u * b), w * (1.0 - 3.0 * u) * a - u * (2.0 - 3.0 * u) * b};
}

SurfacePoint adini(const AdiniCorners& k, double u, double v) {
  const double south = k.z10 - k.z00, north = k.z11 - k.z01, west = k.z01 - k.z00, east = k.z11 - k.z10;
  const Bend s = bend(u, k.p00 - south, k.p10 - south), n = bend(u, k.p01 - north, k.p11 - north);
  const Bend w = bend(v, k.q00 - west, k.q01 - west), e = bend(v, k.q10 - east, k.q11 - east);
  const double um = 1.0 - u, vm = 1.0 - v;
  return {vm * (k.z00 + u * south + s.value) + v * (k.z01 + u * north + n.value) + um * w.value + u * e.value,
          vm * (south + s.slope) + v * (north + n.slope) - w.value + e.value,
          um * (west + w.slope) + u * (east + e.slope) - s.value + n.value};
}

}  // namespace

HeightField::HeightField(const Reflector& reflector, int cells)
    : aperture_(reflector.aperture), cells_(cells), region_(reflector.aperture.bounds()) {
  LUCERNA_CHECK(cells >= kBlock && cells <= 8192 && std::has_single_bit(static_cast<unsigned>(cells)),
                "cells = {}", cells);
  step_x_mm_ = static_cast<float>((region_.x1_mm - region_.x0_mm) / cells);
  step_y_mm_ = static_cast<float>((region_.y1_mm - region_.y0_mm) / cells);
  const auto blocks = static_cast<std::size_t>(cells / kBlock);
  std::size_t size = 0;
  for (std::size_t n = blocks; n > 0; n /= 2) {
    offsets_.push_back(static_cast<std::int32_t>(size));
    size += n * n;
  }
  nodes_.resize(size);
  leaf_kinds_.resize(blocks * blocks);
  const double bx = static_cast<double>(step_x_mm_) * kBlock, by = static_cast<double>(step_y_mm_) * kBlock;
  for (std::size_t iy = 0; iy < blocks; ++iy) {
    for (std::size_t ix = 0; ix < blocks; ++ix) {
      const double x = region_.x0_mm + bx * static_cast<double>(ix),
                   y = region_.y0_mm + by * static_cast<double>(iy);
      const Rectangle square{x, x + bx, y, y + by};
      leaf_kinds_[iy * blocks + ix] = !aperture_.misses(square)                 ? LeafKind::mirror
                                      : radius_range(square).min_mm <= rim_mm() ? LeafKind::bare
                                                                                : LeafKind::beyond;
    }
  }
  fit_quadric(*reflector.surface);
  sample(*reflector.surface);
  rebuild();
}

void HeightField::fit_quadric(const HeightSurface& surface) {
  constexpr int kSide = 65;  // points a side: many for six numbers
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  const double half = std::max(aperture_.half_x_mm(), aperture_.half_y_mm());
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const double x = aperture_.half_x_mm() * (2.0 * i / (kSide - 1) - 1.0);
      const double y = aperture_.half_y_mm() * (2.0 * j / (kSide - 1) - 1.0);
      if (!aperture_.contains(x, y)) continue;
      const double u = x / half, v = y / half;
      Eigen::Matrix<double, 6, 1> row;
      row << 1.0, u, v, u * u, u * v, v * v;
      normal += row * row.transpose();
      right += surface.at(x, y).z_mm * row;
    }
  }
  const Eigen::Matrix<double, 6, 1> k = normal.completeOrthogonalDecomposition().solve(right);
  quadric_ = {static_cast<float>(k[0]),
              static_cast<float>(k[1] / half),
              static_cast<float>(k[2] / half),
              static_cast<float>(k[3] / (half * half)),
              static_cast<float>(k[4] / (half * half)),
              static_cast<float>(k[5] / (half * half))};
}

void HeightField::sample(const HeightSurface& surface) {
  const auto n = static_cast<std::size_t>(cells_) + 1;
  vertices_.reserve(n * n);
  advise_huge_pages(vertices_.data(), n * n * sizeof(FieldVertex));
  vertices_.resize(n * n);
  parallel_blocks(n, 8, [&](std::size_t first, std::size_t last) {
    for (std::size_t iy = first; iy < last; ++iy) {
      for (std::size_t ix = 0; ix < n; ++ix) {
        const double x = region_.x0_mm + static_cast<double>(ix) * static_cast<double>(step_x_mm_);
        const double y = region_.y0_mm + static_cast<double>(iy) * static_cast<double>(step_y_mm_);
        const SurfacePoint s = surface.at(x, y), q = quadric_.at(x, y);
        vertices_[iy * n + ix] = {static_cast<float>(s.z_mm - q.z_mm), static_cast<float>(s.dzdx - q.dzdx),
                                  static_cast<float>(s.dzdy - q.dzdy)};
      }
    }
  });
}

void HeightField::rebuild() {
  const auto blocks = static_cast<std::size_t>(cells_ / kBlock);
  std::vector<float> gradient_bound(blocks, 0.0F);  // by row of squares
  parallel_blocks(blocks, 4, [&](std::size_t first, std::size_t last) {
    for (std::size_t by = first; by < last; ++by) {
      for (std::size_t bx = 0; bx < blocks; ++bx) {
        const std::size_t i = by * blocks + bx;
        nodes_[i] = FieldNode{};
        if (leaf_kinds_[i] == LeafKind::beyond) continue;
        const FieldLeaf leaf = field_leaf(vertices_.data(), cells_, step_x_mm_, step_y_mm_, bx, by);
        if (leaf_kinds_[i] == LeafKind::mirror) nodes_[i] = leaf.slab;
        gradient_bound[by] = std::max(gradient_bound[by], leaf.gradient_bound);
      }
    }
  });
  gradient_bound_ = *std::max_element(gradient_bound.begin(), gradient_bound.end());
  for (std::size_t level = 1; level < offsets_.size(); ++level) {
    const std::size_t n = blocks >> level;
    FieldNode* const out = &nodes_[static_cast<std::size_t>(offsets_[level])];
    const FieldNode* const below = &nodes_[static_cast<std::size_t>(offsets_[level - 1])];
    for (std::size_t i = 0; i < n * n; ++i) {
      out[i] = field_parent(below, 2 * n, step_x_mm_, step_y_mm_, static_cast<int>(level), i % n, i / n);
    }
  }
  band_ = {std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (std::size_t i = 0; i < blocks * blocks; ++i) {
    const FieldNode& node = nodes_[i];
    if (node.e < 0.0F) continue;
    const double reach = static_cast<double>(field_reach(node, step_x_mm_, step_y_mm_));
    band_.low_mm = std::min(band_.low_mm, static_cast<double>(node.a) - reach);
    band_.high_mm = std::max(band_.high_mm, static_cast<double>(node.a) + reach);
  }
}

SurfacePoint HeightField::at(double x_mm, double y_mm) const {
  const double hx = static_cast<double>(step_x_mm_), hy = static_cast<double>(step_y_mm_);
  const double gx = std::clamp((x_mm - region_.x0_mm) / hx, 0.0, static_cast<double>(cells_));
  const double gy = std::clamp((y_mm - region_.y0_mm) / hy, 0.0, static_cast<double>(cells_));
  const auto ix = std::min(static_cast<std::size_t>(gx), static_cast<std::size_t>(cells_) - 1);
  const auto iy = std::min(static_cast<std::size_t>(gy), static_cast<std::size_t>(cells_) - 1);
  const std::size_t n = static_cast<std::size_t>(cells_) + 1;
  const FieldVertex *const a = &vertices_[iy * n + ix], *const b = a + n;
  const auto z = [](const FieldVertex& v) { return static_cast<double>(v.z_mm); };
  const auto p = [hx](const FieldVertex& v) { return static_cast<double>(v.dzdx) * hx; };
  const auto q = [hy](const FieldVertex& v) { return static_cast<double>(v.dzdy) * hy; };
  const AdiniCorners k{z(a[0]), z(a[1]), z(b[0]), z(b[1]), p(a[0]), p(a[1]),
                       p(b[0]), p(b[1]), q(a[0]), q(a[1]), q(b[0]), q(b[1])};
  const SurfacePoint r = adini(k, gx - static_cast<double>(ix), gy - static_cast<double>(iy));
  const SurfacePoint base = quadric_.at(x_mm, y_mm);
  return {base.z_mm + r.z_mm, base.dzdx + r.dzdx / hx, base.dzdy + r.dzdy / hy};
}

}  // namespace lucerna
