// SPDX-License-Identifier: Apache-2.0
// Sources that no method was tuned on, for bench_adaptive: dome, tilted, strip, arc, egg, ghost, remote,
// board, xenon, caustic; and the twin of the measured LED (led_twin.h).
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

/// Moved along its line to where it leaves a sphere about the origin.
inline WeightedRay caught(const WeightedRay& from, double radius_mm) {
  const double far = *BoundingSurface::sphere(radius_mm).exit_distance_mm(from.ray);
  return {{from.ray.at(far), from.ray.direction}, from.weight};
}

/// What passes a smooth boundary: where to, and which share of unpolarised light.
struct Passed {
  Direction direction;
  double share = 0.0;
};

/// `n` is unit and on the side that light goes to; `ratio` is the index before the boundary over that behind
/// it.
inline Passed passed(const Direction& d, const Vec3& n, double ratio) {
  const double ci = dot(d.vec(), n), sine2 = ratio * ratio * (1.0 - ci * ci);
  if (sine2 >= 1.0) return {Direction::from_unit(n), 0.0};
  const double ct = std::sqrt(1.0 - sine2);
  const double rs = (ratio * ci - ct) / (ratio * ci + ct), rp = (ratio * ct - ci) / (ratio * ct + ci);
  return {Direction::from(ratio * d.vec() + (ct - ratio * ci) * n), 1.0 - 0.5 * (rs * rs + rp * rp)};
}

/// A 1 mm die in a hemisphere of index 1.5 and radius 1.4 mm; Fresnel transmission as weight; what is totally
/// reflected is lost. Caught on a sphere of 3 mm.
inline WeightedRay dome_ray(const OwnNumbers& u) {
  constexpr double kIndex = 1.5, kRadius = 1.4;
  const Ray inside{{u[2] - 0.5, u[3] - 0.5, 0.0}, warp::cosine_hemisphere(u[0], u[1])};
  const double t = *BoundingSurface::sphere(kRadius).exit_distance_mm(inside);
  const Vec3 p = inside.at(t);
  const Passed out = passed(inside.direction, p / kRadius, kIndex);
  return caught({{p, out.direction}, out.share}, 3.0);
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
  const Passed out = passed(inside.direction, Direction::from(stretched(stretched(p))).vec(), kIndex);
  return caught({{p, out.direction}, out.share}, 4.0);
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
  return caught({ray}, 10.0);
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
  return caught({ray}, 15.0);
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
  return caught({ray}, 4.0);
}

/// A board with 5 x 5 dies of 0.8 mm, no two equally bright, and the phosphor over them: half of the light
/// comes from a layer 0.3 mm higher, about the dies and less with the distance from them.
inline WeightedRay board_ray(const OwnNumbers& u) {
  constexpr double kPitch = 1.8, kDie = 0.8, kHalo = 0.5, kLayer = 0.3;
  const bool phosphor = u[4] >= 0.5;
  const double part = 2.0 * (phosphor ? u[4] - 0.5 : u[4]);
  // Brightness rises by a third from the first die to the last.
  const double place = 25.0 * (std::sqrt(9.0 + 7.0 * part) - 3.0);
  const double die = std::floor(std::min(place, 24.999)), row = std::floor(die / 5.0);
  double x = kPitch * (row - 2.0), y = kPitch * (die - 5.0 * row - 2.0);
  if (phosphor) {
    const double r = -kHalo * std::log(1.0 - 0.9999 * u[2]), phi = 2.0 * std::numbers::pi * u[3];
    x += r * std::cos(phi), y += r * std::sin(phi);
  } else {
    x += kDie * (u[2] - 0.5), y += kDie * (u[3] - 0.5);
  }
  return caught({{{x, y, phosphor ? kLayer : 0.0}, warp::cosine_hemisphere(u[0], u[1])}}, 12.0);
}

/// Does a ray from between the electrodes meet one? The upper is a cylinder of 1.5 mm that begins at z = 2,
/// the lower a cone of 20 degrees whose tip is at z = -2.
inline bool is_in_shadow(const Ray& ray) {
  constexpr double kTip = 2.0, kAnode = 1.5, kSlope = 0.36397;
  const Vec3& o = ray.origin_mm;
  const Vec3& d = ray.direction.vec();
  if (d.z > 0.0) {
    const Vec3 p = ray.at((kTip - o.z) / d.z);
    return std::hypot(p.x, p.y) < kAnode;
  }
  // r^2 = (slope depth)^2, the depth below the tip being -2 - z.
  const double depth = -kTip - o.z, k2 = kSlope * kSlope;
  const double a = d.x * d.x + d.y * d.y - k2 * d.z * d.z;
  const double b = o.x * d.x + o.y * d.y + k2 * depth * d.z, c = o.x * o.x + o.y * o.y - k2 * depth * depth;
  const double root = b * b - a * c;
  if (root < 0.0) return false;
  for (const double sign : {-1.0, 1.0}) {
    const double t = (-b + sign * std::sqrt(root)) / a;
    if (t > 0.0 && o.z + t * d.z < -kTip) return true;
  }
  return false;
}

/// A high-pressure arc of 4 mm, brightest at the cathode's tip and wider towards the anode: light from a
/// volume into all directions, but for those in which an electrode stands, which hang on where it starts.
inline WeightedRay xenon_ray(const OwnNumbers& u) {
  const double z = -1.95 - 0.9 * std::log(1.0 - u[3] * (1.0 - std::exp(-3.9 / 0.9)));
  const double r = (0.12 + 0.12 * (z + 1.95)) * std::sqrt(-2.0 * std::log(1.0 - 0.9999 * u[2]));
  const double phi = 2.0 * std::numbers::pi * u[4];
  const Ray ray{{r * std::cos(phi), r * std::sin(phi), z}, warp::sphere(u[0], u[1])};
  return caught({ray, is_in_shadow(ray) ? 0.0 : 1.0}, 20.0);
}

/// A die of 0.5 mm a millimetre below a half ball of glass of 3 mm, flat below: its spherical aberration
/// folds the light to a caustic with a sharp edge. What misses the glass is absorbed.
inline WeightedRay caustic_ray(const OwnNumbers& u) {
  constexpr double kIndex = 1.5, kGap = 1.0, kRadius = 3.0;
  const Vec3 start{0.5 * (u[2] - 0.5), 0.5 * (u[3] - 0.5), -kGap};
  const Direction up = warp::cosine_hemisphere(u[0], u[1]);
  const Vec3 flat = start + (kGap / std::max(1e-9, up.z())) * up.vec();
  if (std::hypot(flat.x, flat.y) >= kRadius) return {{{0, 0, 6.0}, Direction()}, 0.0};
  const Passed in = passed(up, {0, 0, 1}, 1.0 / kIndex);
  const Ray inside{flat, in.direction};
  const Vec3 top = inside.at(*BoundingSurface::sphere(kRadius).exit_distance_mm(inside));
  const Passed out = passed(in.direction, top / kRadius, kIndex);
  return caught({{top, out.direction}, in.share * out.share}, 6.0);
}

/// The twin of the measured LED, caught on a sphere.
inline WeightedRay twin_ray(const OwnNumbers& u) { return caught({twin::ray(u)}, twin::kCaughtRadius); }

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
  if (name == "board") return std::make_unique<OwnSource>(board_ray);
  if (name == "xenon") return std::make_unique<OwnSource>(xenon_ray);
  if (name == "caustic") return std::make_unique<OwnSource>(caustic_ray);
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
