// SPDX-License-Identifier: Apache-2.0
// Whole traces whose outcome is known in closed form, by both engines.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "lucerna/optics/shapes/swept_curve.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"

namespace lucerna {
namespace {

constexpr EngineKind kEngines[] = {EngineKind::reference, EngineKind::fast};

template <class Make>
PlacedSource ray_file(std::size_t n, const Make& make) {
  auto set = std::make_shared<RaySet>();
  set->header.set_flux(1.0);
  set->rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(17, i);
    set->rays.set(i, make(rng));
    set->rays.weight[i] = 1.0F;
  }
  return {std::make_shared<RaySetSource>(set, "rays"), Frame(), std::nullopt};
}

/// A direction about `normal`, Lambertian.
Direction lambertian(Rng& rng, const Direction& normal) {
  const double s2 = rng.uniform(), phi = 2.0 * std::numbers::pi * rng.uniform(), s = std::sqrt(s2);
  return Frame::from_z(normal).direction(
      Direction::from({s * std::cos(phi), s * std::sin(phi), std::sqrt(1.0 - s2)}));
}

// All light from one focus of an ellipsoid passes the other, however deep the mirror is. The mouth is beyond
// the equator; the plane through the second focus sees the reflected light in its middle cell.
TEST(AnalyticTruths, DeepEllipsoidFocusToFocus) {
  const double f1 = 10.0, f2 = 60.0;
  for (const EngineKind engine : kEngines) {
    Scene scene{{{make_emitter({.kind = EmitterKind::point, .flux = 1.0}), Frame(), std::nullopt}}};
    scene.sources[0].world_from_source = Frame::from_axis(Direction{}, 0.0, {0, 0, f1});
    scene.reflectors = {{deep_ellipse_reflector(f1, f2, 30.0), Frame(), Reflectance(0.9)}};
    scene.planes = {
        {"focus", {Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, f2}), 3e-3, 3e-3, 3, 3}}};
    const TraceResult result = trace(scene, {.last_ray = 50000, .max_bounces = 1, .engine = engine});
    const Ledger l = ledger(result);
    const PlaneImage image = illuminance(result, 0);
    const double middle = image.value[4] * 1e-3 * 1e-3 * 1e-6;  // lm: lx times m^2
    EXPECT_NEAR(middle, l.out_reflected.mean, 1e-3 * l.emitted);
    EXPECT_GT(l.out_reflected.mean, 0.8);
    EXPECT_EQ(l.absorbed[1].second.mean, 0.0) << "nothing on the back";
  }
}

/// The reflecting profile of a compound parabolic concentrator, from the narrow end at z = 0 up (W. T.
/// Welford, R. Winston, "High Collection Nonimaging Optics", 1989, ch. 4): a parabola tilted by the
/// acceptance angle with its focus on the other edge of the exit.
std::vector<ProfileKnot> cpc(double exit_mm, double acceptance_rad) {
  const double f = exit_mm * (1.0 + std::sin(acceptance_rad));
  std::vector<ProfileKnot> knots;
  for (int i = 0; i <= 400; ++i) {
    const double phi = 0.5 * std::numbers::pi + acceptance_rad -
                       (0.5 * std::numbers::pi - acceptance_rad) * static_cast<double>(i) / 400.0;
    const double rho = 2.0 * f / (1.0 - std::cos(phi));
    knots.push_back({rho * std::sin(phi - acceptance_rad) - exit_mm, rho * std::cos(phi - acceptance_rad)});
  }
  knots.front() = {exit_mm, 0.0};
  return knots;
}

/// Share of a parallel beam over the whole entrance, `angle` off the axis in the xz plane, that leaves by the
/// narrow end; `along` tilts it along y too.
double passed(const Reflector& mirror, double entrance_mm, double angle_rad, double along, bool meridional,
              EngineKind engine) {
  const double z = mirror.curve->heights().high_mm;
  const Direction d = Direction::from({std::sin(angle_rad), along, -std::cos(angle_rad)});
  Scene scene{{ray_file(4000,
                        [&](Rng& rng) {
                          const double x = 0.999 * entrance_mm * (2.0 * rng.uniform() - 1.0);
                          const double y = meridional ? 0.0 : 0.2 * (rng.uniform() - 0.5);
                          return Ray{{x, y, z}, d};
                        })},
              {{mirror, Frame(), Reflectance(1.0)}},
              {{"far", 360.0, 1.0}}};
  scene.ray_detectors = {{}};
  const TraceResult result = trace(scene, {.engine = engine});
  EXPECT_EQ(ledger(result).lost_rays, 0u);
  // By direction, not by far-field cells: edge light leaves nearly level.
  double down = 0.0;
  for (std::size_t i = 0; i < result.out_rays.size(); ++i) {
    if (result.out_rays.direction(i).z() < 0.0)
      down += static_cast<double>(result.out_rays.weight[i]) / 4000.0;
  }
  return down;
}

// A trough passes all light whose angle in the cross-section is below the acceptance angle, and none above;
// light along the trough makes no difference. The edge is sharp: a hundredth of a degree either way.
TEST(AnalyticTruths, CompoundParabolicTroughHasASharpAcceptanceAngle) {
  const double theta = radians(25.0), exit = 5.0;
  const auto knots = cpc(exit, theta);
  const double entrance = exit / std::sin(theta);
  EXPECT_NEAR(knots.back().r_mm, entrance, 1e-9);
  EXPECT_NEAR(knots.back().z_mm, (exit + entrance) / std::tan(theta), 1e-9);
  const Reflector mirror = profile_trough(knots, Aperture::rectangle(2.0 * entrance, 2000.0));
  ASSERT_NE(mirror.curve, nullptr);
  for (const EngineKind engine : kEngines) {
    for (const double along : {0.0, 0.7}) {
      for (const double share : {0.0, 0.3, 0.7, 0.95}) {
        EXPECT_NEAR(passed(mirror, entrance, share * theta, along, false, engine), 1.0, 1e-9) << share;
      }
      for (const double beyond : {1.05, 1.5, 2.5}) {
        EXPECT_NEAR(passed(mirror, entrance, beyond * theta, along, false, engine), 0.0, 1e-9) << beyond;
      }
    }
    EXPECT_NEAR(passed(mirror, entrance, theta - radians(0.01), 0.0, false, engine), 1.0, 1e-9);
    EXPECT_NEAR(passed(mirror, entrance, theta + radians(0.01), 0.0, false, engine), 0.0, 1e-9);
  }
}

// Turned about its axis it does the same for light in its meridional planes; skew light near the edge partly
// turns back, which is known of it, so only the meridional beam is exact.
TEST(AnalyticTruths, CompoundParabolicConcentratorInItsMeridian) {
  const double theta = radians(20.0), exit = 5.0, entrance = exit / std::sin(theta);
  const Reflector mirror = profile_reflector(cpc(exit, theta), Aperture::circle(2.0 * entrance));
  for (const EngineKind engine : kEngines) {
    EXPECT_NEAR(passed(mirror, entrance, theta - radians(0.01), 0.0, true, engine), 1.0, 1e-9);
    EXPECT_NEAR(passed(mirror, entrance, theta + radians(0.01), 0.0, true, engine), 0.0, 1e-9);
    EXPECT_NEAR(passed(mirror, entrance, 0.5 * theta, 0.0, true, engine), 1.0, 1e-9);
  }
}

/// Light Lambertian from the port (a cap of half angle `port`, at the top) into a sphere of radius 20.
PlacedSource from_port(std::size_t n, double port) {
  return ray_file(n, [port](Rng& rng) {
    const double c = 1.0 - (1.0 - std::cos(port)) * rng.uniform(), s = std::sqrt(1.0 - c * c);
    const double phi = 2.0 * std::numbers::pi * rng.uniform();
    const Direction out = Direction::from({s * std::cos(phi), s * std::sin(phi), c});
    return Ray{Vec3{0, 0, 20.0} + 20.0 * out.vec(), lambertian(rng, -out)};
  });
}

// A sphere as an integrating sphere. Light that is Lambertian and even on the port keeps that property from
// wall to wall (the billiard's own measure), so its mean number of chords until it is back at the port is the
// share of all light whose great circles pass the port, sin(port), over the port's share of the sphere
// (M. Kac, Bull. AMS 53, 1947); its first chord ends on the port with just that share. Mixed light would need
// 1 / share chords: excluded by far.
TEST(AnalyticTruths, SphereReturnsLightAsKacsLemmaSays) {
  const double port = radians(25.0), share = 0.5 * (1.0 - std::cos(port));
  const std::size_t n = 20000;
  for (const EngineKind engine : kEngines) {
    Scene scene{{from_port(n, port)},
                {{deep_ellipse_reflector(20.0, 20.0, 40.0 * std::sin(port)), Frame(), Reflectance(1.0)}},
                {{"far", 5.0, 1.0}}};
    const Ledger l = ledger(trace(scene, {.max_bounces = 3000, .engine = engine}));
    const double binomial = std::sqrt(share * (1.0 - share) / static_cast<double>(n));
    EXPECT_NEAR(l.out_direct.mean, share, 4.9 * binomial);
    const double chords = std::sin(port) / share;
    // Standard deviation of the count is about 1.5 times its mean, and the limit of 3000 cuts the tail.
    EXPECT_NEAR(l.reflections_per_ray.mean + 1.0, chords, 0.05 * chords);
    EXPECT_GT(std::abs(l.reflections_per_ray.mean + 1.0 - 1.0 / share), 1.0 * chords);
    EXPECT_EQ(l.absorbed[1].second.mean, 0.0);
    EXPECT_LT(l.lost[0].second.mean, 1e-3);
  }
}

// Ray by ray: each chord turns a ray of a sphere by the same angle in its own plane, so the wall hits until
// it is back at the port are counted without a tracer, and the ledger's figures are sums of powers.
TEST(AnalyticTruths, SphereLedgerIsASumOfPowers) {
  const double port = radians(20.0), rho = 0.9;
  const std::size_t n = 20000;
  const PlacedSource source = from_port(n, port);
  RayBlock rays;
  rays.resize(n, 0);
  source.rays->emit(Sequence(SequenceKind::random, 1), 0, rays);
  double out = 0.0, hits = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Ray ray = rays.ray(i);
    const Vec3 p = ray.origin_mm - Vec3{0, 0, 20.0};
    const Direction at = Direction::from(p);
    const double chord = 2.0 * std::asin(std::min(1.0, -dot(at, ray.direction)));  // central angle
    const Direction axis = Direction::from(cross(at.vec(), ray.direction.vec()));
    for (int k = 1;; ++k) {
      const double z = Frame::rotation(axis, chord * k).vector(at.vec()).z;
      if (z > std::cos(port)) {
        out += std::pow(rho, k - 1);
        hits += k - 1;
        break;
      }
      if (k > 2000) break;
    }
  }
  for (const EngineKind engine : kEngines) {
    Scene scene{{source},
                {{deep_ellipse_reflector(20.0, 20.0, 40.0 * std::sin(port)), Frame(), Reflectance(rho)}},
                {{"far", 5.0, 1.0}}};
    const Ledger l = ledger(trace(scene, {.max_bounces = 2000, .engine = engine}));
    const double got = l.out_direct.mean + l.out_reflected.mean;
    // Some rays pass within rounding of the port's rim; float32 has more of them.
    EXPECT_NEAR(got, out / static_cast<double>(n), engine == EngineKind::fast ? 1e-3 : 1e-4);
    EXPECT_NEAR(l.absorbed[0].second.mean, 1.0 - got, 1e-6);
    EXPECT_GT(hits, 0.0);
  }
}

// A parabolic trough turns a line of light at its focus into parallel planes: no light of it has a component
// across, whatever it has along.
TEST(AnalyticTruths, ParabolicTroughCollimatesALine) {
  for (const EngineKind engine : kEngines) {
    Scene scene{{ray_file(20000,
                          [](Rng& rng) {
                            const double z = 1.8 * rng.uniform() - 0.9,
                                         phi = radians(200.0 + 140.0 * rng.uniform());
                            const double s = std::sqrt(1.0 - z * z);
                            return Ray{{0.0, 4.0 * rng.uniform(), 10.0},
                                       Direction::from({s * std::cos(phi), z, s * std::sin(phi)})};
                          })},
                {{conic_trough(ConicPreset::parabola, 10.0, 0.0, Aperture::rectangle(80.0, 600.0)), Frame(),
                  Reflectance(1.0)}},
                {{"far", 5.0, 1.0}}};
    scene.ray_detectors = {{}};
    const TraceResult result = trace(scene, {.max_bounces = 1, .engine = engine});
    EXPECT_EQ(ledger(result).out_direct.mean, 0.0);
    for (std::size_t i = 0; i < result.out_rays.size(); ++i) {
      ASSERT_LT(std::abs(result.out_rays.direction(i).x()), engine == EngineKind::fast ? 1e-5 : 1e-9);
      ASSERT_GT(result.out_rays.direction(i).z(), 0.0);
    }
  }
}

}  // namespace
}  // namespace lucerna
