// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/entry_face.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/design/lens/free_face.h"

namespace lucerna {

namespace {

/// A cavity leaves so much of the base's radius, and of the height above it.
constexpr double kMaxRadiusShare = 0.95, kMaxDepthShare = 0.8;
/// Between a cavity and a face that is lifted for it, over the wall's radius.
constexpr double kGap = 0.05;
/// Points of the free face that are lifted, at least.
constexpr std::size_t kFacePoints = 24;
/// Corners of a cavity turn by this share of what is an edge, and are no more than so many.
constexpr double kTurnShare = 0.5;
constexpr int kMinPieces = 8, kMaxPieces = 64;

/// An outline in its parts, in order: from the axis along the entry, the base and the wall to the free face
/// and the axis again.
struct LensParts {
  /// Of `below`: the corner that ends the entry.
  std::size_t entry_end = 0;
  /// Corners, and points of the free face.
  std::vector<OutlinePoint> below, face;
  double base_mm() const { return below[entry_end][1]; }
  double wall_radius_mm() const { return below.back()[0]; }
  /// Of the plane of the base, as far as it goes.
  double base_radius_mm() const {
    const OutlinePoint &end = below[entry_end], &next = below[entry_end + 1];
    return next[1] == end[1] ? std::max(end[0], next[0]) : end[0];
  }
};

/// Of a curve in its order, its corners among them.
std::vector<OutlinePoint> points_of(const std::vector<OutlinePiece<double>>& curve) {
  const std::size_t each = (kFacePoints + curve.size() - 1) / curve.size();
  std::vector<OutlinePoint> out;
  for (const OutlinePiece<double>& piece : curve) {
    for (std::size_t k = 0; k < each; ++k)
      out.push_back(curve_point(piece, static_cast<double>(k) / static_cast<double>(each)).at);
  }
  out.push_back(curve.back().to);
  return out;
}

LensParts parts_of(const LensShape& lens) {
  const LensForm& form = lens.form();
  LensParts out{0, face_seat(lens).below_mm, {}};
  const auto corner = [&](std::size_t i) { return lens.corners()[corner_number(form, i)]; };
  for (const LensFace& face : form.faces) {
    if (face.is_free) {
      out.face = points_of(run_curve(lens.corners(), face.run));
    } else if (corner(face.run.from) == out.below.front()) {
      out.entry_end = face.run.to - face.run.from;
    }
  }
  const bool ends_below = out.entry_end > 0 && out.entry_end + 1 < out.below.size();
  if (!ends_below)
    throw InputError(
        "the face opposite to the free form: expected one from the axis to the base or the wall");
  return out;
}

double cavity_height_mm(const Cavity& c, double r_mm) {
  const double x = c.radius_mm > 0.0 ? r_mm / c.radius_mm : 1.0;
  return x < 1.0 ? c.depth_mm * std::sqrt(1.0 - x * x) : 0.0;
}

/// From the axis to the rim, at equal turns of the tangent.
std::vector<OutlinePoint> cavity_corners(const Cavity& c, double base_mm, double smooth_below_deg) {
  if (!(c.depth_mm > 0.0)) return {{0.0, base_mm}};
  const int n =
      std::clamp(static_cast<int>(std::ceil(90.0 / (kTurnShare * smooth_below_deg))), kMinPieces, kMaxPieces);
  std::vector<OutlinePoint> out;
  for (int i = 0; i < n; ++i) {
    const double turn = 0.5 * std::numbers::pi * i / n;
    const double along = std::atan2(c.radius_mm * std::sin(turn), c.depth_mm * std::cos(turn));
    out.push_back({c.radius_mm * std::sin(along), base_mm + c.depth_mm * std::cos(along)});
  }
  out.push_back({c.radius_mm, base_mm});
  return out;
}

/// By how much of a paraboloid a face has to be lifted to clear a cavity.
double lift_mm(const LensParts& parts, const Cavity& c) {
  const double radius = parts.wall_radius_mm();
  double lift = 0.0;
  for (const OutlinePoint& p : parts.face) {
    const double x = p[0] / radius, room = 1.0 - x * x;
    if (!(room > 0.0)) continue;
    const double least = parts.base_mm() + cavity_height_mm(c, p[0]) + kGap * radius * room;
    lift = std::max(lift, (least - p[1]) / room);
  }
  return lift;
}

}  // namespace

CavityRange cavity_range(const LensShape& lens, const LensLimits& limits) {
  const LensParts parts = parts_of(lens);
  double lowest = parts.base_mm(), highest = parts.base_mm();
  for (const OutlinePoint& p : lens.corners()) {
    lowest = std::min(lowest, p[1]);
    highest = std::max(highest, p[1]);
  }
  const double room = limits.max_height_mm ? lowest + *limits.max_height_mm - parts.base_mm()
                                           : std::max(highest - parts.base_mm(), parts.wall_radius_mm());
  return {kMaxRadiusShare * parts.base_radius_mm(), kMaxDepthShare * room};
}

LensShape with_cavity(const LensShape& lens, const Cavity& cavity) {
  const LensParts parts = parts_of(lens);
  std::vector<OutlinePoint> corners = cavity_corners(cavity, parts.base_mm(), lens.smooth_below_deg());
  const double rim = corners.back()[0];
  for (std::size_t i = parts.entry_end; i < parts.below.size(); ++i) {
    if (parts.below[i][0] > rim) corners.push_back(parts.below[i]);
  }
  const std::size_t free_side = corners.size() - 1;
  const double lift = lift_mm(parts, cavity), radius = parts.wall_radius_mm();
  for (std::size_t i = 1; i < parts.face.size(); ++i) {
    const double x = parts.face[i][0] / radius;
    corners.push_back({parts.face[i][0], parts.face[i][1] + lift * (1.0 - x * x)});
  }
  return {corners, lens.smooth_below_deg(), std::vector<std::size_t>{free_side}, 0};
}

}  // namespace lucerna
