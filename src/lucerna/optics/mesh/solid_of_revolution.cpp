// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/mesh.h"
#include "lucerna/optics/shapes/outline.h"

namespace lucerna {

namespace {

using Corner = OutlinePoint;

/// Longest piece of a side over the width of its triangles, and most pieces: trees of boxes are slow on
/// slivers.
constexpr double kMaxAspect = 8.0;
constexpr int kMaxPieces = 64;
/// Where sides turn by more than this the outline has an edge. `corner_normals` may smooth what turns less:
/// the middle of such a side has no normal of its own and gets no corner.
constexpr double kEdgeDeg = 60.0;

/// True for a side that stays flat however its neighbours are smoothed.
bool is_flat(const std::vector<Corner>& p, std::size_t i) {
  const std::size_t next = (i + 1) % p.size();
  const auto ends = [&](std::size_t k) {
    const double turn = turn_deg(p, k);
    return turn > kEdgeDeg || (p[k][0] == 0.0 && turn == 0.0);
  };
  return ends(i) && ends(next);
}

/// The same outline with long flat sides divided.
std::vector<Corner> divided(const std::vector<Corner>& outline, int segments) {
  std::vector<Corner> out;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Corner &a = outline[i], &b = outline[(i + 1) % outline.size()];
    out.push_back(a);
    const double width = 2.0 * std::numbers::pi * std::max(a[0], b[0]) / segments;
    if (width == 0.0 || !is_flat(outline, i)) continue;
    const double piece = std::hypot(b[0] - a[0], b[1] - a[1]) / (kMaxAspect * width);
    const int pieces = static_cast<int>(std::min<double>(kMaxPieces, std::ceil(piece)));
    for (int k = 1; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      out.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
    }
  }
  return out;
}

/// The mesh while it grows: corners and their vertices about the axis.
class Turned {
 public:
  Turned(const std::vector<Corner>& outline, int segments) : segments_(static_cast<std::uint32_t>(segments)) {
    for (const Corner& c : outline) {
      first_.push_back(static_cast<std::uint32_t>(mesh.vertices_mm.size()));
      on_axis_.push_back(c[0] == 0.0);
      for (std::uint32_t s = 0; s < (c[0] == 0.0 ? 1 : segments_); ++s) {
        const double angle = 2.0 * std::numbers::pi * s / segments;
        mesh.vertices_mm.push_back({c[0] * std::cos(angle), c[0] * std::sin(angle), c[1]});
      }
    }
    for (std::size_t i = 0; i < outline.size(); ++i) add_band(i, (i + 1) % outline.size());
  }

  Mesh mesh;

 private:
  std::uint32_t vertex(std::size_t corner, std::uint32_t s) const {
    return first_[corner] + (on_axis_[corner] ? 0 : s % segments_);
  }

  void add_band(std::size_t a, std::size_t b) {
    for (std::uint32_t s = 0; s < segments_; ++s) {
      if (!on_axis_[a]) mesh.triangles.push_back({vertex(a, s), vertex(a, s + 1), vertex(b, s)});
      if (!on_axis_[b]) mesh.triangles.push_back({vertex(a, s + 1), vertex(b, s + 1), vertex(b, s)});
    }
  }

  std::uint32_t segments_;
  std::vector<std::uint32_t> first_;
  std::vector<bool> on_axis_;
};

}  // namespace

Mesh solid_of_revolution(std::span<const Corner> outline_mm, int segments) {
  check_outline(outline_mm);
  if (segments < 3)
    throw InputError(fmt::format("{} segments about the axis, expected at least 3", segments));
  const std::vector<Corner> outline = counter_clockwise(outline_mm);
  return std::move(Turned(divided(outline, segments), segments).mesh);
}

}  // namespace lucerna
