// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/entry_face.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/design/evaluation/refracting_face.h"
#include "lucerna/design/lens/lens_evaluation.h"
#include "lucerna/optics/shapes/faced_outline.h"
#include "lucerna/trace/engines/mirror_tracer.h"

namespace lucerna {

namespace {

/// A cavity leaves so much of the base's radius, and comes to so much of the height above it.
constexpr double kRingShare = 0.05, kMaxDepthShare = 0.8;
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
  double entry_radius_mm() const { return below[entry_end][0]; }
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

/// The cap of an ellipsoid whose tangent at its rim leaves the axis by the draft.
class CavityCurve {
 public:
  CavityCurve(const Cavity& cavity, double min_draft_deg) : cavity_(cavity) {
    if (!(cavity.depth_mm > 0.0)) return;
    // With semi-axes A, B and the eccentric angle e of the rim: radius = A sin e, depth = B (1 - cos e), and
    // the tangent of the slope there is (B / A) tan e.
    const double flatness = cavity.radius_mm / (cavity.depth_mm * std::tan(radians(min_draft_deg)));
    if (!(flatness > 2.0)) {
      throw InputError(
          fmt::format("a cavity of radius {:.4g} mm is {:.4g} mm deep: expected a flatter one for a "
                      "draft of {} degrees",
                      cavity.radius_mm, cavity.depth_mm, min_draft_deg));
    }
    rim_ = std::acos(1.0 / (flatness - 1.0));
    across_mm_ = cavity.radius_mm / std::sin(rim_);
    up_mm_ = cavity.depth_mm / (1.0 - std::cos(rim_));
  }

  double height_mm(double r_mm) const {
    if (!(r_mm < cavity_.radius_mm)) return 0.0;
    const double x = r_mm / across_mm_;
    return up_mm_ * (std::sqrt(1.0 - x * x) - std::cos(rim_));
  }

  /// From the axis to the rim, at equal turns of the tangent, over a base.
  std::vector<OutlinePoint> corners(double base_mm, double smooth_below_deg) const {
    if (!(cavity_.depth_mm > 0.0)) return {{0.0, base_mm}};
    const int n = std::clamp(static_cast<int>(std::ceil(90.0 / (kTurnShare * smooth_below_deg))), kMinPieces,
                             kMaxPieces);
    const double turn_of_rim = std::atan2(up_mm_ * std::sin(rim_), across_mm_ * std::cos(rim_));
    std::vector<OutlinePoint> out;
    for (int i = 0; i < n; ++i) {
      const double turn = turn_of_rim * i / n;
      const double e = std::atan2(across_mm_ * std::sin(turn), up_mm_ * std::cos(turn));
      out.push_back({across_mm_ * std::sin(e), base_mm + up_mm_ * (std::cos(e) - std::cos(rim_))});
    }
    out.push_back({cavity_.radius_mm, base_mm});
    return out;
  }

 private:
  Cavity cavity_;
  double rim_ = 0.0, across_mm_ = 1.0, up_mm_ = 0.0;
};

/// By how much of a paraboloid a face has to be lifted to clear a cavity.
double lift_mm(const LensParts& parts, const CavityCurve& cavity) {
  const double radius = parts.wall_radius_mm();
  double lift = 0.0;
  for (const OutlinePoint& p : parts.face) {
    const double x = p[0] / radius, room = 1.0 - x * x;
    if (!(room > 0.0)) continue;
    const double least = parts.base_mm() + cavity.height_mm(p[0]) + kGap * radius * room;
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
  const double ring = std::max(kRingShare * parts.base_radius_mm(), limits.min_thickness_mm.value_or(0.0));
  return {parts.base_radius_mm() - ring, kMaxDepthShare * room};
}

LensShape with_cavity(const LensShape& lens, const Cavity& cavity, double min_draft_deg) {
  const LensParts parts = parts_of(lens);
  const CavityCurve curve(cavity, min_draft_deg);
  std::vector<OutlinePoint> corners = curve.corners(parts.base_mm(), lens.smooth_below_deg());
  const double rim = corners.back()[0];
  for (std::size_t i = parts.entry_end; i < parts.below.size(); ++i) {
    if (parts.below[i][0] > rim) corners.push_back(parts.below[i]);
  }
  const std::size_t free_side = corners.size() - 1;
  const double lift = lift_mm(parts, curve), radius = parts.wall_radius_mm();
  for (std::size_t i = 1; i < parts.face.size(); ++i) {
    const double x = parts.face[i][0] / radius;
    corners.push_back({parts.face[i][0], parts.face[i][1] + lift * (1.0 - x * x)});
  }
  return {corners, lens.smooth_below_deg(), std::vector<std::size_t>{free_side}, 0};
}

namespace {

/// A free first face leaves so much of the base's radius, is so high above its plane and so far from a
/// source.
constexpr double kFlangeShare = 0.02, kRise_mm = 0.01, kClearance_mm = 0.05;
/// And begins so high, with room to the limits' margin.
constexpr double kBeginRise_mm = 0.06;

}  // namespace

DesignShape entry_of(const LensShape& lens, const LensLimits& limits, int intervals) {
  const LensParts parts = parts_of(lens);
  const FaceSeat seat = face_seat(lens);
  const double flange =
      std::max(kFlangeShare * parts.base_radius_mm(),
               std::min(limits.min_thickness_mm.value_or(0.0), kRingShare * parts.base_radius_mm()));
  const double radius = std::min(parts.entry_radius_mm(), parts.base_radius_mm() - flange);
  const double focal = 10.0 * radius;  // only has to be of the face's size
  const double rim = seat.height_mm(radius);
  // Beyond the rim it goes on as it came there: a spline cannot follow an edge.
  const auto height = [&](double r) {
    return r < radius ? seat.height_mm(r) : 2.0 * rim - seat.height_mm(std::max(0.0, 2.0 * radius - r));
  };
  return DesignShape::bspline(focal, Aperture::circle(2.0 * radius), intervals, intervals, limits.symmetry)
      .through([&](double x, double y) { return -(height(std::hypot(x, y)) + kBeginRise_mm); });
}

FaceSeat seat_over(const LensShape& lens, const DesignShape& entry) {
  const LensParts parts = parts_of(lens);
  const double radius = entry.aperture().half_x_mm(), base = parts.base_mm();
  FaceSeat out;
  // The wall's upper end is at the face's rim, wherever that is.
  out.below_mm = {{radius, base + radius}, {radius, base}};
  for (std::size_t i = parts.entry_end; i < parts.below.size(); ++i) {
    if (parts.below[i][0] > radius) out.below_mm.push_back(parts.below[i]);
  }
  out.base = faced_base_sides(out.below_mm, lens.smooth_below_deg(), kBaseTolerance_mm);
  out.bottom = entry;
  return out;
}

SourceEnd source_end(const DesignRays& rays) {
  SourceEnd out;
  for (std::uint64_t b = 0; b < rays.size() / kBlockRays; ++b) {
    const DesignRays::Block& block = rays.block(b);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      if (!(block.weight[i] > 0.0F)) continue;
      const auto x = static_cast<double>(block.x_mm[i]), y = static_cast<double>(block.y_mm[i]);
      out.low_mm = std::min(out.low_mm, static_cast<double>(block.z_mm[i]));
      out.radius_mm = std::max(out.radius_mm, std::hypot(x, y));
    }
  }
  return out;
}

ShapeLimits entry_limits(const LensLimits& limits, const LensShape& lens, const DesignShape& entry,
                         const DesignShape& last, const SourceEnd& source, int rings) {
  const double over_base = -(parts_of(lens).base_mm() + kRise_mm);
  const double over_source = std::min(over_base, source.low_mm - kClearance_mm);
  const double thickness = limits.min_thickness_mm.value_or(kMinThickness_mm);
  return limits_on_circles(limits, entry, entry.aperture().half_x_mm(), rings, [&](double x, double y) {
    const bool is_over_source = std::hypot(x, y) <= source.radius_mm + kClearance_mm;
    return HeightBounds{x, y, last.at(x, y).z_mm + thickness, is_over_source ? over_source : over_base};
  });
}

DesignRays::Pass into_entry(const DesignShape& entry, const MediumView& medium) {
  const auto tracer = std::make_shared<const MirrorTracer>(entry.reflector());
  return [tracer, entry, media = media_of_first_face(medium)](Ray& ray) {
    const auto t = tracer->first_mm(ray);
    FaceHit hit;
    if (!t || !(ray.direction.z() < 0.0) ||
        !refract_at(std::get<BsplineShape>(entry.family()).view(), media, ray.origin_mm, ray.direction.vec(),
                    *t, hit))
      return 0.0;
    ray = {hit.point, Direction::from(hit.out)};
    return hit.share;
  };
}

bool takes_source_in(const LensShape& lens, const LensShape& given, const DesignRays& rays) {
  return share_within(lens, rays, rays.size()) > share_within(given, rays, rays.size());
}

}  // namespace lucerna
