// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/scene3d.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "lucerna/source.h"
#include "tests/support/html_check.h"

namespace lucerna {
namespace {

std::vector<float> floats(const nlohmann::ordered_json& value) { return test::unpacked<float>(value); }

Scene scene_with(const Reflector& mirror) {
  Scene scene;
  PlacedSource source;
  source.rays = make_emitter({.kind = EmitterKind::sphere, .radius_mm = 0.5});
  scene.sources.push_back(source);
  scene.reflectors.push_back(
      {mirror, Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 20}), Reflectance(1.0)});
  scene.far_fields.emplace_back();
  return scene;
}

TEST(Scene3d, MeshLiesOnTheMirrorWithItsSlopeAndCurvature) {
  const auto json = scene3d_json(
      scene_with(conic_reflector(ConicPreset::parabola, 20.0, 0.0, Aperture::circle(80.0, 10.0))));
  const auto& mirror = json["mirrors"][0];
  const auto position = floats(mirror["position"]), slope = floats(mirror["slope_deg"]),
             curvature = floats(mirror["curvature_per_mm"]);
  const std::size_t n = slope.size();
  ASSERT_EQ(position.size(), 3 * n);
  ASSERT_EQ(n, mirror["rings"].get<std::size_t>() * mirror["spokes"].get<std::size_t>());
  for (std::size_t i = 0; i < n; ++i) {
    const double r = std::hypot(position[3 * i], position[3 * i + 1]);
    EXPECT_GE(r, 5.0 - 1e-4);
    EXPECT_LE(r, 40.0 + 1e-4);
    EXPECT_NEAR(position[3 * i + 2], 20.0 - r * r / 80.0, 1e-4);
    const double p = r / 40.0, w = 1.0 + p * p;
    EXPECT_NEAR(slope[i], degrees(std::atan(p)), 1e-3);
    // Of z = r^2 / 80: along the meridian z'' / w^1.5, across it p / (r sqrt w).
    EXPECT_NEAR(curvature[i], 0.5 * (0.025 / std::pow(w, 1.5) + 0.025 / std::sqrt(w)), 1e-5);
  }
}

// A sphere that closes in again, and a round trough: all of it is drawn, with its curvature.
TEST(Scene3d, SweptCurvesHaveAllTheirSheets) {
  const auto sphere = scene3d_json(scene_with(deep_ellipse_reflector(20.0, 20.0, 16.0, 6.0)));
  const auto& mirror = sphere["mirrors"][0];
  auto position = floats(mirror["position"]), curvature = floats(mirror["curvature_per_mm"]);
  ASSERT_EQ(position.size(), 3 * mirror["rings"].get<std::size_t>() * mirror["spokes"].get<std::size_t>());
  float low = 1e9f, high = -1e9f;
  for (std::size_t i = 0; i < curvature.size(); ++i) {
    const float x = position[3 * i], y = position[3 * i + 1], z = position[3 * i + 2];
    EXPECT_NEAR(std::hypot(x, y, z), 20.0f, 1e-4f) << "placed with its centre at the origin";
    EXPECT_NEAR(curvature[i], 0.05f, 1e-4f);
    low = std::min(low, z);
    high = std::max(high, z);
  }
  EXPECT_NEAR(high, std::sqrt(400.0f - 9.0f), 1e-3f) << "the hole";
  EXPECT_NEAR(low, -std::sqrt(400.0f - 64.0f), 1e-3f) << "the mouth, below the equator";

  std::vector<ProfileKnot> arc;
  for (int i = 0; i <= 64; ++i) {
    const double a = radians(150.0) * i / 64;
    arc.push_back({20.0 * std::sin(a), 20.0 * (1.0 - std::cos(a))});
  }
  const auto trough = scene3d_json(scene_with(profile_trough(arc, Aperture::rectangle(20.0, 60.0))));
  ASSERT_EQ(trough["mirrors"].size(), 2u);
  for (std::size_t side = 0; side < 2; ++side) {
    position = floats(trough["mirrors"][side]["position"]);
    curvature = floats(trough["mirrors"][side]["curvature_per_mm"]);
    for (std::size_t i = 0; i < curvature.size(); ++i) {
      EXPECT_NEAR(std::hypot(position[3 * i], position[3 * i + 2]), 20.0f, 1e-3f);
      EXPECT_LE(std::abs(position[3 * i + 1]), 30.001f);
      EXPECT_NEAR(curvature[i], 0.025f, 2e-4f);
    }
  }
}

TEST(Scene3d, RectanglesKeepTheirCorners) {
  const auto json = scene3d_json(
      scene_with(conic_reflector(ConicPreset::parabola, 20.0, 0.0, Aperture::rectangle(60.0, 20.0))));
  const auto position = floats(json["mirrors"][0]["position"]);
  int corners = 0;
  for (std::size_t i = 0; i < position.size(); i += 3) {
    EXPECT_LE(std::abs(position[i]), 30.001f);
    EXPECT_LE(std::abs(position[i + 1]), 10.001f);
    if (std::abs(std::abs(position[i]) - 30.0f) < 1e-3f &&
        std::abs(std::abs(position[i + 1]) - 10.0f) < 1e-3f)
      ++corners;
  }
  EXPECT_EQ(corners, 4);
}

TEST(Scene3d, BodiesAreTheirTrianglesAndFineOnesAreJoined) {
  Scene scene = scene_with(conic_reflector(ConicPreset::parabola, 20.0, 0.0, Aperture::circle(80.0)));
  // A sheet of n x n squares at z = -30.
  const auto sheet = [](std::uint32_t n) {
    Mesh mesh;
    for (std::uint32_t y = 0; y <= n; ++y) {
      for (std::uint32_t x = 0; x <= n; ++x) mesh.vertices_mm.push_back({10.0 * x / n, 10.0 * y / n, -30.0});
    }
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        const std::uint32_t a = y * (n + 1) + x;
        mesh.triangles.push_back({a, a + 1, a + n + 1});
        mesh.triangles.push_back({a + 1, a + n + 2, a + n + 1});
      }
    }
    return std::make_shared<const Mesh>(mesh);
  };
  Body coarse{.name = "housing", .mesh = sheet(4)}, fine{.name = "shield", .mesh = sheet(300)};
  scene.bodies = {coarse, fine};
  const auto bodies = scene3d_json(scene)["bodies"];
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(bodies[0]["name"], "housing");
  EXPECT_EQ(test::unpacked<std::uint32_t>(bodies[0]["index"]).size(), 3 * 32u);
  EXPECT_FALSE(bodies[0]["thinned"].get<bool>());
  const auto index = test::unpacked<std::uint32_t>(bodies[1]["index"]);
  EXPECT_TRUE(bodies[1]["thinned"].get<bool>());
  EXPECT_LE(index.size(), 3 * kMaxBodyTriangles);
  // Still the whole sheet: the triangles' areas sum to it.
  const auto p = floats(bodies[1]["position"]);
  double area = 0.0;
  for (std::size_t i = 0; i < index.size(); i += 3) {
    const auto at = [&](std::size_t k) {
      const std::size_t v = std::size_t{3} * index[i + k];
      return Vec3{p[v], p[v + 1], p[v + 2]};
    };
    area += 0.5 * length(cross(at(1) - at(0), at(2) - at(0)));
  }
  EXPECT_NEAR(area, 100.0, 2.0);
}

TEST(Scene3d, GlassesAreClosedPlatesAndRaysPassThem) {
  Scene scene = scene_with(conic_reflector(ConicPreset::parabola, 20.0, 0.0, Aperture::circle(80.0)));
  CoverGlass round, box;
  round.aperture = Aperture::circle(90.0);
  round.thickness_mm = 5.0;
  round.world_from_glass = Frame::from_axis(Direction::from({0, 0.2, -1}), 0.0, {0, 0, -30});
  box.name = "window";
  box.aperture = Aperture::rectangle(300.0, 200.0);
  box.world_from_glass = Frame::from_axis(Direction::from({0, 0, -1}), 30.0, {0, 0, -60});
  scene.glasses = {round, box};
  const auto json = scene3d_json(scene, {.rays = 200});
  ASSERT_EQ(json["glasses"].size(), 2u);
  EXPECT_EQ(json["glasses"][1]["name"], "window");
  const double expected[] = {0.5 * 96 * std::sin(2.0 * std::numbers::pi / 96) * 45.0 * 45.0 * 5.0,
                             300.0 * 200.0 * 3.0};
  for (std::size_t g = 0; g < 2; ++g) {
    const auto p = floats(json["glasses"][g]["position"]);
    const auto index = test::unpacked<std::uint32_t>(json["glasses"][g]["index"]);
    // By Gauss' theorem, and only if closed with all triangles the same way round.
    double volume = 0.0;
    Vec3 area{};
    for (std::size_t i = 0; i < index.size(); i += 3) {
      const auto at = [&](std::size_t k) {
        const std::size_t v = std::size_t{3} * index[i + k];
        return Vec3{p[v], p[v + 1], p[v + 2]};
      };
      volume += dot(at(0), cross(at(1), at(2))) / 6.0;
      area = area + cross(at(1) - at(0), at(2) - at(0));
    }
    EXPECT_NEAR(volume, expected[g], 1e-4 * expected[g]);
    EXPECT_NEAR(length(area), 0.0, 0.1);
  }
  // Being let through is no reflection: light that left the source and went through both plates is direct
  // still.
  const auto position = floats(json["rays"]["position"]);
  std::size_t direct_below = 0;
  for (std::size_t i = 0; i < json["rays"]["bounces"].size(); ++i)
    direct_below += json["rays"]["bounces"][i] == 0 && position[6 * i + 2] < -62.9f;
  EXPECT_GT(direct_below, 20u);
}

TEST(Scene3d, RaysStartAtTheSourceAndCountTheirBounces) {
  const auto json = scene3d_json(
      scene_with(conic_reflector(ConicPreset::parabola, 20.0, 0.0, Aperture::circle(80.0))), {.rays = 100});
  const auto& rays = json["rays"];
  EXPECT_EQ(rays["count"], 100);
  const auto position = floats(rays["position"]);
  ASSERT_EQ(position.size(), 6 * rays["bounces"].size());
  int starts = 0;
  for (std::size_t i = 0; i < rays["bounces"].size(); ++i) {
    if (rays["bounces"][i] != 0) continue;
    ++starts;
    const float* p = &position[6 * i];
    EXPECT_NEAR(std::hypot(p[0], p[1], p[2]), 0.5, 1e-4);
  }
  EXPECT_EQ(starts, 100);
  EXPECT_GT(rays["bounces"].size(), 130u);
}

}  // namespace
}  // namespace lucerna
