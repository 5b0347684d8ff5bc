// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/emitter_luminance.h"
#include "lucerna/source/emitters/led_emitter.h"
#include "lucerna/source/emitters/warp.h"

namespace lucerna {

namespace {

constexpr std::array<std::string_view, 11> kKindNames{"point",   "disk",     "rectangle", "cylinder",
                                                      "sphere",  "filament", "led",       "phong500",
                                                      "phong25", "radial",   "cosine"};

/// Direction u[0], u[1]; position u[2], u[3]; part u[4].
using Numbers = std::array<double, 5>;

Ray lambertian(const Vec3& origin_mm, const Direction& normal, const Numbers& u) {
  return {origin_mm, warp::about(normal, warp::cosine_hemisphere(u[0], u[1]))};
}

Ray sample_point(const EmitterShape&, const Numbers& u) { return {{}, warp::sphere(u[0], u[1])}; }

Ray sample_disk(const EmitterShape& s, const Numbers& u) {
  return lambertian(s.radius_mm * warp::disk(u[2], u[3]), {}, u);
}

Ray sample_rectangle(const EmitterShape& s, const Numbers& u) {
  return lambertian({s.width_mm * (u[2] - 0.5), s.height_mm * (u[3] - 0.5), 0.0}, {}, u);
}

Ray sample_cylinder(const EmitterShape& s, const Numbers& u) {
  const Direction normal = warp::at_cosine(0.0, u[2]);
  return lambertian(s.radius_mm * normal.vec() + Vec3{0, 0, s.length_mm * (u[3] - 0.5)}, normal, u);
}

Ray sample_sphere(const EmitterShape& s, const Numbers& u) {
  const Direction normal = warp::sphere(u[2], u[3]);
  return lambertian(s.radius_mm * normal.vec(), normal, u);
}

/// Solves phi + a sin(phi) = 2 pi v for 0 <= a < 1: uniform over the surface of a bent tube, whose outer side
/// is longer.
double bent_tube_angle(double a, double v) {
  const double target = 2.0 * std::numbers::pi * v;
  double phi = target;
  for (int i = 0; i < 20; ++i) phi -= (phi + a * std::sin(phi) - target) / (1.0 + a * std::cos(phi));
  return phi;
}

Ray sample_filament(const EmitterShape& s, const Numbers& u) {
  constexpr double kTurns = 12.0, kWireRadiusMm = 0.06;
  const double omega = 2.0 * std::numbers::pi * kTurns;
  const double speed2 = s.length_mm * s.length_mm + s.radius_mm * s.radius_mm * omega * omega;
  const double curvature = s.radius_mm * omega * omega / speed2;
  const double angle = omega * u[2];
  const Vec3 radial{0.0, std::cos(angle), std::sin(angle)};
  const Vec3 tangent =
      Vec3{s.length_mm, -s.radius_mm * omega * radial.z, s.radius_mm * omega * radial.y} / std::sqrt(speed2);
  const double phi = bent_tube_angle(kWireRadiusMm * curvature, u[3]);
  const Direction normal = Direction::from(std::cos(phi) * radial + std::sin(phi) * cross(tangent, radial));
  const Vec3 centre{s.length_mm * (u[2] - 0.5), s.radius_mm * radial.y, s.radius_mm * radial.z};
  const Ray ray = lambertian(centre + kWireRadiusMm * normal.vec(), normal, u);
  if (u[4] >= s.ghost_share) return ray;
  return {-ray.origin_mm, -ray.direction};
}

Ray sample_led(const EmitterShape&, const Numbers& u) {
  using namespace led_emitter;
  if (u[4] < kStrayShare) return lambertian(kPackageRadiusMm * warp::disk(u[2], u[3]), {}, u);
  double rest = (u[4] - kStrayShare) / (1.0 - kStrayShare);
  int die = 0;
  while (die < 3 && rest >= kDieShare[static_cast<std::size_t>(die)]) {
    rest -= kDieShare[static_cast<std::size_t>(die++)];
  }
  const Vec3 centre{kPitchMm * (die % 2 - 0.5), kPitchMm * (die / 2 - 0.5), 0.0};
  return lambertian(centre + Vec3{u[2] - 0.5, u[3] - 0.5, 0.0}, {}, u);
}

Ray sample_phong500(const EmitterShape& s, const Numbers& u) {
  const Direction normal = warp::sphere(u[2], u[3]);
  return {s.radius_mm * normal.vec(), warp::about(normal, warp::phong_lobe(500.0, u[0], u[1]))};
}

/// Moves u through `pairs` pairs of equal stripes, the first of each with weight 1, the second with kDim.
double striped(double u, int pairs) {
  constexpr double kDim = 0.25;
  const double scaled = u * pairs, pair = std::min(std::floor(scaled), pairs - 1.0);
  const double rest = (scaled - pair) * (1.0 + kDim);
  const double within = rest < 1.0 ? 0.5 * rest : 0.5 + 0.5 * (rest - 1.0) / kDim;
  return (pair + within) / pairs;
}

Ray sample_phong25(const EmitterShape& s, const Numbers& u) {
  // The pattern depends on the direction alone and the lobe on the angle between direction and normal alone,
  // so the direction comes first, from the pattern, and then the normal, from the lobe about it.
  const Direction direction = warp::sphere(striped(u[0], 3), u[1]);
  const Direction normal = warp::about(direction, warp::phong_lobe(25.0, u[2], u[3]));
  return {s.radius_mm * normal.vec(), direction};
}

/// A point of the unit sphere with the checker pattern.
Direction checkered_sphere(const Numbers& u) {
  const int band = std::min(static_cast<int>(8.0 * u[2]), 7);
  const double azimuth = striped(u[3], 8) + (band % 2 == 0 ? 0.0 : 1.0 / 16.0);
  return warp::sphere(u[2], azimuth);
}

Ray sample_radial(const EmitterShape& s, const Numbers& u) {
  const Direction normal = checkered_sphere(u);
  return {s.radius_mm * normal.vec(), normal};
}

Ray sample_cosine(const EmitterShape& s, const Numbers& u) {
  const Direction normal = checkered_sphere(u);
  return lambertian(s.radius_mm * normal.vec(), normal, u);
}

using Sampler = Ray (*)(const EmitterShape&, const Numbers&);
constexpr std::array<Sampler, 11> kSamplers{
    sample_point, sample_disk,     sample_rectangle, sample_cylinder, sample_sphere, sample_filament,
    sample_led,   sample_phong500, sample_phong25,   sample_radial,   sample_cosine};

bool is_seed_set(EmitterKind kind) { return kind >= EmitterKind::phong500; }

double positive(double value, std::string_view name) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw InputError(fmt::format("{} is {}, expected > 0", name, value));
  return value;
}

/// Rays keep their starts as float.
double size_mm(double value, std::string_view name) {
  constexpr double kLargest_mm = 1e9;
  if (value > kLargest_mm)
    throw InputError(fmt::format("{} is {}, expected at most {:g} mm", name, value, kLargest_mm));
  return positive(value, name);
}

/// A size that changes nothing is a mistake.
void check_sizes(const EmitterOptions& o) {
  const bool coil = o.kind == EmitterKind::filament, cylinder = o.kind == EmitterKind::cylinder;
  const bool round =
      coil || cylinder || o.kind == EmitterKind::disk || o.kind == EmitterKind::sphere || is_seed_set(o.kind);
  const auto check = [&](bool given, bool used, std::string_view name) {
    if (given && !used)
      throw InputError(fmt::format("found {}, which a {} does not have", name, to_string(o.kind)));
  };
  check(o.radius_mm.has_value(), round, "radius_mm");
  check(o.length_mm.has_value(), coil || cylinder, "length_mm");
  check(o.size_mm.has_value(), o.kind == EmitterKind::rectangle, "size_mm");
  check(o.ghost_share.has_value(), coil, "ghost_share");
}

EmitterShape shape_of(const EmitterOptions& o) {
  check_sizes(o);
  const bool coil = o.kind == EmitterKind::filament;
  const double ghost_share = o.ghost_share.value_or(0.05);
  if (!(ghost_share >= 0.0 && ghost_share < 1.0)) {
    throw InputError(fmt::format("ghost_share is {}, expected 0 <= ghost_share < 1", ghost_share));
  }
  const std::array<double, 2> size = o.size_mm.value_or(std::array{1.0, 1.0});
  const double radius = o.radius_mm.value_or(coil ? 0.6 : is_seed_set(o.kind) ? 10.0 : 1.0);
  return {o.kind,
          size_mm(radius, "radius_mm"),
          size_mm(o.length_mm.value_or(coil ? 8.0 : 6.0), "length_mm"),
          size_mm(size[0], "size_mm[0]"),
          size_mm(size[1], "size_mm[1]"),
          ghost_share};
}

class Emitter final : public RaySource, public LuminanceSource {
 public:
  explicit Emitter(const EmitterOptions& options)
      : shape_(shape_of(options)),
        sample_(kSamplers[static_cast<std::size_t>(options.kind)]),
        surface_(emission_surface(options)),
        flux_(positive(options.flux, "flux")),
        unit_(options.flux_unit) {
    check_fit();
  }

  double flux() const override { return flux_; }
  FluxUnit flux_unit() const override { return unit_; }

  void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const override {
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Ray ray = sample_(shape_, sequence.point<5>(first + i));
      const auto distance = surface_.exit_distance_mm(ray);
      out.set(i, distance ? Ray{ray.at(*distance), ray.direction} : ray);
      out.weight[i] = 1.0f;
    }
  }

  bool has_luminance() const override { return emitter_has_luminance(shape_.kind); }
  void add_light_on(const Ray& ray, std::vector<LineLight>& to) const override {
    auto light = emitter_light(shape_, ray);
    if (!light) return;
    if (const auto distance = surface_.exit_distance_mm(ray)) light->start_mm = *distance;
    to.push_back(*light);
  }
  LightBound light_bound() const override { return {{}, emitter_reach_mm(shape_)}; }

 private:
  /// Emitters are bounded by their own samples: 4096 even points find whatever sticks out by a visible
  /// amount.
  void check_fit() const {
    const double tolerance = 1e-9 * (1.0 + shape_.radius_mm);
    const Sequence sequence(SequenceKind::sobol, 1);
    for (std::uint64_t i = 0; i < 4096; ++i) {
      const Vec3 start = sample_(shape_, sequence.point<5>(i)).origin_mm;
      const double outside = surface_.outside_mm(start);
      if (outside > tolerance) {
        throw InputError(fmt::format("the {} reaches {:.3g} mm outside its {} surface",
                                     to_string(shape_.kind), outside, to_string(surface_.kind)));
      }
    }
  }

  EmitterShape shape_;
  Sampler sample_;
  BoundingSurface surface_;
  double flux_;
  FluxUnit unit_;
};

}  // namespace

std::string_view to_string(EmitterKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

EmitterKind emitter_kind(std::string_view name) {
  const auto found = std::find(kKindNames.begin(), kKindNames.end(), name);
  if (found == kKindNames.end()) {
    throw UsageError(fmt::format("unknown source kind '{}'; expected {}", name, fmt::join(kKindNames, ", ")));
  }
  return static_cast<EmitterKind>(found - kKindNames.begin());
}

BoundingSurface emission_surface(const EmitterOptions& options) {
  if (options.surface) return *options.surface;
  if (options.kind == EmitterKind::led) return BoundingSurface::sphere(3.0);
  if (options.kind == EmitterKind::filament) return BoundingSurface::sphere(20.0);
  return {};
}

std::unique_ptr<RaySource> make_emitter(const EmitterOptions& options) {
  return std::make_unique<Emitter>(options);
}

}  // namespace lucerna
