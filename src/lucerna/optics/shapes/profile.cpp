// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/shapes/cubic_spline.h"
#include "lucerna/reflector.h"

namespace lucerna {

namespace {

void check_positive(const char* what, double value_mm) {
  if (!(value_mm > 0.0 && std::isfinite(value_mm))) {
    throw InputError(fmt::format("reflector: {} is {}, expected a finite number above 0", what, value_mm));
  }
}

/// How far a formula is used beyond the rim, as a multiple of the rim's radius.
constexpr double kGoesOn = 1.1;

void widen(HeightRange& range, double z_mm) {
  range.low_mm = std::min(range.low_mm, z_mm);
  range.high_mm = std::max(range.high_mm, z_mm);
}

}  // namespace

ConicProfile::ConicProfile(double curvature, double conic, double r_max_mm)
    : curvature_(curvature), conic_(conic) {
  check_positive("the outer radius", r_max_mm);
  r_max_mm_ = r_max_mm;
  tangent_from_mm_ = kGoesOn * r_max_mm;
  if (conic > -1.0) {
    const double equator_mm = 1.0 / (curvature * std::sqrt(1.0 + conic));
    tangent_from_mm_ = std::max(r_max_mm, std::min(tangent_from_mm_, 0.99 * equator_mm));
  }
}

ConicProfile ConicProfile::parabola(double focal_mm, double r_max_mm) {
  check_positive("focal_mm", focal_mm);
  return {0.5 / focal_mm, -1.0, r_max_mm};
}

ConicProfile ConicProfile::ellipse(double focal_mm, double focal2_mm, double r_max_mm) {
  check_positive("focal_mm", focal_mm);
  check_positive("focal2_mm", focal2_mm);
  const double equator_mm = std::sqrt(focal_mm * focal2_mm);
  if (!(r_max_mm < equator_mm)) {
    throw InputError(fmt::format(
        "reflector: the ellipse reaches radius {} mm at its equator, the aperture needs {} mm; "
        "expected an aperture inside the equator, or mouth_diameter_mm for a mirror that goes past it",
        equator_mm, r_max_mm));
  }
  const double eccentricity = (focal2_mm - focal_mm) / (focal2_mm + focal_mm);
  return {(focal_mm + focal2_mm) / (2.0 * focal_mm * focal2_mm), -eccentricity * eccentricity, r_max_mm};
}

ConicProfile ConicProfile::hyperbola(double focal_mm, double focal2_mm, double r_max_mm) {
  check_positive("focal_mm", focal_mm);
  if (!(focal2_mm > focal_mm && std::isfinite(focal2_mm))) {
    throw InputError(
        fmt::format("reflector: hyperbola with focal_mm {} and focal2_mm {}, expected focal2_mm > focal_mm",
                    focal_mm, focal2_mm));
  }
  const double eccentricity = (focal2_mm + focal_mm) / (focal2_mm - focal_mm);
  return {(focal2_mm - focal_mm) / (2.0 * focal_mm * focal2_mm), -eccentricity * eccentricity, r_max_mm};
}

ProfilePoint ConicProfile::at(double r_mm) const {
  const double r = std::min(r_mm, tangent_from_mm_);
  const double cr = curvature_ * r;
  const double root = std::sqrt(1.0 - (1.0 + conic_) * cr * cr);
  const double slope = cr / root;
  return {cr * r / (1.0 + root) + slope * (r_mm - r), slope};
}

HeightRange ConicProfile::range(double r0_mm, double r1_mm) const { return {at(r0_mm).z_mm, at(r1_mm).z_mm}; }

SplineProfile::SplineProfile(const std::vector<ProfileKnot>& knots) {
  if (knots.size() < 2) {
    throw InputError(
        fmt::format("reflector: the profile has {} point(s), expected at least 2", knots.size()));
  }
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const ProfileKnot& k = knots[i];
    const double before = i == 0 ? -std::numeric_limits<double>::min() : knots[i - 1].r_mm;
    if (!std::isfinite(k.r_mm) || !std::isfinite(k.z_mm) || k.r_mm < 0.0 || !(k.r_mm > before)) {
      throw InputError(fmt::format(
          "reflector: profile point {} is [{}, {}], expected finite numbers with r >= 0 ascending", i + 1,
          k.r_mm, k.z_mm));
    }
  }
  const std::size_t m = knots.size() - 1;
  const bool flat_start = knots[0].r_mm == 0.0;
  std::vector<double> h(m), delta(m);
  for (std::size_t i = 0; i < m; ++i) {
    h[i] = knots[i + 1].r_mm - knots[i].r_mm;
    delta[i] = (knots[i + 1].z_mm - knots[i].z_mm) / h[i];
  }
  std::vector<double> s;
  if (m == 1) {
    s = flat_start ? std::vector{0.0, 2.0 * delta[0]} : std::vector{delta[0], delta[0]};
  } else {
    s = spline_slopes(h, delta, flat_start ? SplineEnd::flat : SplineEnd::not_a_knot, SplineEnd::not_a_knot);
  }
  for (std::size_t i = 0; i < m; ++i) {
    pieces_.push_back({knots[i].r_mm, knots[i].z_mm, s[i], (3.0 * delta[i] - 2.0 * s[i] - s[i + 1]) / h[i],
                       (s[i] + s[i + 1] - 2.0 * delta[i]) / (h[i] * h[i])});
  }
  r_min_mm_ = knots[0].r_mm;
  r_max_mm_ = knots[m].r_mm;
  formula_from_mm_ = r_min_mm_ / kGoesOn;
  formula_to_mm_ = r_max_mm_ * kGoesOn;
  convex_ = at(formula_from_mm_).slope >= 0.0;
  // The second derivative is linear in each piece.
  for (std::size_t i = 0; i < m; ++i) {
    const Piece& p = pieces_[i];
    const double begin = i == 0 ? formula_from_mm_ : p.r_mm,
                 end = i + 1 < m ? knots[i + 1].r_mm : formula_to_mm_;
    for (const double r : {begin, end}) convex_ = convex_ && p.c + 3.0 * p.d * (r - p.r_mm) >= 0.0;
  }
}

const SplineProfile::Piece& SplineProfile::piece(double r_mm) const {
  const auto after = std::upper_bound(pieces_.begin() + 1, pieces_.end(), r_mm,
                                      [](double r, const Piece& p) { return r < p.r_mm; });
  return *(after - 1);
}

ProfilePoint SplineProfile::at(double r_mm) const {
  const double r = std::clamp(r_mm, formula_from_mm_, formula_to_mm_);
  const Piece& p = piece(r);
  const double t = r - p.r_mm, slope = p.b + t * (2.0 * p.c + 3.0 * t * p.d);
  return {p.z + t * (p.b + t * (p.c + t * p.d)) + slope * (r_mm - r), slope};
}

HeightRange SplineProfile::range(double r0_mm, double r1_mm) const {
  const double z0 = at(r0_mm).z_mm;
  HeightRange range{z0, z0};
  widen(range, at(r1_mm).z_mm);
  const auto widen_at = [&](double r) {
    if (r > r0_mm && r < r1_mm) widen(range, at(r).z_mm);
  };
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const Piece& p = pieces_[i];
    const double begin = i == 0 ? formula_from_mm_ : p.r_mm;
    const double end = i + 1 < pieces_.size() ? pieces_[i + 1].r_mm : formula_to_mm_;
    if (begin > r1_mm || end < r0_mm) continue;
    widen_at(begin);
    widen_at(end);
    const double q = p.c * p.c - 3.0 * p.d * p.b;  // z' = b + 2 c t + 3 d t^2 = 0
    if (q < 0.0) continue;
    const double w = -(p.c + std::copysign(std::sqrt(q), p.c));
    for (const double t : {w / (3.0 * p.d), p.b / w}) {
      if (p.r_mm + t >= begin && p.r_mm + t <= end) widen_at(p.r_mm + t);
    }
  }
  return range;
}

RevolutionSurface::RevolutionSurface(std::shared_ptr<const Profile> profile) : profile_(std::move(profile)) {}

SurfacePoint RevolutionSurface::at(double x_mm, double y_mm) const {
  const double r = std::sqrt(x_mm * x_mm + y_mm * y_mm);
  const ProfilePoint p = profile_->at(r);
  const double per_r = r > 0.0 ? p.slope / r : 0.0;  // on the axis the tangent plane is level
  return {p.z_mm, x_mm * per_r, y_mm * per_r};
}

HeightRange RevolutionSurface::range(const Rectangle& region) const {
  const RadiusRange r = radius_range(region);
  return profile_->range(r.min_mm, r.max_mm);
}

}  // namespace lucerna
