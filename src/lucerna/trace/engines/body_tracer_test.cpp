// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/body_tracer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "tests/support/print_parameters.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

/// A square of 2 a at height z, facing up.
std::shared_ptr<const Mesh> square(double a, double z) {
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices_mm = {{-a, -a, z}, {a, -a, z}, {a, a, z}, {-a, a, z}};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Scene point_at_origin() {
  Scene scene;
  scene.sources = {{make_emitter({.kind = EmitterKind::point, .flux = 600.0}), {}, std::nullopt}};
  scene.far_fields = {{"far", 30.0, 10.0}};
  return scene;
}

class Bodies : public testing::TestWithParam<EngineKind> {
 protected:
  void SetUp() override {
    try {
      const BodyTracer tracer({{"x", square(1, 1), {}, Reflectance(0.0), false}});
    } catch (const InputError& e) {
      GTEST_SKIP() << e.what();
    }
  }
  TraceResult run(const Scene& scene) const {
    return trace(scene, {.last_ray = 65536, .engine = GetParam(), .cells = 256});
  }
};
INSTANTIATE_TEST_SUITE_P(Engines, Bodies, testing::Values(EngineKind::reference, EngineKind::fast),
                         testing::PrintToStringParamName());

// One face of a cube about the source takes a sixth of its light.
TEST_P(Bodies, AnAbsorberTakesItsSolidAngle) {
  Scene scene = point_at_origin();
  scene.bodies = {{"lid", square(10, 10), {}, Reflectance(0.0), false}};
  const Ledger l = ledger(run(scene));
  EXPECT_EQ(l.absorbed[2].first, "lid");
  EXPECT_NEAR(l.absorbed[2].second.mean, 100.0, 0.2);
  EXPECT_NEAR(l.out_direct.mean, 500.0, 0.2);
}

TEST_P(Bodies, TheLampsOwnBodyMeetsOnlyReturningLight) {
  Scene scene = point_at_origin();
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0));
  scene.reflectors = {{mirror, Frame::from_axis(Direction{}, 0.0, {0, 0, -15}), Reflectance(1.0), 0.0}};
  // The collimated beam comes back through a square of 10 mm: its share is the solid angle of that square of
  // the mirror.
  scene.bodies = {{"bulb", square(5, 1), {}, Reflectance(0.0), true}};
  const Ledger l = ledger(run(scene));
  EXPECT_NEAR(l.out_direct.mean + l.out_reflected.mean + l.absorbed[2].second.mean, 600.0, 1e-6);
  double share = 0.0;  // per area of the beam: 1 / (4 pi f^2 (1 + r^2 / 4 f^2)^2)
  const int n = 200;
  for (int i = 0; i < n * n; ++i) {
    const double x = (i % n + 0.5) * 10.0 / n - 5.0, y = (i / n + 0.5) * 10.0 / n - 5.0;
    share += 100.0 / (n * n) / (4.0 * std::numbers::pi * 225.0 * std::pow(1.0 + (x * x + y * y) / 900.0, 2));
  }
  EXPECT_NEAR(l.absorbed[2].second.mean, 600.0 * share, 0.3);
}

TEST_P(Bodies, AMirrorBodyReflectsOnBothSides) {
  Scene scene = point_at_origin();
  scene.bodies = {{"plate", square(1e4, 10), {}, Reflectance(0.5), false}};
  const TraceResult result = run(scene);
  const Ledger l = ledger(result);
  EXPECT_NEAR(l.absorbed[2].second.mean, 150.0, 0.5);
  EXPECT_NEAR(l.out_reflected.mean, 150.0, 0.5);
  EXPECT_EQ(l.lost_rays, 0u);
}

// A paraboloid as a mesh of 64 x 64 squares with smooth normals collimates as the surface itself to a tenth
// of a degree; with flat triangles a hundred times more light misses that cone.
TEST_P(Bodies, SmoothNormalsMakeAMeshAMirror) {
  Scene scene = point_at_origin();
  scene.far_fields = {{"far", 360.0, 0.1}};
  const Reflector paraboloid = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::rectangle(60, 60));
  auto mesh = std::make_shared<Mesh>();
  for (int i = 0; i < 65 * 65; ++i) {
    const double x = 60.0 * (i % 65) / 64.0 - 30.0, y = 60.0 * (i / 65) / 64.0 - 30.0;
    mesh->vertices_mm.push_back({x, y, paraboloid.surface->at(x, y).z_mm - 15.0});
    if (i % 65 == 64 || i / 65 == 64) continue;
    const auto a = static_cast<std::uint32_t>(i), b = a + 65;
    mesh->triangles.push_back({a, a + 1, b + 1});
    mesh->triangles.push_back({a, b + 1, b});
  }
  double near_axis[2];
  double all = 0.0;
  for (const bool smooth : {false, true}) {
    scene.bodies = {{"bowl", mesh, {}, Reflectance(1.0), false, smooth ? 30.0 : 0.0}};
    const TraceResult result = run(scene);
    const FarField far = far_field(result, 0);
    all = ledger(result).out_reflected.mean;
    near_axis[smooth ? 1 : 0] = far.flux[far.gamma_count - 1] + far.flux[far.gamma_count - 2];
  }
  EXPECT_GT(near_axis[1], 0.97 * all);
  EXPECT_LT(near_axis[0], 0.2 * all);
}

/// `n` equal rays along `direction` through the origin, from 50 mm before it.
std::shared_ptr<const RaySource> pencil(std::size_t n, const Direction& direction) {
  auto set = std::make_shared<RaySet>();
  set->header.set_flux(1.0);
  set->rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    set->rays.set(i, {-50.0 * direction.vec(), direction});
    set->rays.weight[i] = 1.0F;
  }
  return std::make_shared<RaySetSource>(set, "pencil");
}

/// p-value of `slopes` (pairs) being of two independent Gaussians of standard deviation `sigma` about 0: by
/// radius and azimuth, in cells of equal probability.
double gaussian_p(const std::vector<std::array<double, 2>>& slopes, double sigma) {
  constexpr std::size_t kRadii = 24, kAzimuths = 16;
  std::vector<double> observed(kRadii * kAzimuths), expected(observed.size());
  for (const auto& [p, q] : slopes) {
    const double within = 1.0 - std::exp(-(p * p + q * q) / (2.0 * sigma * sigma));
    const double turn = 0.5 + std::atan2(q, p) / (2.0 * std::numbers::pi);
    const auto r = std::min(kRadii - 1, static_cast<std::size_t>(within * kRadii));
    const auto a = std::min(kAzimuths - 1, static_cast<std::size_t>(turn * kAzimuths));
    observed[r * kAzimuths + a] += 1.0;
  }
  for (double& e : expected) e = static_cast<double>(slopes.size()) / static_cast<double>(expected.size());
  return test::chi_square_p(observed, expected);
}

class BodiesStatistical : public Bodies {};
INSTANTIATE_TEST_SUITE_P(Engines, BodiesStatistical, testing::Values(EngineKind::reference, EngineKind::fast),
                         testing::PrintToStringParamName());

// The normal that sent each ray where it went, against the triangle's: two Gaussians of the slope error.
// False alarms 1e-6; an error of 5 % in it, a tilt about one axis only and a disc of the same variance are
// rejected.
TEST_P(BodiesStatistical, SlopeErrorOfAMeshIsGaussian) {
  for (const double incidence : {0.0, 40.0}) {
    const double a = radians(incidence);
    const Direction down = Direction::from({std::sin(a), 0.0, -std::cos(a)});
    Scene scene;
    // Not along an axis of the luminaire, and hit on its back.
    const Frame turned = Frame::from_axis(Direction::from({0.3, -0.2, -1.0}), 20.0, {0, 0, 0});
    scene.sources = {{pencil(40000, turned.direction(down)), {}, std::nullopt}};
    scene.far_fields = {{"far", 30.0, 10.0}};
    scene.ray_detectors = {{}};
    scene.bodies = {{"sheet", square(20, 0), turned, Reflectance(1.0), false, 0.0, 15.0}};
    const TraceResult result = trace(scene, {.last_ray = 40000, .engine = GetParam()});
    ASSERT_EQ(result.out_rays.size(), 40000u);
    std::vector<std::array<double, 2>> slopes, one_axis, disc;
    const Frame sheet = turned.inverse();
    Rng rng(5, 0);
    for (std::size_t i = 0; i < 40000; ++i) {
      const Vec3 n = sheet.direction(result.out_rays.direction(i)).vec() - down.vec();
      slopes.push_back({n.x / n.z, n.y / n.z});
      one_axis.push_back({n.x / n.z, 0.0});
      const double r = 2.0 * 0.015 * std::sqrt(rng.uniform()), phi = 2.0 * std::numbers::pi * rng.uniform();
      disc.push_back({r * std::cos(phi), r * std::sin(phi)});
    }
    EXPECT_GT(gaussian_p(slopes, 0.015), test::kFalseAlarm) << incidence << " degrees";
    EXPECT_LT(gaussian_p(slopes, 0.015 * 1.05), test::kFalseAlarm);
    EXPECT_LT(gaussian_p(slopes, 0.015 / 1.05), test::kFalseAlarm);
    EXPECT_LT(gaussian_p(one_axis, 0.015), test::kFalseAlarm);
    EXPECT_LT(gaussian_p(disc, 0.015), test::kFalseAlarm);
  }
}

// At grazing incidence many tilts would send light into the sheet.
TEST_P(Bodies, SlopeErrorLetsNothingThrough) {
  Scene scene;
  const Direction grazing = Direction::from({1.0, 0.0, -0.02});
  scene.sources = {{pencil(20000, grazing), {}, std::nullopt}};
  scene.far_fields = {{"far", 360.0, 90.0}};
  scene.ray_detectors = {{}};
  scene.bodies = {{"sheet", square(100, 0), {}, Reflectance(1.0), false, 0.0, 50.0}};
  const TraceResult result = trace(scene, {.last_ray = 20000, .engine = GetParam()});
  ASSERT_EQ(result.out_rays.size(), 20000u);
  for (std::size_t i = 0; i < 20000; ++i) ASSERT_GE(result.out_rays.direction(i).z(), 0.0);
  EXPECT_NEAR(ledger(result).out_reflected.mean, 1.0, 1e-9);
}

TEST(BodyTracer, RefusesASlopeErrorOutOfRange) {
  EXPECT_THROW(check(Body{.mesh = square(1, 0), .slope_error_mrad = -1.0}), InputError);
  EXPECT_THROW(check(Body{.mesh = square(1, 0), .slope_error_mrad = 1e9}), InputError);
}

TEST(BodyTracer, RefusesAnEmptyMesh) {
  EXPECT_THROW(BodyTracer({{"empty", std::make_shared<Mesh>(), {}, Reflectance(0.0), false}}), InputError);
}

}  // namespace
}  // namespace lucerna
