// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/triangle_bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

struct Box {
  std::array<float, 3> low, high;
  Box() {
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
  }
  void add(const float* p) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], p[i]);
      high[i] = std::max(high[i], p[i]);
    }
  }
  void add(const Box& b) {
    add(b.low.data());
    add(b.high.data());
  }
  /// Half of its surface; 0 if nothing was added.
  double area() const {
    double side[3];
    for (std::size_t i = 0; i < 3; ++i) {
      side[i] = std::max(0.0, static_cast<double>(high[i]) - static_cast<double>(low[i]));
    }
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
  }
};

Box box_of(const TreeTriangle& k) {
  Box b;
  for (const auto& corner : k.corner) b.add(corner);
  return b;
}

std::array<float, 3> middle(const TreeTriangle& k) {
  const Box b = box_of(k);
  std::array<float, 3> m;
  for (std::size_t i = 0; i < 3; ++i) m[i] = 0.5F * b.low[i] + 0.5F * b.high[i];
  return m;
}

/// Makes the nodes over a list of triangles, which it sorts.
class Builder {
 public:
  Builder(std::vector<TreeTriangle>& triangles, std::vector<TriangleNode>& nodes)
      : triangles_(triangles), nodes_(nodes) {
    Box all;
    for (const TreeTriangle& k : triangles) all.add(box_of(k));
    float max = 0.0F;
    for (std::size_t i = 0; i < 3; ++i) max = std::max({max, std::fabs(all.low[i]), std::fabs(all.high[i])});
    margin_ = 0x1p-21F * max;
    nodes.reserve(triangles.size());
    build(0, triangles.size());
  }

 private:
  static constexpr std::size_t kMaxInLeaf = 4, kBins = 16;
  static_assert(kMaxInLeaf < kLeafCounts);

  void build(std::size_t first, std::size_t last) {
    Box box, middles;
    for (std::size_t i = first; i < last; ++i) {
      box.add(box_of(triangles_[i]));
      middles.add(middle(triangles_[i]).data());
    }
    const std::size_t node = nodes_.size();
    nodes_.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      nodes_[node].low[i] = box.low[i] - margin_;
      nodes_[node].high[i] = box.high[i] + margin_;
    }
    if (last - first <= kMaxInLeaf) {
      nodes_[node].leaf = static_cast<std::uint32_t>(first * kLeafCounts + (last - first));
    } else {
      nodes_[node].leaf = 0;
      const std::size_t cut = split(first, last, middles);
      build(first, cut);
      build(cut, last);
    }
    nodes_[node].skip = static_cast<std::int32_t>(nodes_.size());
  }

  /// Sorts the triangles into two parts and returns where the second begins; neither is empty.
  std::size_t split(std::size_t first, std::size_t last, const Box& middles) {
    const auto at = [this](std::size_t i) { return triangles_.begin() + static_cast<std::ptrdiff_t>(i); };
    double best_cost = std::numeric_limits<double>::infinity();
    std::size_t axis = 0, border = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      if (!(middles.low[a] < middles.high[a])) continue;
      std::array<Box, kBins> boxes;
      std::array<std::size_t, kBins> counts{};
      for (std::size_t i = first; i < last; ++i) {
        const std::size_t b = bin(triangles_[i], a, middles);
        boxes[b].add(box_of(triangles_[i]));
        ++counts[b];
      }
      std::array<double, kBins> above{};  // cost of what is in bin b and above
      Box upper;
      std::size_t n = 0;
      for (std::size_t b = kBins - 1; b > 0; --b) {
        upper.add(boxes[b]);
        n += counts[b];
        above[b] = upper.area() * static_cast<double>(n);
      }
      Box lower;
      n = 0;
      for (std::size_t b = 1; b < kBins; ++b) {
        lower.add(boxes[b - 1]);
        n += counts[b - 1];
        const double cost = lower.area() * static_cast<double>(n) + above[b];
        if (n == 0 || n == last - first || !(cost < best_cost)) continue;
        best_cost = cost;
        axis = a;
        border = b;
      }
    }
    if (border == 0) return first + (last - first) / 2;  // all have one middle
    const auto cut = std::partition(at(first), at(last),
                                    [&](const TreeTriangle& k) { return bin(k, axis, middles) < border; });
    return static_cast<std::size_t>(cut - triangles_.begin());
  }

  static std::size_t bin(const TreeTriangle& k, std::size_t axis, const Box& middles) {
    const double low = static_cast<double>(middles.low[axis]), high = static_cast<double>(middles.high[axis]);
    const double share = (static_cast<double>(middle(k)[axis]) - low) / (high - low);
    return std::min(static_cast<std::size_t>(share * static_cast<double>(kBins)), kBins - 1);
  }

  std::vector<TreeTriangle>& triangles_;
  std::vector<TriangleNode>& nodes_;
  float margin_ = 0.0F;
};

}  // namespace

TriangleBvh::TriangleBvh(const std::vector<Body>& bodies, bool returning) {
  std::size_t count = 0;
  for (const Body& body : bodies) {
    check(body);
    if (returning || !body.only_returning_light) count += body.mesh->triangles.size();
  }
  if (count > kMaxTriangles) {
    throw InputError(fmt::format("the bodies have {} triangles, expected at most {}", count, kMaxTriangles));
  }
  triangles_.reserve(count);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!returning && bodies[b].only_returning_light) continue;
    const Mesh& mesh = *bodies[b].mesh;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      TreeTriangle k{};
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3 p = bodies[b].world_from_body.point(mesh.vertices_mm[mesh.triangles[i][c]]);
        k.corner[c][0] = static_cast<float>(p.x);
        k.corner[c][1] = static_cast<float>(p.y);
        k.corner[c][2] = static_cast<float>(p.z);
      }
      k.body = static_cast<std::uint32_t>(b);
      k.number = static_cast<std::uint32_t>(i);
      triangles_.push_back(k);
    }
  }
  if (!triangles_.empty()) Builder(triangles_, nodes_);
}

}  // namespace lucerna
