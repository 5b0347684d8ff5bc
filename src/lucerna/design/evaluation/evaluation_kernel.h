// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "lucerna/design/evaluation/smooth_path.h"
#include "lucerna/design/evaluation/tent_view.h"
#include "lucerna/host_device.h"
#include "lucerna/scene.h"

namespace lucerna {

/// What one ray adds to an evaluation, on the CPU and on a GPU. Shape is a view of smooth_view.h.
template <class Shape>
struct EvaluationView {
  Shape shape;
  Aperture aperture;
  const ReflectanceEntry* reflectance = nullptr;
  std::uint32_t reflectance_entries = 0;
  TentBinsView bins;
  /// EvaluationOptions.
  bool derivatives = true, direct_light = true;
  double rim_mm = 0.0;

  LUCERNA_HD double reflected_share(const Path<Shape>& path) const {
    double share = 1.0;
    for (int i = 0; i < path.hits; ++i) {
      const auto& hit = path.hit[static_cast<std::size_t>(i)];
      const double cosine = -hit.m / length(hit.g);
      share *= reflectance_at(reflectance, reflectance_entries, cosine < 1.0 ? cosine : 1.0);
    }
    return share;
  }

  /// Follows one ray of `weight` and tells `sums` of it: sums.ended(end, kept, absorbed), sums.add(bin, flux)
  /// and, of derivatives, sums.row(bin).add(coefficient, value).
  template <class Sums>
  LUCERNA_HD void trace(const Vec3& origin, const Vec3& direction, double weight, Path<Shape>& path,
                        Sums& sums) const {
    SmoothTracer<Shape>(shape, aperture).trace(origin, direction, path);
    count(path, weight, sums);
  }

  /// What a path of `weight` adds to `sums`.
  template <class Sums>
  LUCERNA_HD void count(const Path<Shape>& path, double weight, Sums& sums) const {
    const double reflected_flux = weight * reflected_share(path);
    sums.ended(path.end, reflected_flux, weight - reflected_flux);
    const bool counts = path.end == PathEnd::reflected || (path.end == PathEnd::direct && direct_light);
    if (!counts) return;
    TentDeposit d;
    bins.deposit(path.origin, path.direction, d);
    for (int k = 0; k < d.n; ++k) {
      const auto i = static_cast<std::size_t>(k);
      sums.add(d.bin[i], reflected_flux * d.weight[i]);
    }
    if (!derivatives || d.n == 0 || path.hits == 0) return;
    differentiate(path, reflected_flux, d, sums);
    if (rim_mm <= 0.0) return;
    for (int i = 0; i < path.hits; ++i) rim_term(path, i, reflected_flux, d, sums);
  }

  /// The tents' change with every coefficient that a hit touches.
  template <class Sums>
  LUCERNA_HD void differentiate(const Path<Shape>& path, double energy, const TentDeposit& d,
                                Sums& sums) const {
    std::array<HitAdjoint, kMaxPathHits> by_u, by_v;
    const TentGradient in_u = bins.gradient_u(path.origin, path.direction);
    path_adjoint(path, path.hits - 1, in_u.direction, in_u.origin, by_u.data());
    if (!bins.is_rings()) {
      const TentGradient in_v = bins.gradient_v(path.origin, path.direction);
      path_adjoint(path, path.hits - 1, in_v.direction, in_v.origin, by_v.data());
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(path.hits); ++i) {
      std::array<double, Shape::kSupport> u, v{};
      const auto& local = path.hit[i].local;
      shape.gradient(local, by_u[i].alpha, by_u[i].beta, by_u[i].gamma, u.data());
      if (!bins.is_rings()) shape.gradient(local, by_v[i].alpha, by_v[i].beta, by_v[i].gamma, v.data());
      for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
        shape.add(local, energy * d.du[k], u.data(), energy * d.dv[k], v.data(), sums.row(d.bin[k]));
      }
    }
  }

  /// Light that the rim gains or loses as a hit moves: a strip of `rim_mm` inside it represents the rim.
  template <class Sums>
  LUCERNA_HD void rim_term(const Path<Shape>& path, int last, double energy, const TentDeposit& reflected,
                           Sums& sums) const {
    const auto& hit = path.hit[static_cast<std::size_t>(last)];
    const RimDistance rim = rim_distance(aperture, hit.x, hit.y);
    if (!(rim.inside_mm < rim_mm)) return;
    std::array<HitAdjoint, kMaxPathHits> by_place;
    path_adjoint(path, last, {}, rim.gradient, by_place.data());
    TentDeposit missed;
    if (last > 0 || direct_light) {
      const Vec3 at{hit.x, hit.y, smooth_point(shape, hit.x, hit.y).z_mm};
      bins.deposit(at, hit.d, missed);
    }
    const double density = energy / rim_mm;
    for (int i = 0; i <= last; ++i) {
      const auto& local = path.hit[static_cast<std::size_t>(i)].local;
      const HitAdjoint& by = by_place[static_cast<std::size_t>(i)];
      std::array<double, Shape::kSupport> place;
      shape.gradient(local, by.alpha, by.beta, by.gamma, place.data());
      add_rim(local, place, density, reflected, sums);
      add_rim(local, place, -density, missed, sums);
    }
  }

  template <class Sums>
  LUCERNA_HD void add_rim(const typename Shape::Local& local,
                          const std::array<double, Shape::kSupport>& place, double density,
                          const TentDeposit& to, Sums& sums) const {
    const std::array<double, Shape::kSupport> none{};
    for (std::size_t k = 0; k < static_cast<std::size_t>(to.n); ++k) {
      shape.add(local, density * to.weight[k], place.data(), 0.0, none.data(), sums.row(to.bin[k]));
    }
  }
};

}  // namespace lucerna
