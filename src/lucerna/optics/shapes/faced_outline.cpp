// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/faced_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/shapes/lens_array.h"

namespace lucerna {

namespace {

/// Points at which a face is compared with what lies below it.
constexpr int kFaceRings = 64;
constexpr int kFaceSpokes = 64;

struct FacePlace {
  double x_mm, y_mm;
};

FacePlace face_place(double r_mm, int spoke) {
  const double angle = 2.0 * std::numbers::pi * spoke / kFaceSpokes;
  return {r_mm * std::cos(angle), r_mm * std::sin(angle)};
}

void check_wall(std::span<const OutlinePoint> p) {
  if (p.size() < 3)
    throw InputError(
        fmt::format("outline below a face: found {} corners, expected at least 3: from the axis to the upper "
                    "end of a wall",
                    p.size()));
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!std::isfinite(p[i][0]) || !std::isfinite(p[i][1]) || p[i][0] < 0.0)
      throw InputError(
          fmt::format("corner {} of the outline below a face: found [{}, {}], expected a radius "
                      ">= 0 and a height",
                      i + 1, p[i][0], p[i][1]));
  }
  const OutlinePoint &low = p[p.size() - 2], &high = p.back();
  if (!(low[0] == high[0] && low[0] > 0.0 && high[1] > low[1])) {
    throw InputError(
        fmt::format("outline below a face: found its last side from [{}, {}] to [{}, {}], expected "
                    "a wall: one radius > 0, running upward",
                    low[0], low[1], high[0], high[1]));
  }
}

/// Where the outline begins: on the axis, or in the wall about a bottom face.
void check_begin(std::span<const OutlinePoint> p, bool has_bottom_face) {
  const OutlinePoint &first = p[0], &second = p[1];
  if (!has_bottom_face) {
    if (first[0] == 0.0) return;
    throw InputError(fmt::format(
        "outline below a face: found its first corner at [{}, {}], expected it on the axis, r = 0", first[0],
        first[1]));
  }
  if (p.size() > 3 && first[0] == second[0] && first[0] > 0.0 && first[0] < p.back()[0] &&
      second[1] < first[1])
    return;
  throw InputError(
      fmt::format("outline about a bottom face: found its first side from [{}, {}] to [{}, {}], expected a "
                  "wall: one radius > 0 and below that of the outer wall, running downward",
                  first[0], first[1], second[0], second[1]));
}

/// Lenslets are as low between each other all over the body, and may be smaller than the distance of places.
void check_above(const std::vector<OutlineSide>& sides, const LensArraySurface& array,
                 const HeightSurface* bottom) {
  double below = sides.back().to[1];
  for (const OutlineSide& side : sides) below = std::max({below, side.from[1], side.to[1]});
  if (bottom) {
    const double r = sides.front().from[0];
    below = std::max(below, bottom->range({-r, r, -r, r}).high_mm);
  }
  const double low = array.range({}).low_mm;
  if (low > below) return;
  throw InputError(fmt::format(
      "array: found lenslets that reach down to z = {:.6g}, expected them above the outline below, "
      "z = {:.6g}",
      low, below));
}

SurfacePoint finite_place(const HeightSurface& face, const char* name, double x, double y) {
  const SurfacePoint at = face.at(x, y);
  if (std::isfinite(at.z_mm) && std::isfinite(at.dzdx) && std::isfinite(at.dzdy)) return at;
  throw InputError(fmt::format(
      "{}: found no finite height and slope at x = {:.6g}, y = {:.6g}, expected both", name, x, y));
}

void check_height(const char* name, double z, double below, bool is_rim, double x, double y) {
  if (z > below) return;
  throw InputError(fmt::format(
      "{}: found z = {:.6g} at {}x = {:.6g}, y = {:.6g}, expected it above {}, z = {:.6g}", name, z,
      is_rim ? "its rim, " : "", x, y, is_rim ? "the wall's lower corner" : "the outline below", below));
}

/// Calls `look(ring, r, x, y)` at places over a circle.
template <class Look>
void over_circle(double radius, const Look& look) {
  for (int ring = 0; ring <= kFaceRings; ++ring) {
    const double r = radius * ring / kFaceRings;
    for (int spoke = 0; spoke < kFaceSpokes; ++spoke) {
      const auto [x, y] = face_place(r, spoke);
      look(ring, r, x, y);
    }
  }
}

/// A bottom face has nothing below it; its rim is the upper end of the inner wall.
void check_bottom(std::span<const OutlinePoint> p, const HeightSurface& face) {
  over_circle(p.front()[0], [&](int ring, double, double x, double y) {
    const double z = finite_place(face, "bottom_face", x, y).z_mm;
    if (ring == kFaceRings) check_height("bottom_face", z, p[1][1], true, x, y);
  });
}

void check_above(std::span<const OutlinePoint> p, const std::vector<OutlineSide>& sides,
                 const BodyFaces& faces) {
  if (const auto* array = dynamic_cast<const LensArraySurface*>(&faces.top))
    return check_above(sides, *array, faces.bottom);
  const double wall = p[p.size() - 2][1];
  over_circle(p.back()[0], [&](int ring, double r, double x, double y) {
    // Above the very rim there is the wall, and the base ends at its lower corner.
    const bool is_rim = ring == kFaceRings;
    double below = is_rim ? wall : base_height_mm(sides, r);
    if (faces.bottom && r <= p.front()[0]) below = std::max(below, faces.bottom->at(x, y).z_mm);
    check_height("face", finite_place(faces.top, "face", x, y).z_mm, below, is_rim, x, y);
  });
}

/// Where base and wall meet there is an edge.
void check_edge(const FacedBase& base, std::size_t corner, double smooth_below_deg) {
  const double turn = turn_deg(base.corners, corner);
  if (turn > smooth_below_deg) return;
  throw InputError(
      fmt::format("outline below a face: found a turn of {:.6g} degrees into the wall, at [{}, {}], "
                  "expected an edge: more than smooth_below_deg, {}",
                  turn, base.corners[corner][0], base.corners[corner][1], smooth_below_deg));
}

}  // namespace

void check_faced_outline(std::span<const OutlinePoint> corners_mm, const BodyFaces& faces,
                         double smooth_below_deg) {
  check_wall(corners_mm);
  check_begin(corners_mm, faces.bottom != nullptr);
  const FacedBase base = faced_base(corners_mm, smooth_below_deg);
  check_outline(base.corners);
  check_edge(base, corners_mm.size() - 2, smooth_below_deg);
  if (faces.bottom) check_edge(base, 1, smooth_below_deg);
  const double reach = outline_reach_mm(corners_mm);
  // The lid is above all of the outline, so what crosses is the outline's own curve.
  static_cast<void>(outline_sides(base.corners, smooth_below_deg, 1e-3 * reach));
  if (faces.bottom) check_bottom(corners_mm, *faces.bottom);
  check_above(corners_mm, faced_base_sides(corners_mm, smooth_below_deg, 1e-4 * reach), faces);
}

FacedBase faced_base(std::span<const OutlinePoint> corners_mm, double smooth_below_deg) {
  FacedBase out{{corners_mm.begin(), corners_mm.end()}, {}};
  double top = corners_mm.back()[1];
  for (const OutlinePoint& c : corners_mm) top = std::max(top, c[1]);
  // A spline may swing above its corners, by less than the outline's size.
  top += 2.0 * outline_reach_mm(corners_mm);
  out.corners.back()[1] = top;
  out.corners.push_back({0.0, top});
  const std::size_t first = has_inner_wall(corners_mm) ? 1 : 0, wall = corners_mm.size() - 2;
  if (first > 0) out.corners.push_back({0.0, corners_mm.front()[1]});
  for (const OutlineRun& run : outline_runs(out.corners, smooth_below_deg)) {
    if (run.from >= first && run.to <= wall) out.runs.push_back(run);
  }
  return out;
}

std::vector<OutlineSide> faced_base_sides(std::span<const OutlinePoint> corners_mm, double smooth_below_deg,
                                          double tolerance_mm) {
  const FacedBase base = faced_base(corners_mm, smooth_below_deg);
  std::vector<OutlineSide> out;
  for (const OutlineRun& run : base.runs) {
    for (const OutlinePiece<double>& piece : run_curve(base.corners, run))
      add_sides(piece, straight_pieces_of(piece, tolerance_mm), out);
  }
  return out;
}

double base_height_mm(std::span<const OutlineSide> sides, double r_mm) {
  double z = -std::numeric_limits<double>::infinity();
  for (const OutlineSide& s : sides) {
    const double low = std::min(s.from[0], s.to[0]), high = std::max(s.from[0], s.to[0]);
    if (r_mm < low || r_mm > high) continue;
    const double share = high > low ? (r_mm - s.from[0]) / (s.to[0] - s.from[0]) : 0.0;
    const double here = s.from[1] + share * (s.to[1] - s.from[1]);
    z = std::max(z, high > low ? here : std::max(s.from[1], s.to[1]));
  }
  return z;
}

namespace {

double face_reach_mm(const HeightSurface& face, double radius_mm) {
  double reach = std::abs(face.at(0.0, 0.0).z_mm);
  for (int spoke = 0; spoke < kFaceSpokes; ++spoke) {
    const auto [x, y] = face_place(radius_mm, spoke);
    reach = std::max(reach, std::hypot(radius_mm, face.at(x, y).z_mm));
  }
  return reach;
}

}  // namespace

double faced_reach_mm(std::span<const OutlinePoint> corners_mm, const BodyFaces& faces) {
  // The upper ends of walls are where the faces' rims are.
  const std::size_t first = has_inner_wall(corners_mm) ? 1 : 0;
  const double base = outline_reach_mm(corners_mm.subspan(first, corners_mm.size() - 1 - first));
  const double bottom = faces.bottom ? face_reach_mm(*faces.bottom, corners_mm.front()[0]) : 0.0;
  return std::max({base, face_reach_mm(faces.top, corners_mm.back()[0]), bottom});
}

}  // namespace lucerna
