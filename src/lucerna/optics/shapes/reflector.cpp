// SPDX-License-Identifier: Apache-2.0
#include "lucerna/reflector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/shapes/curve_sheet.h"
#include "lucerna/optics/shapes/profile.h"
#include "lucerna/optics/shapes/swept_curve.h"
#include "lucerna/optics/shapes/trough_surface.h"

namespace lucerna {

namespace {

ConicProfile conic_profile(ConicPreset preset, double focal_mm, double focal2_mm, double r_max_mm) {
  switch (preset) {
    case ConicPreset::parabola:
      return ConicProfile::parabola(focal_mm, r_max_mm);
    case ConicPreset::ellipse:
      return ConicProfile::ellipse(focal_mm, focal2_mm, r_max_mm);
    case ConicPreset::hyperbola:
      break;
  }
  return ConicProfile::hyperbola(focal_mm, focal2_mm, r_max_mm);
}

}  // namespace

bool HeightSurface::convex_over(const Rectangle&) const { return false; }

Reflector conic_reflector(ConicPreset preset, double focal_mm, double focal2_mm, const Aperture& aperture) {
  auto profile =
      std::make_shared<ConicProfile>(conic_profile(preset, focal_mm, focal2_mm, aperture.outer_radius_mm()));
  return {std::make_shared<RevolutionSurface>(std::move(profile)), aperture};
}

Reflector conic_trough(ConicPreset preset, double focal_mm, double focal2_mm, const Aperture& aperture) {
  auto profile =
      std::make_shared<ConicProfile>(conic_profile(preset, focal_mm, focal2_mm, aperture.half_x_mm()));
  return {std::make_shared<TroughSurface>(std::move(profile)), aperture};
}

namespace {

std::shared_ptr<const SplineProfile> checked_profile(const std::vector<ProfileKnot>& knots, double reach_mm,
                                                     double hole_mm) {
  auto profile = std::make_shared<SplineProfile>(knots);
  if (reach_mm > profile->r_max_mm() * (1.0 + 1e-12)) {
    throw InputError(fmt::format("reflector: the profile ends at radius {} mm, the aperture reaches {} mm",
                                 profile->r_max_mm(), reach_mm));
  }
  if (profile->r_min_mm() > hole_mm * (1.0 + 1e-12)) {
    throw InputError(
        fmt::format("reflector: the profile starts at radius {} mm, the hole's radius is {} mm; "
                    "expected a profile from the axis or a hole at least as wide",
                    profile->r_min_mm(), hole_mm));
  }
  return profile;
}

/// Chords steeper than this make a curve: a spline over the radius bends too much there.
constexpr double kMaxGradient = 10.0;

/// True if the points make a function of the radius. Descending ones are refused: they are one too, but said
/// from the wrong end.
bool is_function(const std::vector<ProfileKnot>& knots) {
  bool function = true, descends = knots.size() > 1;
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const double dr = knots[i].r_mm - knots[i - 1].r_mm, dz = knots[i].z_mm - knots[i - 1].z_mm;
    function = function && !(dr <= 0.0 || std::abs(dz) > kMaxGradient * dr);
    descends = descends && dr < 0.0;
  }
  if (descends) {
    throw InputError(
        "reflector: the profile's points go from the rim to the axis; expected them from the vertex (or the "
        "hole) to the rim");
  }
  return function;
}

Reflector swept_reflector(const std::vector<ProfileKnot>& knots, const Aperture& aperture, Sweep sweep) {
  auto curve = std::make_shared<SweptCurve>(knots, sweep);
  const double max = curve->r_max_mm(), mouth = curve->last().r_mm, x = aperture.half_x_mm();
  Aperture whole = aperture;
  const bool round = aperture.shape() == ApertureShape::circle;
  if (std::abs(x - mouth) <= 1e-9 * mouth) {
    whole = round
                ? Aperture::circle(2.0 * max, 2.0 * aperture.hole_radius_mm())
                : Aperture::rectangle(2.0 * max, 2.0 * aperture.half_y_mm(), 2.0 * aperture.hole_radius_mm());
  } else if (round && sweep == Sweep::revolution && x < max * (1.0 - 1e-3)) {
    throw InputError(fmt::format(
        "reflector: the profile reaches radius {:.6g} mm and closes to {:.6g} mm at its last point; an "
        "aperture of diameter {:.6g} mm would cut it twice; expected the mouth's {:.6g} mm",
        max, mouth, 2.0 * x, 2.0 * mouth));
  }
  return {std::make_shared<CurveSheet>(curve), whole, curve};
}

}  // namespace

Reflector profile_reflector(const std::vector<ProfileKnot>& knots, const Aperture& aperture) {
  if (!is_function(knots)) return swept_reflector(knots, aperture, Sweep::revolution);
  return {std::make_shared<RevolutionSurface>(
              checked_profile(knots, aperture.outer_radius_mm(), aperture.hole_radius_mm())),
          aperture};
}

Reflector profile_trough(const std::vector<ProfileKnot>& knots, const Aperture& aperture) {
  if (!is_function(knots)) return swept_reflector(knots, aperture, Sweep::trough);
  return {std::make_shared<TroughSurface>(checked_profile(knots, aperture.half_x_mm(), 0.0)), aperture};
}

Reflector deep_ellipse_reflector(double focal_mm, double focal2_mm, double mouth_diameter_mm,
                                 double hole_diameter_mm) {
  if (!(focal_mm > 0.0 && focal2_mm > 0.0 && std::isfinite(focal_mm + focal2_mm))) {
    throw InputError(
        fmt::format("reflector: an ellipse with focal lengths {} and {} mm, expected finite numbers "
                    "above 0",
                    focal_mm, focal2_mm));
  }
  const double a = 0.5 * (focal_mm + focal2_mm), b = std::sqrt(focal_mm * focal2_mm);  // along z, across
  const double mouth = 0.5 * mouth_diameter_mm, hole = 0.5 * hole_diameter_mm;
  if (!(mouth >= 0.0 && mouth < b && hole >= 0.0 && hole < b)) {
    throw InputError(
        fmt::format("reflector: an ellipse with an equator of {:.6g} mm, a mouth of {} mm and a hole of "
                    "{} mm, expected both smaller than the equator",
                    2.0 * b, mouth_diameter_mm, hole_diameter_mm));
  }
  const double from = std::asin(hole / b), to = std::numbers::pi - std::asin(mouth / b);
  // Even steps of the eccentric anomaly are close together where an ellipse bends most.
  const auto n = static_cast<std::size_t>(256.0 * std::max(1.0, std::sqrt(std::max(a / b, b / a))));
  std::vector<ProfileKnot> knots;
  for (std::size_t i = 0; i <= n; ++i) {
    const double e = from + (to - from) * static_cast<double>(i) / static_cast<double>(n);
    const double r = i == n ? mouth : (i == 0 ? hole : b * std::sin(e));
    knots.push_back({r, a * (1.0 - std::cos(e))});
  }
  return swept_reflector(knots, Aperture::circle(2.02 * b), Sweep::revolution);
}

CurveSheet::CurveSheet(std::shared_ptr<const SweptCurve> curve) : curve_(std::move(curve)) {}

SurfacePoint CurveSheet::at(double x_mm, double y_mm) const {
  const bool trough = curve_->sweep() == Sweep::trough;
  const double r = trough ? std::abs(x_mm) : std::hypot(x_mm, y_mm);
  // Lowest chord over this radius; the pieces are short.
  double z = std::numeric_limits<double>::infinity(), slope = 0.0;
  const auto steps = static_cast<double>(curve_->pieces().size());
  SweptCurve::Point p = curve_->at(0.0);
  double nearest = std::numeric_limits<double>::infinity(), nearest_z = p.z_mm;
  for (double i = 1.0; i <= steps; i += 1.0) {
    const SweptCurve::Point q = curve_->at(i / steps);
    if (std::min(p.r_mm, q.r_mm) <= r && r <= std::max(p.r_mm, q.r_mm) && p.r_mm != q.r_mm) {
      const double k = (q.z_mm - p.z_mm) / (q.r_mm - p.r_mm), here = p.z_mm + k * (r - p.r_mm);
      if (here < z) {
        z = here;
        slope = k;
      }
    }
    if (std::abs(q.r_mm - r) < nearest) {
      nearest = std::abs(q.r_mm - r);
      nearest_z = q.z_mm;
    }
    p = q;
  }
  if (!std::isfinite(z)) return {nearest_z, 0.0, 0.0};
  const double per = r > 0.0 ? slope / r : 0.0;
  return {z, x_mm * per, trough ? 0.0 : y_mm * per};
}

HeightRange CurveSheet::range(const Rectangle&) const { return curve_->heights(); }

}  // namespace lucerna
