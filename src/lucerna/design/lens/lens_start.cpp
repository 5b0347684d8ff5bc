// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "lucerna/design/evaluation/point_source.h"
#include "lucerna/design/lens/lens_path.h"
#include "lucerna/design/lens/prescribed_angle.h"

namespace lucerna {

namespace {

constexpr int kMeridianSteps = 2000;
/// Heights of domes that an entry begins with, over the lens's radius; flat ones do not bend light enough
/// where it is wide, or its source.
constexpr std::array<double, 4> kDomes{0.0, 0.12, 0.25, 0.4};

/// A ray of the half plane where it meets the free face from within: r and z of its last point and of its
/// direction, and of the face.
struct MeridianRay {
  double theta = 0.0, flux = 0.0;  ///< flux within theta
  OutlinePoint from{}, along{}, face{};
};

/// The rays from the point on the axis that meet a face from within, straight through the others, from the
/// axis on.
std::vector<MeridianRay> meridian_rays(const LensShape& lens, std::size_t face, const MediumView& medium,
                                       const PointSource& source) {
  const LensCurves curves(lens);
  const LensTracer tracer(curves, medium);
  const std::vector<double> light = meridian_light(source, kMeridianSteps);
  std::vector<MeridianRay> out;
  LensPath path;
  double flux = 0.0;
  for (int i = 0; i < kMeridianSteps; ++i) {
    const double theta = (i + 0.5) * std::numbers::pi / kMeridianSteps;
    tracer.follow({0.0, 0.0, source.at_mm.z}, {std::sin(theta), 0.0, std::cos(theta)}, kNoGhost, path);
    double passed = 1.0;
    int k = 0;
    const auto is_on_face = [&](const LensHit& h) {
      return curves.pieces()[static_cast<std::size_t>(h.piece)].face == face;
    };
    // Light that a wall has reflected comes from elsewhere.
    while (k < path.hits && !is_on_face(path.hit[static_cast<std::size_t>(k)]) &&
           !path.hit[static_cast<std::size_t>(k)].reflected) {
      const LensHit& h = path.hit[static_cast<std::size_t>(k++)];
      passed *= 0.5 * (h.s + h.p);
    }
    if (k == path.hits || !path.hit[static_cast<std::size_t>(k)].inside ||
        !is_on_face(path.hit[static_cast<std::size_t>(k)]))
      break;
    const LensHit& hit = path.hit[static_cast<std::size_t>(k)];
    const Vec3 from = hit.point - hit.t * hit.d;
    flux += passed * light[static_cast<std::size_t>(i)];
    out.push_back({theta, flux, {from.x, from.z}, {hit.d.x, hit.d.z}, {hit.point.x, hit.point.z}});
  }
  return out;
}

/// Points of the free face, from the axis outwards; empty where there is none.
std::vector<OutlinePoint> face_points(const std::vector<MeridianRay>& rays, const PrescribedAngle& angle,
                                      double index, double side, bool from_axis) {
  const std::size_t n = rays.size();
  std::vector<OutlinePoint> out(n);
  const auto normal = [&](std::size_t i) {
    const double gamma = side * angle.of(rays[i].flux / rays.back().flux);
    return OutlinePoint{index * rays[i].along[0] - std::sin(gamma),
                        index * rays[i].along[1] - std::cos(gamma)};
  };
  const std::size_t first = from_axis ? 0 : n - 1;
  out[first] = rays[first].face;
  for (std::size_t step = 1; step < n; ++step) {
    const std::size_t i = from_axis ? step : n - 1 - step, before = from_axis ? i - 1 : i + 1;
    // The next ray meets the plane across the mean normal of the two through the point before.
    const OutlinePoint a = normal(before), b = normal(i);
    const OutlinePoint m{a[0] + b[0], a[1] + b[1]};
    const MeridianRay& ray = rays[i];
    const double fall = m[0] * ray.along[0] + m[1] * ray.along[1];
    if (!(fall > 0.0)) return {};
    const double t = (m[0] * (out[before][0] - ray.from[0]) + m[1] * (out[before][1] - ray.from[1])) / fall;
    if (!(t > 0.0)) return {};
    out[i] = {ray.from[0] + t * ray.along[0], ray.from[1] + t * ray.along[1]};
  }
  return out;
}

/// How far along `direction` from `base` a curve is met, going on straight beyond its ends.
std::optional<double> way_to_curve(const std::vector<OutlinePoint>& curve, const OutlinePoint& base,
                                   const OutlinePoint& direction) {
  std::optional<double> best;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    const double wr = curve[i + 1][0] - curve[i][0], wz = curve[i + 1][1] - curve[i][1];
    const double det = direction[0] * wz - direction[1] * wr;
    if (det == 0.0) continue;
    const double dr = curve[i][0] - base[0], dz = curve[i][1] - base[1];
    const double x = (dr * wz - dz * wr) / det, s = (dr * direction[1] - dz * direction[0]) / det;
    const double low = i == 0 ? -1e9 : -1e-9, high = i + 2 == curve.size() ? 1e9 : 1.0 + 1e-9;
    if (s < low || s > high) continue;
    if (!best || std::abs(x) < std::abs(*best)) best = x;
  }
  return best;
}

bool has_corner(const LensForm& form, const LensFace& face, std::size_t corner) {
  for (std::size_t i = face.run.from; i <= face.run.to; ++i) {
    if (corner_number(form, i) == corner) return true;
  }
  return false;
}

/// The lens with the free corners of a face on the curve.
std::optional<LensShape> through_points(const LensShape& lens, const LensFace& face,
                                        const std::vector<OutlinePoint>& curve) {
  const LensForm& form = lens.form();
  Eigen::VectorXd p = lens.parameters();
  for (const CornerMove& m : form.moves) {
    if (!has_corner(form, face, m.corner)) continue;
    const auto x = way_to_curve(curve, form.corners[m.corner], m.direction);
    if (!x || std::abs(*x) > lens.radius_mm()) return std::nullopt;
    p[static_cast<Eigen::Index>(m.parameter)] = *x;
  }
  LensShape shape = lens.with(std::move(p));
  if (!shape.is_valid()) return std::nullopt;
  return shape;
}

/// Of two free faces: the entry, which begins on the axis, and the last, which ends there.
struct EntryAndLast {
  std::size_t entry, last;
};

std::optional<EntryAndLast> entry_and_last(const LensForm& form) {
  const std::vector<std::size_t> free = form.free_faces();
  if (free.size() != 2) return std::nullopt;
  const auto is_on_axis = [&](std::size_t corner) {
    return form.corners[corner_number(form, corner)][0] == 0.0;
  };
  for (const auto& [entry, last] : {EntryAndLast{free[0], free[1]}, EntryAndLast{free[1], free[0]}}) {
    if (is_on_axis(form.faces[entry].run.from) && is_on_axis(form.faces[last].run.to))
      return EntryAndLast{entry, last};
  }
  return std::nullopt;
}

/// What solutions are sought for.
struct PointProblem {
  const MediumView& medium;
  const PointSource& source;
  const PrescribedAngle& angle;
};

/// The lens with the four solutions in the place of a face.
std::vector<LensShape> solutions(const LensShape& lens, std::size_t face, const PointProblem& problem) {
  std::vector<LensShape> out;
  const auto meridian = meridian_rays(lens, face, problem.medium, problem.source);
  if (meridian.size() < 16 || !(meridian.back().flux > 0.0)) return out;
  for (const bool from_axis : {true, false}) {
    for (const double side : {1.0, -1.0}) {
      const auto points = face_points(meridian, problem.angle, problem.medium.index, side, from_axis);
      if (points.empty()) continue;
      if (auto shape = through_points(lens, lens.form().faces[face], points))
        out.push_back(std::move(*shape));
    }
  }
  return out;
}

/// The start with its entry risen as a paraboloid by `depth_mm` on the axis, and the other face with it.
LensShape domed(const LensShape& start, const LensFace& entry, double depth_mm) {
  const LensForm& form = start.form();
  const std::size_t rim = corner_number(form, entry.run.to);
  Eigen::VectorXd p = start.parameters();
  for (const CornerMove& m : form.moves) {
    const double radius = has_corner(form, entry, m.corner) ? form.corners[rim][0] : start.radius_mm();
    const double x = form.corners[m.corner][0] / radius;
    if (!(x < 1.0)) continue;
    p[static_cast<Eigen::Index>(m.parameter)] += depth_mm * (1.0 - x * x) * m.direction[1];
  }
  return start.with(std::move(p));
}

}  // namespace

std::vector<LensShape> zero_etendue_lenses(const LensShape& start, const MediumView& medium,
                                           const PointSource& source, const PrescribedAngle& angle) {
  const LensForm& form = start.form();
  const PointProblem problem{medium, source, angle};
  if (form.free_faces().size() == 1) return solutions(start, form.free_faces().front(), problem);
  std::vector<LensShape> out;
  const auto faces = entry_and_last(form);
  if (!faces) return out;
  for (const double share : kDomes) {
    const LensShape dome = domed(start, form.faces[faces->entry], share * start.radius_mm());
    if (!dome.is_valid()) continue;
    for (LensShape& s : solutions(dome, faces->last, problem)) out.push_back(std::move(s));
  }
  return out;
}

}  // namespace lucerna
