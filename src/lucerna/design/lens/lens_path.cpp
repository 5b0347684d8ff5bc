// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_path.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

constexpr double kNoHit = 1e300;
/// A hit is moved from its straight side onto the curve by at most so much of the way along a piece; more is
/// a ray that only touches the curve, and is left where it is.
constexpr double kMostSlide = 0.05;
/// Newton's steps towards the curve: the distance is squared by each.
constexpr int kSlides = 3;
/// Nearer to the axis the normal turns about it as it does along the curve.
constexpr double kOnAxisMm = 1e-7;

}  // namespace

void LensTracer::locate(const SideHit& side, const Vec3& o, const Vec3& d, LensHit& hit) const {
  const LensCurves::SidePlace& place = curves_.place(side.side);
  const OutlinePiece<double>& curve = curves_.pieces()[static_cast<std::size_t>(place.piece)].curve;
  const double u0 = place.from + side.share * (place.to - place.from);
  double u = u0, t = side.t;
  CurvePoint at = curve_point(curve, u);
  for (int i = 0; i < kSlides; ++i) {
    const double x = o.x + t * d.x, y = o.y + t * d.y, r = std::sqrt(x * x + y * y);
    if (r < kOnAxisMm) break;
    const double off_r = r - at.at[0], off_z = o.z + t * d.z - at.at[1];
    const double dr = (x * d.x + y * d.y) / r, det = at.first[0] * d.z - at.first[1] * dr;
    if (std::fabs(det) < 1e-12) break;
    t += (at.first[1] * off_r - at.first[0] * off_z) / det;
    u += (d.z * off_r - dr * off_z) / det;
    if (!(std::fabs(u - u0) < kMostSlide)) {
      u = u0;
      t = side.t;
      at = curve_point(curve, u);
      break;
    }
    at = curve_point(curve, u);
  }
  hit.d = d;
  hit.t = t;
  hit.point = o + t * d;
  hit.piece = place.piece;
  hit.u = u;
  hit.speed = std::hypot(at.first[0], at.first[1]);
  hit.nr = at.first[1] / hit.speed;
  hit.nz = -at.first[0] / hit.speed;
  hit.bend = (at.first[0] * at.second[1] - at.first[1] * at.second[0]) / (hit.speed * hit.speed * hit.speed);
  const double r = std::hypot(hit.point.x, hit.point.y);
  const Vec3 radial = r > kOnAxisMm ? Vec3{hit.point.x / r, hit.point.y / r, 0.0} : Vec3{1.0, 0.0, 0.0};
  hit.ring = r > kOnAxisMm ? hit.nr / r : hit.bend;
  hit.across = {-radial.y, radial.x, 0.0};
  hit.out = {hit.nr * radial.x, hit.nr * radial.y, hit.nz};
  hit.along = {-hit.nz * radial.x, -hit.nz * radial.y, hit.nr};
}

bool LensTracer::next_hit(const Vec3& o, const Vec3& d, bool begun, bool inside, LensHit& hit) const {
  constexpr int kMostBehind = 8;
  double from = begun ? kSolidStart : 0.0;
  for (int i = 0; i < kMostBehind; ++i) {
    const SideHit side = first_side(curves_.view(), o, d, from, kNoHit);
    if (side.side < 0) return false;
    locate(side, o, d, hit);
    const bool leaves = dot(hit.out, d) > 0.0;
    if (!begun || leaves == inside) {
      hit.inside = leaves;
      return true;
    }
    from = std::max(side.t, hit.t) + kSolidStart;  // rounding: a surface that is behind the ray
  }
  return false;
}

void LensTracer::set_boundary(LensHit& hit) const {
  hit.sense = hit.inside ? -1.0 : 1.0;
  hit.ratio = hit.inside ? 1.0 / medium_.index : medium_.index;
  hit.c = std::min(1.0, std::fabs(dot(hit.out, hit.d)));
  const Boundary found = boundary(hit.ratio, hit.c);
  hit.cos_refracted = found.cos_refracted;
  hit.s = found.s * found.s;
  hit.p = found.p * found.p;
  hit.log_s = hit.log_p = 0.0;
  if (found.cos_refracted == 0.0) return;
  const AmplitudeSlopes slopes = amplitude_slopes(hit.ratio, hit.c, found.cos_refracted);
  hit.log_s = 2.0 * found.s * slopes.s;  // of the shares; over themselves below
  hit.log_p = 2.0 * found.p * slopes.p;
}

bool LensTracer::begins_inside(const Vec3& origin, const Vec3& direction) const {
  LensHit first;
  return next_hit(origin, direction, false, false, first) && first.inside;
}

void LensTracer::follow(const Vec3& origin, const Vec3& direction, const Ghost& ghost, LensPath& path) const {
  path.hits = path.partial = 0;
  path.s = path.p = path.clear = 1.0;
  path.end = LensEnd::lost;
  bool inside = false;
  Vec3 o = origin, d = direction;
  for (;;) {
    LensHit& hit = path.hit[static_cast<std::size_t>(std::min(path.hits, kMaxLensHits - 1))];
    if (!next_hit(o, d, path.hits > 0, inside, hit)) {
      path.origin = o;
      path.direction = d;
      if (!inside) path.end = path.hits == 0 ? LensEnd::direct : LensEnd::left;
      return;
    }
    if (path.hits == kMaxLensHits) return;
    ++path.hits;
    set_boundary(hit);
    const bool total = hit.cos_refracted == 0.0;
    hit.reflected = total || ghost.reflects_at(path.partial);
    if (!total) ++path.partial;
    if (!hit.reflected) {
      hit.s = 1.0 - hit.s;
      hit.p = 1.0 - hit.p;
      hit.log_s = -hit.log_s;
      hit.log_p = -hit.log_p;
    }
    hit.log_s = hit.s > 1e-12 ? hit.log_s / hit.s : 0.0;
    hit.log_p = hit.p > 1e-12 ? hit.log_p / hit.p : 0.0;
    path.s *= hit.s;
    path.p *= hit.p;
    if (hit.inside) path.clear *= std::exp(-medium_.absorption_per_mm * hit.t);
    const Vec3 normal = hit.sense * hit.out;
    o = hit.point;
    d = hit.reflected ? d + (2.0 * hit.c) * normal
                      : (1.0 / hit.ratio) * d + (hit.c / hit.ratio - hit.cos_refracted) * normal;
    inside = hit.inside == hit.reflected;
  }
}

void lens_adjoint(const LensPath& path, const MediumView& medium, int last, const Vec3& direction,
                  const Vec3& point, bool share, LensAdjoint* out) {
  Vec3 a = direction, b = point;
  for (int i = last; i >= 0; --i) {
    const LensHit& hit = path.hit[static_cast<std::size_t>(i)];
    const Vec3 normal = hit.sense * hit.out;
    const double keep = hit.reflected ? 1.0 : 1.0 / hit.ratio;
    const double turned = hit.reflected ? 2.0 * hit.c : hit.c / hit.ratio - hit.cos_refracted;
    const double turns_by_c =
        hit.reflected ? 2.0 : 1.0 / hit.ratio - hit.c / (hit.ratio * hit.ratio * hit.cos_refracted);
    double by_c = turns_by_c * dot(a, normal), by_way = 0.0;
    if (share) {
      by_c += 0.5 * path.clear * (path.s * hit.log_s + path.p * hit.log_p);
      if (hit.inside) by_way = -medium.absorption_per_mm * path.share();
    }
    const Vec3 by_d = keep * a - by_c * normal;
    const Vec3 by_normal = hit.sense * (turned * a - by_c * hit.d);
    const double by_along = dot(by_normal, hit.along);
    b = b + (hit.bend * by_along) * hit.along + (hit.ring * dot(by_normal, hit.across)) * hit.across;
    const double lift = (dot(b, hit.d) + by_way) / dot(hit.out, hit.d);
    out[i] = {lift, by_along};
    b = b - lift * hit.out;
    a = by_d + hit.t * b;
  }
}

std::array<double, kPieceNumbers> piece_derivatives(const LensHit& hit, const LensAdjoint& by) {
  const PieceBasis basis = piece_basis(hit.u);
  const std::array<double, 2> normal{hit.nr, hit.nz}, tangent{-hit.nz, hit.nr};
  std::array<double, kPieceNumbers> out;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      const double rise = by.rise * normal[k] - by.turn * hit.bend * tangent[k];
      out[2 * i + k] = basis.at[i] * rise - basis.first[i] * by.turn * normal[k] / hit.speed;
    }
  }
  return out;
}

}  // namespace lucerna
