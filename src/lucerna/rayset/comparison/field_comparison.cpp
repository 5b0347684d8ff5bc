// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/comparison/field_comparison.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/core/parallel/parallel_sort.h"
#include "lucerna/random.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/rayset/comparison/view_window.h"

namespace lucerna {

namespace {

constexpr std::size_t kFieldBlock = std::size_t{1} << 16;
constexpr double kMinRays = 1000.0;
/// Of the dealing out of rays: not the seed of any source.
constexpr std::uint64_t kAssignmentSeed = 0x9e3779b97f4a7c15u;

/// A ray on the focus plane; weights are relative to the mean of its set.
struct PlaneRay {
  float x_mm = 0.0f, y_mm = 0.0f, weight = 0.0f;
  bool of_test = false, assigned_to_test = false;
};

void append_plane_rays(const Views& views, const RayBlock& rays, bool of_test, double test_share,
                       std::vector<PlaneRay>& out) {
  const double mean = sum_of_weights(rays) / static_cast<double>(rays.size());
  if (!(mean > 0.0)) throw InputError("a set of rays without flux cannot be compared");
  const std::size_t before = out.size();
  out.resize(before + rays.size());
  parallel_blocks(rays.size(), kFieldBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      PlaneRay& ray = out[before + i];
      const auto at = views.coordinates(ViewKind::focus, rays.ray(i));
      if (!at) continue;  // weight 0
      ray.x_mm = static_cast<float>((*at)[0]);
      ray.y_mm = static_cast<float>((*at)[1]);
      ray.weight = static_cast<float>(static_cast<double>(rays.weight[i]) / mean);
      ray.of_test = of_test;
      ray.assigned_to_test = Rng(kAssignmentSeed + (of_test ? 1 : 0), i).uniform() < test_share;
    }
  });
}

/// Cells so far out that 32 bits do not hold them are one.
std::int32_t cell_number(float mm, double cell_mm) {
  return static_cast<std::int32_t>(std::clamp(std::floor(static_cast<double>(mm) / cell_mm), -2e9, 2e9));
}

struct Sums {
  std::array<double, 2> own{}, assigned{};  // of the reference, of the test
};

struct Keyed {
  std::int32_t x = 0, y = 0;
  std::uint32_t ray = 0;
};

PlaneDifference difference_at(const std::vector<PlaneRay>& rays, double cell_um) {
  std::vector<Keyed> keyed(rays.size());
  parallel_blocks(rays.size(), kFieldBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      keyed[i] = {cell_number(rays[i].x_mm, 1e-3 * cell_um), cell_number(rays[i].y_mm, 1e-3 * cell_um),
                  static_cast<std::uint32_t>(i)};
    }
  });
  parallel_sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
    return std::tie(a.x, a.y, a.ray) < std::tie(b.x, b.y, b.ray);
  });
  Sums total;
  const auto add = [&](Sums& sums, const PlaneRay& ray) {
    const double w = static_cast<double>(ray.weight);
    sums.own[ray.of_test] += w;
    sums.assigned[ray.assigned_to_test] += w;
  };
  for (const PlaneRay& ray : rays) add(total, ray);
  PlaneDifference result;
  result.cell_um = cell_um;
  const auto differ = [](const std::array<double, 2>& part, const std::array<double, 2>& whole) {
    return whole[0] > 0.0 && whole[1] > 0.0 ? std::abs(part[1] / whole[1] - part[0] / whole[0]) : 0.0;
  };
  for (std::size_t i = 0; i < keyed.size();) {
    Sums cell;
    std::size_t end = i;
    for (; end < keyed.size() && keyed[end].x == keyed[i].x && keyed[end].y == keyed[i].y; ++end)
      add(cell, rays[keyed[end].ray]);
    result.l1 += differ(cell.own, total.own);
    result.floor += differ(cell.assigned, total.assigned);
    i = end;
  }
  return result;
}

/// Shares of a picture's cells, and their counting noise.
struct Picture {
  std::vector<double> share, variance;
};

CrossCorrelation correlate(const Picture& p, const Picture& q) {
  const auto n = static_cast<double>(p.share.size());
  double mean_p = 0.0, mean_q = 0.0;
  for (std::size_t i = 0; i < p.share.size(); ++i) {
    mean_p += p.share[i] / n;
    mean_q += q.share[i] / n;
  }
  double pp = 0.0, qq = 0.0, pq = 0.0, noise_p = 0.0, noise_q = 0.0;
  for (std::size_t i = 0; i < p.share.size(); ++i) {
    const double a = p.share[i] - mean_p, b = q.share[i] - mean_q;
    pp += a * a;
    qq += b * b;
    pq += a * b;
    noise_p += p.variance[i];
    noise_q += q.variance[i];
  }
  CrossCorrelation result;
  result.value = pp > 0.0 && qq > 0.0 ? pq / std::sqrt(pp * qq) : 0.0;
  // The pattern itself has the reference's sum of squares less its noise; each set's own noise adds to it.
  const double signal = std::max(0.0, pp - noise_p);
  result.noise_limit = pp > 0.0 ? signal / std::sqrt((signal + noise_p) * (signal + noise_q)) : 1.0;
  return result;
}

/// Without the cell for the rest.
Picture picture_of(const std::vector<double>& weights, const std::vector<double>& squares, double total) {
  Picture picture;
  for (std::size_t i = 0; i + 1 < weights.size(); ++i) {
    picture.share.push_back(weights[i] / total);
    picture.variance.push_back(squares[i] / (total * total));
  }
  return picture;
}

bool has_light(const Picture& picture) {
  return std::any_of(picture.share.begin(), picture.share.end(), [](double x) { return x > 0.0; });
}

/// Where and how strongly a ray counts in some picture.
struct Mark {
  std::array<double, 4> at{};
  double weight = 0.0;
};

/// Counts of the marks that `mark(ray)` gives in a window; the last cell is the rest.
struct MarkCounts {
  std::vector<double> weights, squares;
};
template <class MarkOf>
MarkCounts count_marks(const RayBlock& rays, const ViewWindow& window, std::size_t cells,
                       const MarkOf& mark) {
  const auto parts =
      parallel_map_blocks<MarkCounts>(rays.size(), 4 * kFieldBlock, [&](std::size_t first, std::size_t last) {
        MarkCounts part{std::vector<double>(cells + 1, 0.0), std::vector<double>(cells + 1, 0.0)};
        for (std::size_t i = first; i < last; ++i) {
          const auto m = mark(rays.ray(i), static_cast<double>(rays.weight[i]));
          if (!m) continue;
          const std::size_t cell = cell_of(window, m->at);
          part.weights[cell] += m->weight;
          part.squares[cell] += m->weight * m->weight;
        }
        return part;
      });
  MarkCounts all{std::vector<double>(cells + 1, 0.0), std::vector<double>(cells + 1, 0.0)};
  for (const MarkCounts& part : parts) {
    for (std::size_t i = 0; i <= cells; ++i) {
      all.weights[i] += part.weights[i];
      all.squares[i] += part.squares[i];
    }
  }
  return all;
}

/// A window about what `mark` gives of the reference, the axes' cells as they are set in `window`; how many
/// rays that were.
template <class MarkOf>
std::size_t fit_window_to(const RayBlock& rays, double min_mm, const MarkOf& mark, ViewWindow& window) {
  WindowPoints points;
  std::vector<double> weights;
  for (const std::size_t i : stratified_choice(rays.size(), Views::kWindowRays * 4)) {
    const auto m = mark(rays.ray(i), static_cast<double>(rays.weight[i]));
    if (!m || !(m->weight > 0.0)) continue;
    points.push_back(m->at);
    weights.push_back(m->weight);
  }
  if (!points.empty()) fit_view_window(points, weights, {min_mm, min_mm, 0.0, 0.0}, window);
  return points.size();
}

/// A length below which float32 rays have no structure (as in view.cpp).
double min_width_mm(const Views& views) {
  return 1e-4 * std::max({views.frame().radius_mm, length(views.frame().world_from_view.origin_mm()), 1e-3});
}

}  // namespace

std::vector<PlaneDifference> focus_plane_differences(const Views& views, const RayBlock& reference,
                                                     const RayBlock& test, std::span<const double> cells_um) {
  if (reference.empty() || test.empty()) throw InputError("a set without rays cannot be compared");
  const double share = static_cast<double>(test.size()) /
                       (static_cast<double>(test.size()) + static_cast<double>(reference.size()));
  std::vector<PlaneRay> rays;
  append_plane_rays(views, reference, false, share, rays);
  append_plane_rays(views, test, true, share, rays);
  std::vector<PlaneDifference> result;
  for (const double cell_um : cells_um) {
    if (!(cell_um > 0.0) || !std::isfinite(cell_um)) {
      throw UsageError(fmt::format("cells of {} um; a size > 0 is expected", cell_um));
    }
    result.push_back(difference_at(rays, cell_um));
  }
  return result;
}

FieldCorrelations field_correlations(const ViewCounts& reference, const ViewCounts& test,
                                     const RayBlock& reference_rays, const RayBlock& test_rays) {
  FieldCorrelations result;
  const auto of = [](const ViewCounts& counts, ViewKind kind) {
    return picture_of(counts.weights(kind), counts.squares(kind), counts.total_weight());
  };
  for (const ViewKind kind : {ViewKind::near, ViewKind::far}) {
    const Picture p = of(reference, kind);
    if (has_light(p)) (kind == ViewKind::near ? result.near : result.far) = correlate(p, of(test, kind));
  }
  const Views& views = reference.views();
  const Frame view_from_world = views.frame().world_from_view.inverse();
  const double z = views.frame().near_plane_mm + std::max(3.0, 3.0 * views.frame().radius_mm);
  result.mid_plane_mm = z;
  const auto mark = [&](const Ray& ray, double weight) -> std::optional<Mark> {
    const Vec3 p = view_from_world.point(ray.origin_mm), d = view_from_world.vector(ray.direction);
    if (!(d.z > 0.0) || !(weight > 0.0)) return std::nullopt;
    const double t = (z - p.z) / d.z;
    return Mark{{p.x + t * d.x, p.y + t * d.y, 0.0, 0.0}, weight};
  };
  ViewWindow window;
  window.cells = {64, 64, 1, 1};
  if (fit_window_to(reference_rays, min_width_mm(views), mark, window) == 0) return result;
  const std::size_t cells = window.cells[0] * window.cells[1];
  const MarkCounts p = count_marks(reference_rays, window, cells, mark),
                   q = count_marks(test_rays, window, cells, mark);
  result.mid = correlate(picture_of(p.weights, p.squares, reference.total_weight()),
                         picture_of(q.weights, q.squares, test.total_weight()));
  return result;
}

std::string_view to_string(Viewpoint from) { return from == Viewpoint::front ? "front" : "side"; }

std::optional<LuminanceImage> luminance_image(const Views& views, const RayBlock& reference,
                                              const RayBlock& test, Viewpoint from) {
  const Frame& view = views.frame().world_from_view;
  // Both images have the view frame's y axis upwards.
  const Frame world_from_look =
      from == Viewpoint::front ? view : Frame(-1.0 * view.ez(), view.ey(), view.ex(), view.origin_mm());
  const Frame look_from_world = world_from_look.inverse();
  const double min_cosine = std::cos(kLookCone_rad);
  const auto mark = [&](const Ray& ray, double weight) -> std::optional<Mark> {
    const Vec3 d = look_from_world.vector(ray.direction);
    if (!(d.z > min_cosine) || !(weight > 0.0)) return std::nullopt;
    const Vec3 p = look_from_world.point(ray.origin_mm);
    const double t = -p.z / d.z;
    return Mark{{p.x + t * d.x, p.y + t * d.y, 0.0, 0.0}, weight / d.z};
  };
  LuminanceImage image;
  constexpr std::size_t n = LuminanceImage::kCells;
  image.window.cells = {n, n, 1, 1};
  if (static_cast<double>(fit_window_to(reference, min_width_mm(views), mark, image.window)) < kMinRays) {
    return std::nullopt;
  }
  double half = 0.0;
  for (std::size_t k = 0; k < 2; ++k)
    half = std::max(half, 0.5 * (image.window.high[k] - image.window.low[k]));
  for (std::size_t k = 0; k < 2; ++k) {
    const double middle = 0.5 * (image.window.low[k] + image.window.high[k]);
    image.window.low[k] = middle - half;
    image.window.high[k] = middle + half;
  }
  const double cell_mm = 2.0 * half / n, cone_sr = 2.0 * std::numbers::pi * (1.0 - min_cosine);
  const auto picture = [&](const RayBlock& rays) {
    std::vector<double> cells = count_marks(rays, image.window, n * n, mark).weights;
    const double total = sum_of_weights(rays);
    for (std::size_t i = 0; i < n * n; ++i) cells[i] /= total * cell_mm * cell_mm * cone_sr;
    cells[n * n] /= total;
    return cells;
  };
  image.reference = picture(reference);
  image.test = picture(test);
  return image;
}

}  // namespace lucerna
