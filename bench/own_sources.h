// SPDX-License-Identifier: Apache-2.0
// Sources that no method was tuned on, for bench_adaptive: dome, tilted, strip, arc, egg, ghost, remote; and
// the twin of the measured LED (led_twin.h).
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>

#include "led_twin.h"
#include "lucerna/geometry.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/warp.h"

namespace lucerna::bench {

struct WeightedRay {
  Ray ray;
  double weight = 1.0;
};
using OwnNumbers = std::array<double, 5>;

/// A 1 mm die in a hemisphere of index 1.5 and radius 1.4 mm; Fresnel transmission as weight; what is totally
/// reflected is lost. Caught on a sphere of 3 mm.
inline WeightedRay dome_ray(const OwnNumbers& u) {
  constexpr double kIndex = 1.5, kRadius = 1.4;
  const Ray inside{{u[2] - 0.5, u[3] - 0.5, 0.0}, warp::cosine_hemisphere(u[0], u[1])};
  const double t = *BoundingSurface::sphere(kRadius).exit_distance_mm(inside);
  const Vec3 p = inside.at(t), n = p / kRadius;
  const double ci = dot(inside.direction.vec(), n), sine2 = kIndex * kIndex * (1.0 - ci * ci);
  if (sine2 >= 1.0) return {{p, Direction::from_unit(n)}, 0.0};
  const double ct = std::sqrt(1.0 - sine2);
  const Direction d = Direction::from(kIndex * inside.direction.vec() + (ct - kIndex * ci) * n);
  const double rs = (kIndex * ci - ct) / (kIndex * ci + ct), rp = (kIndex * ct - ci) / (kIndex * ct + ci);
  const Ray out{p, d};
  const double far = *BoundingSurface::sphere(3.0).exit_distance_mm(out);
  return {{out.at(far), d}, 1.0 - 0.5 * (rs * rs + rp * rp)};
}

/// What a dome in the model cannot copy: a die off the axis and below the centre of an ellipsoid of
/// revolution (1.3 mm across, 1.8 mm high) of index 1.41, with a dim phosphor about it. Fresnel transmission
/// as weight; caught on a sphere of 4 mm.
inline WeightedRay ellipsoidal_dome_ray(const OwnNumbers& u) {
  constexpr double kIndex = 1.41, kAcross = 1.3, kUp = 1.8, kDepth = -0.3;
  const bool die = u[4] < 0.8;
  const double x = die ? 0.15 + 0.8 * (u[2] - 0.5) : 1.6 * (u[2] - 0.5);
  const double y = die ? -0.1 + 0.5 * (u[3] - 0.5) : 1.2 * (u[3] - 0.5);
  const Ray inside{{x, y, kDepth}, warp::cosine_hemisphere(u[0], u[1])};
  const auto stretched = [](const Vec3& v) { return Vec3{v.x / kAcross, v.y / kAcross, v.z / kUp}; };
  const Vec3 o = stretched(inside.origin_mm), k = stretched(inside.direction.vec());
  const double kk = dot(k, k), ok = dot(o, k);
  const Vec3 p = inside.at((std::sqrt(ok * ok + kk * (1.0 - dot(o, o))) - ok) / kk);
  const Vec3 n = Direction::from(stretched(stretched(p))).vec();
  const double ci = dot(inside.direction.vec(), n), sine2 = kIndex * kIndex * (1.0 - ci * ci);
  if (sine2 >= 1.0) return {{p, Direction::from_unit(n)}, 0.0};
  const double ct = std::sqrt(1.0 - sine2);
  const Direction d = Direction::from(kIndex * inside.direction.vec() + (ct - kIndex * ci) * n);
  const double rs = (kIndex * ci - ct) / (kIndex * ci + ct), rp = (kIndex * ct - ci) / (kIndex * ct + ci);
  const Ray out{p, d};
  return {{out.at(*BoundingSurface::sphere(4.0).exit_distance_mm(out)), d}, 1.0 - 0.5 * (rs * rs + rp * rp)};
}

/// Three 0.4 x 2 mm bars, tilted and far off centre, weights from 0 to 2 whatever the ray.
inline WeightedRay tilted_ray(const OwnNumbers& u) {
  const Frame placed = Frame::from_axis(Direction::from({0.4, -0.7, 0.6}), 0.5, {14.0, -6.0, 3.0});
  const double bar = std::floor(3.0 * u[2]), x = 0.8 * (bar - 1.0) + 0.4 * (3.0 * u[2] - bar - 0.5);
  return {placed.ray({{x, 2.0 * u[3] - 1.0, 0.0}, warp::cosine_hemisphere(u[0], u[1])}), 2.0 * u[4]};
}

/// A 12 x 2 mm phosphor strip with ten Gaussian hot spots (half of the light), on a box.
inline WeightedRay strip_ray(const OwnNumbers& u) {
  double x = 12.0 * u[2] - 6.0, y = 2.0 * u[3] - 1.0;
  if (u[4] < 0.5) {
    const double spot = std::floor(20.0 * u[4]), r = 0.3 * std::sqrt(-2.0 * std::log(1.0 - u[2] * 0.999));
    const double phi = 2.0 * std::numbers::pi * u[3];
    x = 1.2 * (spot - 4.5) + r * std::cos(phi);
    y = std::clamp(r * std::sin(phi), -1.0, 1.0);
  }
  const Ray ray{{x, y, 0.0}, warp::cosine_hemisphere(u[0], u[1])};
  const BoundingSurface box = BoundingSurface::box({16.0, 6.0, 4.0});
  return {{ray.at(*box.exit_distance_mm(ray)), ray.direction}};
}

/// A short arc: light from a volume, two hot spots before the electrodes and a column between, isotropic but
/// for the electrodes' shadow cones; on a sphere of 10 mm.
inline WeightedRay arc_ray(const OwnNumbers& u) {
  const Direction d = warp::sphere(0.07 + 0.86 * u[0], u[1]);
  const double r = 0.15 * std::sqrt(-2.0 * std::log(1.0 - 0.9999 * u[2])),
               phi = 2.0 * std::numbers::pi * u[4];
  const double side = u[3] < 0.5 ? 1.0 : -1.0, v = u[3] < 0.5 ? 2.0 * u[3] : 2.0 * u[3] - 1.0;
  const double z = side * (0.9 + 0.25 * std::log(1.0 - 0.97 * v));
  const Ray ray{{r * std::cos(phi), r * std::sin(phi), z}, d};
  return {{ray.at(*BoundingSurface::sphere(10.0).exit_distance_mm(ray)), d}};
}

/// A straight filament along x and its weak image in a mirror above it (12 % of the light): two cylinders
/// whose light overlaps; on a sphere of 15 mm.
inline WeightedRay ghost_ray(const OwnNumbers& u) {
  constexpr double kRadius = 0.3, kLength = 6.0, kMirror = 1.3;
  const double phi = 2.0 * std::numbers::pi * u[2];
  const Vec3 n{0.0, std::cos(phi), std::sin(phi)};
  Vec3 p = kRadius * n + Vec3{kLength * (u[3] - 0.5), 0, 0};
  Direction d = warp::about(Direction::from_unit(n), warp::cosine_hemisphere(u[0], u[1]));
  if (u[4] < 0.12) {
    p.z = 2.0 * kMirror - p.z;
    d = Direction::from({d.x(), d.y(), -d.z()});
  }
  const Ray ray{p, d};
  return {{ray.at(*BoundingSurface::sphere(15.0).exit_distance_mm(ray)), d}};
}

/// A 1 mm die and a tenth of its light scattered by the round wall of its package, 3 mm across and 2 mm high.
inline WeightedRay remote_ray(const OwnNumbers& u) {
  Ray ray{{u[2] - 0.5, u[3] - 0.5, 0.0}, warp::cosine_hemisphere(u[0], u[1])};
  if (u[4] < 0.1) {
    const double phi = 2.0 * std::numbers::pi * u[2];
    const Vec3 n{std::cos(phi), std::sin(phi), 0.0};
    ray = {1.5 * n + Vec3{0, 0, 2.0 * u[3]},
           warp::about(Direction::from_unit(n), warp::cosine_hemisphere(u[0], u[1]))};
  }
  return {{ray.at(*BoundingSurface::sphere(4.0).exit_distance_mm(ray)), ray.direction}};
}

/// The twin of the measured LED, caught on a sphere.
inline WeightedRay twin_ray(const OwnNumbers& u) {
  const Ray ray = twin::ray(u);
  const double far = *BoundingSurface::sphere(twin::kCaughtRadius).exit_distance_mm(ray);
  return {{ray.at(far), ray.direction}};
}

class OwnSource final : public RaySource {
 public:
  using Sampler = WeightedRay (*)(const OwnNumbers&);
  explicit OwnSource(Sampler sampler) : sample_(sampler) {}
  double flux() const override { return 1000.0; }
  FluxUnit flux_unit() const override { return FluxUnit::lumen; }
  void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const override {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const WeightedRay w = sample_(sequence.point<5>(first + i));
      out.set(i, w.ray);
      out.weight[i] = static_cast<float>(w.weight);
    }
  }

 private:
  Sampler sample_;
};

/// The source of that name, or nothing.
inline std::unique_ptr<RaySource> own_source(std::string_view name) {
  if (name == "dome") return std::make_unique<OwnSource>(dome_ray);
  if (name == "ghost") return std::make_unique<OwnSource>(ghost_ray);
  if (name == "remote") return std::make_unique<OwnSource>(remote_ray);
  if (name == "egg") return std::make_unique<OwnSource>(ellipsoidal_dome_ray);
  if (name == "tilted") return std::make_unique<OwnSource>(tilted_ray);
  if (name == "strip") return std::make_unique<OwnSource>(strip_ray);
  if (name == "twin") return std::make_unique<OwnSource>(twin_ray);
  if (name == "arc") return std::make_unique<OwnSource>(arc_ray);
  return nullptr;
}

/// Counts `n` rays of a source.
inline void add_drawn(ViewCounts& counts, const RaySource& source, const Sequence& sequence,
                      std::uint64_t n) {
  constexpr std::uint64_t kPiece = 1 << 20;
  RayBlock block;
  for (std::uint64_t first = 0; first < n; first += kPiece) {
    block.resize(std::min(kPiece, n - first), 0);
    source.emit(sequence, first, block);
    counts.add(block);
  }
}

/// One of these, or an emitter.
inline std::unique_ptr<RaySource> source_named(const std::string& name) {
  if (auto own = own_source(name)) return own;
  EmitterOptions options;
  options.kind = emitter_kind(name);
  return make_emitter(options);
}

}  // namespace lucerna::bench
