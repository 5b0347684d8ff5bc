// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"
#include "lucerna/core/random.h"
#include "lucerna/rayset/ray_statistics.h"

namespace lucerna {

namespace {

constexpr std::size_t kBlock = std::size_t{1} << 16;
constexpr std::array<std::string_view, 5> kViewNames{"far", "near", "focus", "beam", "four_d"};
/// Shares that design.md section 5 fixes.
constexpr double kWindowShare = 0.99, kRadiusShare = 0.98, kLeastMeanLength = 0.2, kNearPlaneGap_mm = 1.0;
/// Share of the flux cut off at each end of an axis to find the window's proportions, before it is scaled to
/// 99 %.
constexpr double kTailShare = 0.0025;
/// A window is never narrower than this share of the size that rounding of float32 rays is proportional to:
/// rays through one point then share a cell instead of showing their rounding (6e-8) as structure.
constexpr double kLeastWidth = 1e-4;
/// Collimators clear the starts by this factor, so that no start lies on the mirror.
constexpr double kClearance = 1.02;

struct Weighted {
  double value, weight;
};

/// Smallest value with at least `share` of the weight at or below it. Sorts `items`.
double quantile(std::vector<Weighted>& items, double share) {
  std::sort(items.begin(), items.end(),
            [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double total = 0.0, sum = 0.0;
  for (const Weighted& item : items) total += item.weight;
  for (const Weighted& item : items) {
    sum += item.weight;
    if (sum >= share * total) return item.value;
  }
  return items.empty() ? 0.0 : items.back().value;
}

/// The rays that fix quantiles: all, or one at random out of each of kWindowRays equal runs.
std::vector<std::size_t> window_rays(const RayBlock& rays) {
  const std::size_t n = rays.size(), m = std::min(n, Views::kWindowRays);
  std::vector<std::size_t> chosen(m);
  for (std::size_t i = 0; i < m; ++i) {
    const double u = m == n ? 0.0 : Rng(0, i).uniform();
    chosen[i] = std::min(n - 1, static_cast<std::size_t>((static_cast<double>(i) + u) *
                                                         static_cast<double>(n) / static_cast<double>(m)));
  }
  return chosen;
}

struct Reach {
  double along_mm = -1e300;  // farthest start along a
  double focal_mm = 0.0;     // least focal length that has every start inside the paraboloid
};

Reach reach_of(const RayBlock& rays, const Frame& view_from_world) {
  const auto parts =
      parallel_map_blocks<Reach>(rays.size(), kBlock, [&](std::size_t first, std::size_t last) {
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
  const ViewWindow& w = window(kind);
  std::size_t index = 0, cells = 1;
  bool inside = true;
  for (std::size_t k = 0; k < w.dimensions; ++k) {
    const double place = ((*x)[k] - w.low[k]) / (w.high[k] - w.low[k]);
    if (place >= 0.0 && place <= 1.0) {
      const auto n = static_cast<double>(w.cells[k]);
      index = index * w.cells[k] + std::min(w.cells[k] - 1, static_cast<std::size_t>(place * n));
    } else {
      inside = false;  // NaN comes here too
    }
    cells *= w.cells[k];
  }
  return inside ? index : cells;
}

namespace {

using Points = std::vector<std::array<double, 4>>;

std::vector<Weighted> axis_values(const Points& points, const std::vector<double>& weights,
                                  std::size_t axis) {
  std::vector<Weighted> values(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = {points[i][axis], weights[i]};
  return values;
}

/// Fits the window to the points: proportions from the axes' own tails, then one scale that holds
/// kWindowShare. `least[k]` is the smallest half width of axis k.
void fit_window(const Points& points, const std::vector<double>& weights, const std::array<double, 4>& least,
                ViewWindow& window) {
  std::array<double, 4> middle{}, half{};
  for (std::size_t k = 0; k < window.dimensions; ++k) {
    auto values = axis_values(points, weights, k);
    middle[k] = quantile(values, 0.5);
    half[k] =
        std::max(quantile(values, 1.0 - kTailShare) - middle[k], middle[k] - quantile(values, kTailShare));
    half[k] = std::max(half[k], least[k]);
  }
  std::vector<Weighted> scales(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    double scale = 0.0;
    for (std::size_t k = 0; k < window.dimensions; ++k) {
      scale = std::max(scale, std::abs(points[i][k] - middle[k]) / half[k]);
    }
    scales[i] = {scale, weights[i]};
  }
  // A hair wider, so that the ray that fixes the edge lies inside in spite of rounding.
  const double scale = quantile(scales, kWindowShare) * (1.0 + 1e-9);
  for (std::size_t k = 0; k < window.dimensions; ++k) {
    const double width = std::max(scale * half[k], least[k]);
    window.low[k] = middle[k] - width;
    window.high[k] = middle[k] + width;
    if (width > least[k]) continue;
    // Nothing to resolve: half a cell aside, so that the one value lies inside a cell and not on a border.
    const double shift = width / static_cast<double>(window.cells[k]);
    window.low[k] -= shift;
    window.high[k] -= shift;
  }
}

/// The far field's window is a cap about a: the cosine alone is cut, the azimuth is whole.
void fit_cap(const Points& points, const std::vector<double>& weights, ViewWindow& window) {
  auto cosines = axis_values(points, weights, 0);
  window.low[0] = std::min(quantile(cosines, 1.0 - kWindowShare) - 1e-12, 1.0 - kLeastWidth * kLeastWidth);
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
  const Direction axis = length(mean) < kLeastMeanLength ? Direction() : Direction::from(mean);
  frame_.world_from_view = Frame::from_axis(axis, 0.0, summary.virtual_focus->point_mm);
  view_from_world_ = frame_.world_from_view.inverse();
  const Reach reach = reach_of(reference, view_from_world_);
  frame_.near_plane_mm = reach.along_mm + kNearPlaneGap_mm;

  const std::vector<std::size_t> chosen = window_rays(reference);
  std::vector<Weighted> radii(chosen.size());
  double farthest = 0.0;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double r = length(view_from_world_.point(reference.origin_mm(chosen[i])));
    radii[i] = {r, static_cast<double>(reference.weight[chosen[i]])};
    farthest = std::max(farthest, r);
  }
  frame_.radius_mm = quantile(radii, kRadiusShare);
  // Rays that all start at F need some mirror: the beam of a point source does not depend on its size.
  const double size_mm = std::max({farthest, length(frame_.world_from_view.origin_mm()), 1e-3});
  frame_.focal_mm = std::max({1.25 * frame_.radius_mm, kClearance * reach.focal_mm, kLeastWidth * size_mm});

  for (const ViewKind kind : kViewKinds) {
    ViewWindow& w = windows_[static_cast<std::size_t>(kind)];
    w.dimensions = kind == ViewKind::four_d ? 4 : 2;
    if (kind == ViewKind::far) w.cells = {48, 96, 1, 1};
    if (kind == ViewKind::near) w.cells = {32, 32, 1, 1};
    if (kind == ViewKind::focus || kind == ViewKind::beam) w.cells = {64, 64, 1, 1};
    if (kind == ViewKind::four_d) w.cells = {8, 8, 8, 8};
    Points points;
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
      const double plane = kLeastWidth * size_mm;
      const bool cosines = kind == ViewKind::beam;
      fit_window(points, weights,
                 {cosines ? kLeastWidth : plane, cosines ? kLeastWidth : plane, kLeastWidth, kLeastWidth}, w);
    }
  }
}

}  // namespace lucerna
