// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/model/model_etendue.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/rayset/data/halves.h"
#include "lucerna/rayset/data/subset.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source/emitters/luminance_source.h"

namespace lucerna {

namespace {

struct RayDensity {
  double density = 0.0, weight = 0.0;
};

/// Density of each ray that has flux, falling.
template <class Density>
std::vector<RayDensity> sorted_by(const Density& density, const RayBlock& rays) {
  std::vector<RayDensity> ray_densities(rays.size());
  parallel_blocks(rays.size(), 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      ray_densities[i] = {density(rays.ray(i)), static_cast<double>(rays.weight[i])};
  });
  std::erase_if(ray_densities, [](const RayDensity& j) { return !(j.weight > 0.0); });
  std::sort(ray_densities.begin(), ray_densities.end(),
            [](const RayDensity& a, const RayDensity& b) { return a.density > b.density; });
  return ray_densities;
}

/// The same by a model's density; nothing where it has none (rays through one point or line).
std::vector<RayDensity> sorted_densities(const SourceModel& model, const RayBlock& rays) {
  if (rays.empty()) return {};
  try {
    model.pdf_etendue(rays.ray(0));
  } catch (const InputError&) {
    return {};
  }
  return sorted_by([&](const Ray& ray) { return model.pdf_etendue(ray); }, rays);
}

/// All light on the line of a ray: what a mirror sees in it.
double density_on_line(const LuminanceSource& source, const Ray& ray) {
  std::vector<LineLight> lights;
  source.add_light_on(ray, lights);
  double density = 0.0;
  for (const LineLight& light : lights) density += light.pdf_etendue;
  return density;
}

/// The étendue of regions of falling density from rays drawn from it, their flux from `held_out`.
EtendueCurve curve_of(std::vector<RayDensity> drawn, const std::vector<RayDensity>& held_out) {
  // Rays whose start or direction lost its place to rounding have no density; they stand for their
  // neighbours.
  std::erase_if(drawn, [](const RayDensity& j) { return !(j.density > 0.0); });
  double total = 0.0, brighter = 0.0, etendue = 0.0;
  for (const RayDensity& held_out_ray : held_out) total += held_out_ray.weight;
  if (drawn.empty() || !(total > 0.0)) return {};
  std::vector<EtendueCurve::Point> curve{{0.0, 0.0}};
  std::size_t next = 0;
  for (std::size_t i = 0; i < drawn.size();) {
    const double density = drawn[i].density;
    // A leaf's rays are equally bright: all of them, then all of its judges.
    for (; i < drawn.size() && drawn[i].density == density; ++i)
      etendue += 1.0 / (density * static_cast<double>(drawn.size()));
    for (; next < held_out.size() && held_out[next].density >= density; ++next)
      brighter += held_out[next].weight;
    curve.push_back({brighter / total, etendue});
  }
  return EtendueCurve(std::move(curve));
}

}  // namespace

EtendueCurve etendue_curve(const SourceModel& model, std::uint64_t rays, std::uint64_t seed) {
  const RayBlock drawn =
      draw_rays(model, Sequence(SequenceKind::random, seed), static_cast<std::size_t>(rays));
  const std::vector<RayDensity> density = sorted_densities(model, drawn);
  return curve_of(density, density);
}

std::optional<EtendueCurve> known_etendue_curve(const RaySource& source, std::uint64_t rays,
                                                std::uint64_t seed) {
  if (const auto* model = dynamic_cast<const SourceModel*>(&source)) return etendue_curve(*model, rays, seed);
  const LuminanceSource* light = luminance_of(source);
  if (light == nullptr) return std::nullopt;
  const RayBlock drawn =
      draw_rays(source, Sequence(SequenceKind::random, seed), static_cast<std::size_t>(rays));
  const auto density = sorted_by([&](const Ray& ray) { return density_on_line(*light, ray); }, drawn);
  return curve_of(density, density);
}

EtendueCurve searched_etendue_curve(const RayBlock& rays) {
  constexpr std::uint64_t kMaxRays = std::uint64_t{1} << 18;
  RayBlock some;
  some.resize(0, rays.extra.size());
  RaySubset(rays.size(), std::min<std::uint64_t>(kMaxRays, rays.size()), 1).select(rays, 0, some);
  auto [first_half, held_out] = ray_halves(some, 1);
  // Of a few rays a half may have none: then they judge themselves.
  if (!has_flux(first_half) || !has_flux(held_out)) first_half = held_out = some;
  RaySet train;
  train.header.set_flux(1.0);
  train.rays = std::move(first_half);
  AdaptiveOptions options;
  options.trees = 4;
  const auto model = compress_adaptive(train, options);
  const RayBlock drawn = draw_rays(*model, Sequence(SequenceKind::random, 1), 1 << 15);
  return curve_of(sorted_densities(*model, drawn), sorted_densities(*model, held_out));
}

}  // namespace lucerna
