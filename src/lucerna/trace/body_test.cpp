// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/error.h"
#include "lucerna/source/emitter.h"
#include "lucerna/trace/trace.h"

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
INSTANTIATE_TEST_SUITE_P(Engines, Bodies, testing::Values(EngineKind::reference, EngineKind::fast));

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

TEST(BodyTracer, RefusesAnEmptyMesh) {
  EXPECT_THROW(BodyTracer({{"empty", std::make_shared<Mesh>(), {}, Reflectance(0.0), false}}), InputError);
}

}  // namespace
}  // namespace lucerna
