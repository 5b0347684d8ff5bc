// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/mesh.h"

namespace lucerna {

namespace {

using Corner = std::array<double, 2>;  // r, z

/// Twice the area of a polygon; above 0 where it runs counter-clockwise with z up and r to the right.
double signed_area(const std::vector<Corner>& p) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Corner &a = p[i], &b = p[(i + 1) % p.size()];
    sum += a[0] * b[1] - b[0] * a[1];
  }
  return sum;
}

/// On which side of the line from a to b c lies.
double side(const Corner& a, const Corner& b, const Corner& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool cross_each_other(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  return side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
}

void check_outline(const std::vector<Corner>& p, int segments) {
  if (p.size() < 3) throw InputError(fmt::format("outline of {} corners, expected at least 3", p.size()));
  if (segments < 3)
    throw InputError(fmt::format("{} segments about the axis, expected at least 3", segments));
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(p[i][0]) || !std::isfinite(p[i][1]) || p[i][0] < 0.0) {
      throw InputError(
          fmt::format("corner {} of the outline is [{}, {}], expected a radius >= 0 and a height", i + 1,
                      p[i][0], p[i][1]));
    }
    if (p[i] == p[(i + 1) % n])
      throw InputError(fmt::format("corners {} and {} of the outline are equal", i + 1, (i + 1) % n + 1));
    for (std::size_t k = i + 2; k < n; ++k) {
      if (cross_each_other(p[i], p[i + 1], p[k], p[(k + 1) % n])) {
        throw InputError(fmt::format(
            "the outline crosses itself between corners {} and {} and after corner {}", i + 1, i + 2, k + 1));
      }
    }
  }
  if (signed_area(p) == 0.0) throw InputError("the outline has no area");
}

/// Longest piece of a side over the width of its triangles, and most pieces: trees of boxes are slow on
/// slivers.
constexpr double kMaxAspect = 8.0;
constexpr int kMaxPieces = 64;
/// Where sides turn by more than this the outline has an edge. `corner_normals` may smooth what turns less:
/// the middle of such a side has no normal of its own and gets no corner.
constexpr double kEdgeDeg = 60.0;

/// How far the outline turns at a corner; on the axis it goes on as its mirror image.
double turn_deg(const std::vector<Corner>& p, std::size_t i) {
  const Corner &before = p[(i + p.size() - 1) % p.size()], &at = p[i], &after = p[(i + 1) % p.size()];
  if (at[0] == 0.0) {
    const Corner& side = before[0] > 0.0 ? before : after;
    return 2.0 * degrees(std::atan2(std::abs(side[1] - at[1]), side[0]));
  }
  const double in = std::atan2(at[1] - before[1], at[0] - before[0]);
  const double out = std::atan2(after[1] - at[1], after[0] - at[0]);
  return std::abs(degrees(std::remainder(out - in, 2.0 * std::numbers::pi)));
}

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
  std::vector<Corner> outline(outline_mm.begin(), outline_mm.end());
  check_outline(outline, segments);
  if (signed_area(outline) < 0.0) std::reverse(outline.begin(), outline.end());
  return std::move(Turned(divided(outline, segments), segments).mesh);
}

}  // namespace lucerna
