// SPDX-License-Identifier: Apache-2.0
#include "emitter.h"

#include <array>
#include <cmath>
#include <numbers>

namespace bench {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Uniform on the unit disk.
Vec3 on_disk(RayRandom& r) {
  const double radius = std::sqrt(r.uniform()), angle = kTurn * r.uniform();
  return {radius * std::cos(angle), radius * std::sin(angle), 0.0};
}

/// Lambert's law about `normal`: even in the projection on the surface.
SourceRay lambertian(const Vec3& origin, const Vec3& normal, RayRandom& r) {
  Vec3 d = on_disk(r);
  d.z = std::sqrt(std::max(0.0, 1.0 - d.x * d.x - d.y * d.y));
  return {origin, frame_about(normal).vector(d), 1.0};
}

Vec3 on_sphere(RayRandom& r) {
  const double z = 1.0 - 2.0 * r.uniform(), s = std::sqrt(std::max(0.0, 1.0 - z * z));
  const double angle = kTurn * r.uniform();
  return {s * std::cos(angle), s * std::sin(angle), z};
}

constexpr Vec3 kUp{0, 0, 1};

/// Four dies of 1 mm, pitch 1.1 mm, of luminance 1, 0.95, 1.05, 1; 1 % of the light from a disk of 2.5 mm.
SourceRay led(RayRandom& r) {
  constexpr std::array<double, 4> kLuminance{1.0, 0.95, 1.05, 1.0};
  constexpr double kPackageRadius = 2.5, kHalfPitch = 0.55, kStray = 0.01;
  if (r.uniform() < kStray) return lambertian(kPackageRadius * on_disk(r), kUp, r);
  double left = 4.0 * r.uniform();
  std::size_t die = 0;
  while (die < 3 && left >= kLuminance[die]) left -= kLuminance[die++];
  const double x = (die & 1) != 0 ? kHalfPitch : -kHalfPitch, y = die >= 2 ? kHalfPitch : -kHalfPitch;
  const Vec3 at{x + r.uniform() - 0.5, y + r.uniform() - 0.5, 0.0};
  return lambertian(at, kUp, r);
}

/// A wire coiled about x; even over its bent surface, of which the outside of each turn has more.
SourceRay filament(double coil_radius, double coil_length, double ghost_share, RayRandom& r) {
  constexpr double kTurns = 12.0, kWireRadius = 0.06;
  const double along = r.uniform(), winding = kTurn * kTurns, angle = winding * along;
  const double speed = std::hypot(coil_length, coil_radius * winding);
  const double curvature = coil_radius * winding * winding / (speed * speed);
  const double bend = kWireRadius * curvature;
  double phi = 0.0;
  do {
    phi = kTurn * r.uniform();
  } while (r.uniform() * (1.0 + bend) >= 1.0 + bend * std::cos(phi));
  const Vec3 out{0.0, std::cos(angle), std::sin(angle)};
  const Vec3 tangent = (1.0 / speed) * Vec3{coil_length, -coil_radius * winding * std::sin(angle),
                                            coil_radius * winding * std::cos(angle)};
  const Vec3 normal = unit(std::cos(phi) * out + std::sin(phi) * cross(tangent, out));
  const Vec3 centre{coil_length * (along - 0.5), coil_radius * out.y, coil_radius * out.z};
  SourceRay ray = lambertian(centre + kWireRadius * normal, normal, r);
  if (r.uniform() < ghost_share) {
    ray.origin = -ray.origin;
    ray.direction = -ray.direction;
  }
  return ray;
}

/// Two-dimensional: rays in the plane y = 0, even over the strip's halves and over the sine of their angle.
SourceRay strip(double half_width, double share_of_left, RayRandom& r) {
  const bool left = r.uniform() < share_of_left;
  const double x = half_width * r.uniform(), sine = 2.0 * r.uniform() - 1.0;
  return {{left ? -x : x, 0, 0}, {sine, 0.0, std::sqrt(std::max(0.0, 1.0 - sine * sine))}, 1.0};
}

class Emitter final : public Source {
 public:
  using Sampler = std::function<SourceRay(RayRandom&)>;
  Emitter(Sampler sampler, const Frame& place) : sample_(std::move(sampler)), place_(place) {}
  SourceRay ray(std::uint64_t, RayRandom& random) const override {
    const SourceRay local = sample_(random);
    return {place_.point(local.origin), place_.vector(local.direction), local.weight};
  }

 private:
  Sampler sample_;
  Frame place_;
};

Emitter::Sampler sampler_of(const JsonNode& s) {
  const std::string kind =
      s.at("emitter").one_of({"point", "disk", "rectangle", "cylinder", "led", "filament", "strip"});
  if (kind == "point") return [](RayRandom& r) { return SourceRay{{}, on_sphere(r), 1.0}; };
  if (kind == "led") return led;
  if (kind == "disk") {
    const double radius = s.at("radius_mm").positive();
    return [=](RayRandom& r) { return lambertian(radius * on_disk(r), kUp, r); };
  }
  if (kind == "rectangle") {
    const auto size = s.at("size_mm").numbers(2);
    if (!(size[0] > 0.0 && size[1] > 0.0)) s.at("size_mm").fail("two sizes > 0");
    return [=](RayRandom& r) {
      const double x = size[0] * (r.uniform() - 0.5), y = size[1] * (r.uniform() - 0.5);
      return lambertian({x, y, 0.0}, kUp, r);
    };
  }
  if (kind == "cylinder") {
    const double radius = s.at("radius_mm").positive(), length = s.at("length_mm").positive();
    return [=](RayRandom& r) {
      const double angle = kTurn * r.uniform(), z = length * (r.uniform() - 0.5);
      const Vec3 n{std::cos(angle), std::sin(angle), 0.0};
      return lambertian(radius * n + Vec3{0, 0, z}, n, r);
    };
  }
  if (kind == "filament") {
    const double radius = s.at("radius_mm").positive(), length = s.at("length_mm").positive();
    const double ghost = s.at("ghost_share").number_in(0.0, 0.999);
    return [=](RayRandom& r) { return filament(radius, length, ghost, r); };
  }
  const double half = s.at("half_width_mm").positive(), ratio = s.at("right_to_left_luminance").positive();
  return [=](RayRandom& r) { return strip(half, 1.0 / (1.0 + ratio), r); };
}

}  // namespace

std::unique_ptr<Source> read_emitter(const JsonNode& source) {
  source.only({"emitter", "radius_mm", "length_mm", "size_mm", "ghost_share", "half_width_mm",
               "right_to_left_luminance", "place", "blocks", "note"});
  return std::make_unique<Emitter>(sampler_of(source), source.at("place").frame());
}

SourceBody read_source_body(const JsonNode& source) {
  SourceBody body;
  body.place = source.at("place").frame();
  body.blocks = source.at("blocks").boolean();
  if (!body.blocks) return body;
  if (source.at("emitter").text() != "rectangle")
    source.at("blocks").fail("false for emitters other than a rectangle");
  const auto size = source.at("size_mm").numbers(2);
  body.half_x_mm = 0.5 * size[0];
  body.half_y_mm = 0.5 * size[1];
  return body;
}

bool SourceBody::hit(const Vec3& origin, const Vec3& direction, double t_max) const {
  if (!blocks) return false;
  const Vec3 o = place.local_point(origin), d = place.local_vector(direction);
  if (d.z == 0.0) return false;
  const double t = -o.z / d.z;
  if (!(t > 1e-9 && t < t_max)) return false;
  return std::abs(o.x + t * d.x) <= half_x_mm && std::abs(o.y + t * d.y) <= half_y_mm;
}

}  // namespace bench
