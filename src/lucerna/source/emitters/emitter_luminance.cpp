// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/emitters/emitter_luminance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/source/emitters/led_emitter.h"

namespace lucerna {

namespace {

/// pdf_etendue of Lambertian light of unit flux from `area_mm2`.
double lambertian_pdf(double area_mm2) { return 1.0 / (std::numbers::pi * area_mm2); }

/// Light to +z from z = 0, where `pdf(x, y)` is its density.
template <class Pdf>
std::optional<LineLight> from_plane(const Ray& ray, const Pdf& pdf) {
  if (!(ray.direction.z() > 0.0)) return std::nullopt;
  const double t = -ray.origin_mm.z / ray.direction.z();
  const Vec3 p = ray.at(t);
  const double density = pdf(p.x, p.y);
  return density > 0.0 ? std::optional(LineLight{t, density}) : std::nullopt;
}

double disk_pdf(double radius_mm, double x, double y) {
  return x * x + y * y <= radius_mm * radius_mm ? lambertian_pdf(std::numbers::pi * radius_mm * radius_mm)
                                                : 0.0;
}

double led_pdf(double x, double y) {
  using namespace led_emitter;
  double pdf = kStrayShare * disk_pdf(kPackageRadiusMm, x, y);
  for (std::size_t die = 0; die < kDieShare.size(); ++die) {
    const double cx = kPitchMm * (static_cast<double>(die % 2) - 0.5);
    const double cy = kPitchMm * (static_cast<double>(die / 2) - 0.5);
    if (std::abs(x - cx) <= 0.5 && std::abs(y - cy) <= 0.5)
      pdf += (1.0 - kStrayShare) * kDieShare[die] * lambertian_pdf(1.0);
  }
  return pdf;
}

/// Light from the outside of a body, where the line leaves it.
std::optional<LineLight> from_outside(const std::optional<double>& exit_mm, double area_mm2) {
  if (!exit_mm) return std::nullopt;
  return LineLight{*exit_mm, lambertian_pdf(area_mm2)};
}

std::optional<LineLight> from_cylinder(const EmitterShape& s, const Ray& ray) {
  // Its ends do not shine: the lateral surface of an endless one, as far as this one goes.
  const Vec3 across{ray.direction.x(), ray.direction.y(), 0.0};
  if (across.x == 0.0 && across.y == 0.0) return std::nullopt;
  const auto inside = detail::inside_round({ray.origin_mm.x, ray.origin_mm.y, 0.0}, across, s.radius_mm);
  if (!inside || std::abs(ray.at(inside->far).z) > 0.5 * s.length_mm) return std::nullopt;
  return from_outside(inside->far, 2.0 * std::numbers::pi * s.radius_mm * s.length_mm);
}

}  // namespace

bool emitter_has_luminance(EmitterKind kind) {
  switch (kind) {
    case EmitterKind::disk:
    case EmitterKind::rectangle:
    case EmitterKind::cylinder:
    case EmitterKind::sphere:
    case EmitterKind::led:
      return true;
    default:
      return false;
  }
}

std::optional<LineLight> emitter_light(const EmitterShape& s, const Ray& ray) {
  switch (s.kind) {
    case EmitterKind::disk:
      return from_plane(ray, [&](double x, double y) { return disk_pdf(s.radius_mm, x, y); });
    case EmitterKind::rectangle:
      return from_plane(ray, [&](double x, double y) {
        const bool on = std::abs(x) <= 0.5 * s.width_mm && std::abs(y) <= 0.5 * s.height_mm;
        return on ? lambertian_pdf(s.width_mm * s.height_mm) : 0.0;
      });
    case EmitterKind::cylinder:
      return from_cylinder(s, ray);
    case EmitterKind::sphere:
      return from_outside(BoundingSurface::sphere(s.radius_mm).exit_distance_mm(ray),
                          4.0 * std::numbers::pi * s.radius_mm * s.radius_mm);
    case EmitterKind::led:
      return from_plane(ray, led_pdf);
    default:
      return std::nullopt;
  }
}

double emitter_reach_mm(const EmitterShape& s) {
  switch (s.kind) {
    case EmitterKind::rectangle:
      return 0.5 * std::hypot(s.width_mm, s.height_mm);
    case EmitterKind::cylinder:
      return std::hypot(s.radius_mm, 0.5 * s.length_mm);
    case EmitterKind::led:
      return led_emitter::kPackageRadiusMm;
    default:
      return s.radius_mm;
  }
}

}  // namespace lucerna
