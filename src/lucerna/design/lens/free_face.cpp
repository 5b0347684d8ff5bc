// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/free_face.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/lens/entry_face.h"
#include "lucerna/design/lens/lens_path.h"
#include "lucerna/optics/shapes/faced_outline.h"

namespace lucerna {

namespace {

/// Points of a curve that stand for it.
constexpr int kCurveSamples = 256;
/// A wall is parallel to the axis but for so much of its length.
constexpr double kUpright = 1e-9;

std::size_t free_face_of(const LensForm& form) {
  const std::vector<std::size_t> free = form.free_faces();
  if (free.size() != 1)
    throw InputError(fmt::format("found {} free faces, expected one for a free form", free.size()));
  return free.front();
}

const OutlinePoint& corner(const LensForm& form, std::size_t i) {
  return form.corners[corner_number(form, i)];
}

/// A run as points, in the order of the outline.
std::vector<OutlinePoint> sampled(const LensForm& form, const OutlineRun& run) {
  std::vector<OutlinePoint> out;
  for (const OutlinePiece<double>& piece : run_curve(form.corners, run)) {
    for (int k = 0; k < kCurveSamples; ++k)
      out.push_back(curve_point(piece, static_cast<double>(k) / kCurveSamples).at);
  }
  out.push_back(corner(form, run.to));
  return out;
}

/// Height at r between points of falling r.
double height_at(const std::vector<OutlinePoint>& points, double r) {
  const auto after =
      std::find_if(points.begin() + 1, points.end() - 1, [&](const OutlinePoint& p) { return p[0] <= r; });
  const OutlinePoint &a = *(after - 1), &b = *after;
  const double share = a[0] == b[0] ? 0.0 : (a[0] - r) / (a[0] - b[0]);
  return a[1] + share * (b[1] - a[1]);
}

}  // namespace

Frame lens_from_design() { return Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 0}); }

double FaceSeat::lowest_mm() const {
  double out = below_mm.front()[1];
  for (const OutlinePoint& p : below_mm) out = std::min(out, p[1]);
  return out;
}

double FaceSeat::height_mm(double x_mm, double y_mm) const {
  const double r = std::hypot(x_mm, y_mm);
  if (bottom && r <= below_mm.front()[0]) return -bottom->at(x_mm, y_mm).z_mm;
  return base_height_mm(base, std::min(r, radius_mm()));
}

FaceSeat seat_of(const ShapedLens& lens) {
  return lens.entry ? seat_over(lens.outline, *lens.entry) : face_seat(lens.outline);
}

FaceSeat face_seat(const LensShape& lens) {
  const LensForm& form = lens.form();
  const OutlineRun& run = form.faces[free_face_of(form)].run;
  const std::size_t n = form.corners.size();
  const OutlinePoint &foot = corner(form, run.from + n - 1), &top = corner(form, run.from),
                     &end = corner(form, run.to);
  const bool upright = std::abs(top[0] - foot[0]) <= kUpright * (top[1] - foot[1]);
  if (!upright || end[0] != 0.0) {
    throw InputError(
        fmt::format("the free face leads from ({}, {}) to ({}, {}): expected one from the upper end of a "
                    "wall parallel to the axis to the axis",
                    top[0], top[1], end[0], end[1]));
  }
  FaceSeat seat;
  for (std::size_t i = run.to + 1; corner_number(form, i) != corner_number(form, run.from); ++i)
    seat.below_mm.push_back(corner(form, i));
  seat.below_mm.push_back(top);
  if (seat.below_mm.front()[0] != 0.0)
    throw InputError(fmt::format("the outline below the free face begins at r = {}, expected the axis",
                                 seat.below_mm.front()[0]));
  seat.base = faced_base_sides(seat.below_mm, lens.smooth_below_deg(), kBaseTolerance_mm);
  return seat;
}

DesignShape face_of(const LensShape& lens, int intervals, ShapeSymmetry symmetry) {
  const FaceSeat seat = face_seat(lens);
  const std::vector<OutlinePoint> points =
      sampled(lens.form(), lens.form().faces[free_face_of(lens.form())].run);
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i][0] < points[i - 1][0]) continue;
    throw InputError(fmt::format("the free face turns back at r = {}, expected one height over every place",
                                 points[i][0]));
  }
  const double radius = seat.radius_mm(), sag = points.back()[1] - points.front()[1];
  // The base only has to be of the face's size.
  const double focal = radius * radius / (4.0 * std::max(std::abs(sag), 0.1 * radius));
  return DesignShape::bspline(focal, Aperture::circle(2.0 * radius), intervals, intervals, symmetry)
      .through([&](double x, double y) { return -height_at(points, std::hypot(x, y)); });
}

DesignRays::Pass into_lens(const LensShape& lens, const MediumView& medium) {
  const auto curves = std::make_shared<const LensCurves>(lens);
  const auto tracer = std::make_shared<const LensTracer>(*curves, medium);
  const auto is_free = std::make_shared<std::vector<bool>>();
  for (const LensPiece& piece : curves->pieces()) is_free->push_back(piece.first_number >= 0);
  return [curves, tracer, is_free](Ray& ray) {
    const Frame frame = lens_from_design();
    const Ray in_lens = frame.ray(ray);
    thread_local LensPath path;
    tracer->follow(in_lens.origin_mm, in_lens.direction.vec(), kNoGhost, path);
    if (path.hits == 0) return 0.0;
    const LensHit& entry = path.hit[0];
    if (entry.inside) return 1.0;  // it begins in the medium
    if (entry.reflected || (*is_free)[static_cast<std::size_t>(entry.piece)]) return 0.0;
    const Vec3 direction = path.hits > 1 ? path.hit[1].d : path.direction;
    ray = frame.inverse().ray({entry.point, Direction::from(direction)});
    return 0.5 * (entry.s + entry.p);
  };
}

namespace {

/// max(0, x) with a bend of about one in place of the corner.
double softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }

/// Between which heights of a design a face is to be at a distance from the axis: the lens's turned over.
HeightBounds height_bounds(const LensLimits& limits, const FaceSeat& seat, double x, double y) {
  const double low = limits.max_height_mm ? -(seat.lowest_mm() + *limits.max_height_mm)
                                          : -std::numeric_limits<double>::infinity();
  return {x, y, low, -(seat.height_mm(x, y) + limits.min_thickness_mm.value_or(kMinThickness_mm))};
}

}  // namespace

ShapeLimits limits_on_circles(const LensLimits& limits, const DesignShape& face, double radius_mm, int rings,
                              const std::function<HeightBounds(double x_mm, double y_mm)>& bounds_at) {
  std::vector<HeightBounds> bounds;
  for (int i = 0; i <= rings; ++i) {
    const double r = radius_mm * i / rings;
    for (int k = 0; k < (i == 0 ? 1 : 2 * rings); ++k) {
      const double turn = std::numbers::pi * k / rings;
      bounds.push_back(bounds_at(r * std::cos(turn), r * std::sin(turn)));
    }
  }
  DesignLimits form;
  if (limits.min_draft_deg) form.max_slope_deg = 90.0 - *limits.min_draft_deg;
  return {form, face, bounds};
}

ShapeLimits face_limits(const LensLimits& limits, const FaceSeat& seat, const DesignShape& start, int rings) {
  return limits_on_circles(limits, start, seat.radius_mm(), rings,
                           [&](double x, double y) { return height_bounds(limits, seat, x, y); });
}

DesignShape within_limits(const LensLimits& limits, const FaceSeat& seat, const DesignShape& face) {
  /// Of what a spline through bent heights swings beyond them.
  constexpr double kRoom = 0.1;
  // Heights are bent over about a step between knots: a spline through sharply cut ones swings.
  const double bend = face.radius_mm() / face.intervals_x();
  const auto below = [&](double z, double high) {
    return std::isinf(high) ? z : high - bend * softplus((high - z) / bend);
  };
  return face.through([&](double x, double y) {
    const HeightBounds b = height_bounds(limits, seat, x, y);
    const double high = b.high_mm - kRoom, low = std::min(b.low_mm + kRoom, high);
    return std::max(low, below(-below(-face.at(x, y).z_mm, -low), high));
  });
}

namespace {

/// What a finished lens is judged by, found on a fine grid.
struct FaceExtent {
  double highest_mm, thinnest_mm, steepest = 0.0;
};

FaceExtent face_extent(const FaceSeat& seat, const DesignShape& face) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  FaceExtent out{-kFar, kFar};
  for (int i = 0; i <= kCheckRings; ++i) {
    const double r = seat.radius_mm() * i / kCheckRings;
    for (int k = 0; k < 2 * kCheckRings; ++k) {
      const double turn = std::numbers::pi * k / kCheckRings;
      const double x = r * std::cos(turn), y = r * std::sin(turn);
      const SurfacePoint p = face.at(x, y);
      out.highest_mm = std::max(out.highest_mm, -p.z_mm);
      out.thinnest_mm = std::min(out.thinnest_mm, -p.z_mm - seat.height_mm(x, y));
      out.steepest = std::max(out.steepest, std::hypot(p.dzdx, p.dzdy));
      if (!seat.bottom || r > seat.below_mm.front()[0]) continue;
      const SurfacePoint q = seat.bottom->at(x, y);
      out.steepest = std::max(out.steepest, std::hypot(q.dzdx, q.dzdy));
    }
  }
  return out;
}

}  // namespace

std::size_t ShapedLens::parameter_count() const {
  if (!face) return outline.parameter_count();
  return face->parameter_count() + (entry ? entry->parameter_count() : 0);
}

double ShapedLens::height_mm() const {
  if (!face) return outline.height_mm();
  const FaceSeat seat = seat_of(*this);
  return face_extent(seat, *face).highest_mm - seat.lowest_mm();
}

std::vector<LimitCheck> check_face_limits(const LensLimits& limits, const FaceSeat& seat,
                                          const DesignShape& face) {
  const FaceExtent extent = face_extent(seat, face);
  double widest = 0.0;
  for (const OutlinePoint& p : seat.below_mm) widest = std::max(widest, p[0]);
  std::vector<LimitCheck> out;
  if (limits.max_diameter_mm)
    out.push_back(at_most("max_diameter_mm", *limits.max_diameter_mm, 2.0 * widest));
  if (limits.max_height_mm)
    out.push_back(at_most("max_height_mm", *limits.max_height_mm, extent.highest_mm - seat.lowest_mm()));
  if (limits.min_thickness_mm)
    out.push_back(at_least("min_thickness_mm", *limits.min_thickness_mm, extent.thinnest_mm));
  if (limits.min_draft_deg)
    out.push_back(
        at_least("min_draft_deg", *limits.min_draft_deg, 90.0 - degrees(std::atan(extent.steepest))));
  return out;
}

FaceSpline face_spline(const DesignShape& face) {
  const auto& shape = std::get<BsplineShape>(face.family());
  const KnotRow &x = shape.row_x(), &y = shape.row_y();
  const int nx = x.coefficients(), ny = y.coefficients();
  // The spline of a square of the coordinate: that of the knots' averages, less a third of a step's square.
  const auto square = [](const KnotRow& row, int i) {
    const double middle = row.start_mm + (i - 1) * row.step_mm;
    return middle * middle - row.step_mm * row.step_mm / 3.0;
  };
  FaceSpline out{x.intervals, y.intervals, x.end_mm(), {}};
  for (int j = ny - 1; j >= 0; --j) {  // y is turned over
    for (int i = 0; i < nx; ++i) {
      const double base = 0.25 / shape.focal_mm() * (square(x, i) + square(y, j));
      out.coefficients_mm.push_back(-(base + shape.coefficients()[static_cast<std::size_t>(j * nx + i)]));
    }
  }
  return out;
}

namespace {

std::shared_ptr<const HeightSurface> surface_of(const FaceSpline& spline) {
  const auto row = [&](int intervals) {
    return KnotRow{-spline.half_mm, 2.0 * spline.half_mm / intervals, intervals};
  };
  return std::make_shared<const SmoothSurface<BsplineShape>>(
      BsplineShape(std::numeric_limits<double>::infinity(), row(spline.intervals_x), row(spline.intervals_y),
                   spline.coefficients_mm));
}

}  // namespace

Solid with_face(const Solid& solid, const FaceSeat& seat, const DesignShape& face) {
  Solid out = solid;
  out.outline_mm = seat.below_mm;
  out.face = surface_of(face_spline(face));
  if (seat.bottom) out.bottom_face = surface_of(face_spline(*seat.bottom));
  return out;
}

}  // namespace lucerna
