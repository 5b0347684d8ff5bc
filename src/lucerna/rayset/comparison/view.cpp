// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/rayset/comparison/view_window.h"

namespace lucerna {

namespace {

constexpr std::size_t kViewBlock = std::size_t{1} << 16;
constexpr std::array<std::string_view, 5> kViewNames{"far", "near", "focus", "beam", "four_d"};
/// Shares that docs/theory/comparison.md fixes.
constexpr double kRadiusShare = 0.98, kMinMeanLength = 0.2, kNearPlaneGap_mm = 1.0;
/// A window is never narrower than this share of the size that rounding of float32 rays is proportional to:
/// rays through one point then share a cell instead of showing their rounding (6e-8) as structure.
constexpr double kMinWidth = 1e-4;
/// Collimators clear the starts by this factor, so that no start lies on the mirror.
constexpr double kClearance = 1.02;

struct Reach {
  double along_mm = -1e300;  // farthest start along a
  double focal_mm = 0.0;     // least focal length that has every start inside the paraboloid
};

Reach reach_of(const RayBlock& rays, const Frame& view_from_world) {
  const auto parts =
      parallel_map_blocks<Reach>(rays.size(), kViewBlock, [&](std::size_t first, std::size_t last) {
        Reach reach;
        for (std::size_t i = first; i < last; ++i) {
          if (!(rays.weight[i] > 0.0f)) continue;
          const Vec3 p = view_from_world.point(rays.origin_mm(i));
          reach.along_mm = std::max(reach.along_mm, p.z);
          reach.focal_mm = std::max(reach.focal_mm, 0.5 * (length(p) + p.z));
        }
        return reach;
      });
  Reach all;
  for (const Reach& part : parts) {
    all.along_mm = std::max(all.along_mm, part.along_mm);
    all.focal_mm = std::max(all.focal_mm, part.focal_mm);
  }
  return all;
}

std::optional<std::array<double, 4>> on_plane(const Vec3& p, const Vec3& d, double z, bool ahead) {
  if (ahead ? d.z <= 0.0 : d.z == 0.0) return std::nullopt;
  const double t = (z - p.z) / d.z;
  return std::array<double, 4>{p.x + t * d.x, p.y + t * d.y, d.x, d.y};
}

/// The paraboloid |P| = 2 f - P.z about the origin, which opens along -z.
std::optional<std::array<double, 4>> reflected_cosines(const Vec3& p, const Vec3& d, double focal_mm) {
  const double rim = 2.0 * focal_mm - p.z;
  const double a = d.x * d.x + d.y * d.y, b = dot(p, d) + rim * d.z, c = dot(p, p) - rim * rim;
  if (!(c < 0.0) || rim <= 0.0) return std::nullopt;
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  const double t = b > 0.0 ? -c / (b + root) : (root - b) / a;
  if (!std::isfinite(t)) return std::nullopt;
  const Vec3 hit = p + t * d;
  const Vec3 normal = hit / length(hit) + Vec3{0.0, 0.0, 1.0};
  const double scale = 2.0 * dot(d, normal) / dot(normal, normal);
  if (!std::isfinite(scale)) return std::nullopt;
  return std::array<double, 4>{d.x - scale * normal.x, d.y - scale * normal.y, 0.0, 0.0};
}

}  // namespace

std::string_view to_string(ViewKind kind) { return kViewNames[static_cast<std::size_t>(kind)]; }

std::optional<std::array<double, 4>> Views::coordinates(ViewKind kind, const Ray& ray) const {
  const Vec3 p = view_from_world_.point(ray.origin_mm), d = view_from_world_.vector(ray.direction);
  switch (kind) {
    case ViewKind::far: {
      double turn = std::atan2(d.y, d.x) / (2.0 * std::numbers::pi);
      if (turn < 0.0) turn += 1.0;
      return std::array<double, 4>{d.z, turn, 0.0, 0.0};
    }
    case ViewKind::near:
      return on_plane(p, d, frame_.near_plane_mm, true);
    case ViewKind::focus:
    case ViewKind::four_d:
      return on_plane(p, d, 0.0, false);
    case ViewKind::beam:
      return reflected_cosines(p, d, frame_.focal_mm);
  }
  return std::nullopt;
}

std::size_t Views::cell_count(ViewKind kind) const {
  const ViewWindow& w = window(kind);
  std::size_t cells = 1;
  for (std::size_t k = 0; k < w.dimensions; ++k) cells *= w.cells[k];
  return cells + 1;
}

std::optional<std::size_t> Views::cell(ViewKind kind, const Ray& ray) const {
  const auto x = coordinates(kind, ray);
  if (!x) return std::nullopt;
  return cell_of(window(kind), *x);
}

namespace {

/// The far field's window is a cap about a: the cosine alone is cut, the azimuth is whole.
void fit_cap(const WindowPoints& points, const std::vector<double>& weights, ViewWindow& window) {
  std::vector<WeightedValue> cosines(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) cosines[i] = {points[i][0], weights[i]};
  window.low[0] =
      std::min(weighted_quantile(cosines, 1.0 - kViewWindowShare) - 1e-12, 1.0 - kMinWidth * kMinWidth);
  window.high[0] = 1.0 + 1e-12;
  window.low[1] = 0.0;
  window.high[1] = 1.0;
}

}  // namespace

Views::Views(const RayBlock& reference) {
  const RaySummary summary = summarize(reference);
  if (!summary.virtual_focus || !summary.mean_direction)
    throw InputError("no rays with flux to compare with");
  const Vec3 mean = *summary.mean_direction;
  const Direction axis = length(mean) < kMinMeanLength ? Direction() : Direction::from(mean);
  frame_.world_from_view = Frame::from_axis(axis, 0.0, summary.virtual_focus->point_mm);
  view_from_world_ = frame_.world_from_view.inverse();
  const Reach reach = reach_of(reference, view_from_world_);
  frame_.near_plane_mm = reach.along_mm + kNearPlaneGap_mm;

  const std::vector<std::size_t> chosen = stratified_choice(reference.size(), kWindowRays);
  std::vector<WeightedValue> radii(chosen.size());
  double farthest = 0.0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double r = length(view_from_world_.point(reference.origin_mm(chosen[i])));
    radii[i] = {r, static_cast<double>(reference.weight[chosen[i]])};
    farthest = std::max(farthest, r);
  }
  frame_.radius_mm = weighted_quantile(radii, kRadiusShare);
  // Rays that all start at F need some mirror: the beam of a point source does not depend on its size.
  const double size_mm = std::max({farthest, length(frame_.world_from_view.origin_mm()), 1e-3});
  frame_.focal_mm = std::max({1.25 * frame_.radius_mm, kClearance * reach.focal_mm, kMinWidth * size_mm});

  for (const ViewKind kind : kViewKinds) {
    ViewWindow& w = windows_[static_cast<std::size_t>(kind)];
    w.dimensions = kind == ViewKind::four_d ? 4 : 2;
    if (kind == ViewKind::far) w.cells = {48, 96, 1, 1};
    if (kind == ViewKind::near) w.cells = {32, 32, 1, 1};
    if (kind == ViewKind::focus || kind == ViewKind::beam) w.cells = {64, 64, 1, 1};
    if (kind == ViewKind::four_d) w.cells = {8, 8, 8, 8};
    WindowPoints points;
    std::vector<double> weights;
    for (const std::size_t i : chosen) {
      const auto x = coordinates(kind, reference.ray(i));
      if (!x || !(reference.weight[i] > 0.0f)) continue;
      points.push_back(*x);
      weights.push_back(static_cast<double>(reference.weight[i]));
    }
    if (kind == ViewKind::far) {
      fit_cap(points, weights, w);
    } else {
      const double plane = kMinWidth * size_mm;
      const bool cosines = kind == ViewKind::beam;
      fit_view_window(points, weights,
                      {cosines ? kMinWidth : plane, cosines ? kMinWidth : plane, kMinWidth, kMinWidth}, w);
    }
  }
}

}  // namespace lucerna
