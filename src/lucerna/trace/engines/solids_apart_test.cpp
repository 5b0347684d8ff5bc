// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solids_apart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/mesh.h"
#include "tests/support/random_rays.h"

namespace lucerna {
namespace {

using testing::HasSubstr;

/// Between z = 5 and 8, 20 mm wide.
Solid clear_disk() {
  Solid s;
  s.name = "disk";
  s.outline_mm = {{0, 5}, {10, 5}, {10, 8}, {0, 8}};
  return s;
}

CoverGlass glass_from(double z_mm, const Aperture& aperture) {
  CoverGlass g;
  g.name = "window";
  g.aperture = aperture;
  g.thickness_mm = 2.0;
  g.world_from_glass = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, z_mm});
  return g;
}

std::string apart_error(const Scene& scene) {
  return test::message_of<InputError>([&] { check_apart(scene); });
}

TEST(SolidsApart, CoverGlassesMayNotTouchASolid) {
  for (const Aperture& aperture : {Aperture::circle(12.0), Aperture::rectangle(12.0, 30.0)}) {
    // Below it, touching; cutting it; within it; touching from above.
    for (const double z_mm : {3.0, 4.0, 5.5, 7.0, 8.0}) {
      Scene scene;
      scene.solids = {clear_disk()};
      scene.glasses = {glass_from(z_mm, aperture)};
      EXPECT_THAT(apart_error(scene), HasSubstr("solid 'disk' and cover glass 'window'")) << z_mm;
    }
    for (const double z_mm : {2.99, 8.01, 20.0}) {
      Scene scene;
      scene.solids = {clear_disk()};
      scene.glasses = {glass_from(z_mm, aperture)};
      EXPECT_NO_THROW(check_apart(scene)) << z_mm;
    }
  }
}

TEST(SolidsApart, CoverGlassesShareNoRoom) {
  Scene scene;
  scene.glasses = {glass_from(0.0, Aperture::circle(12.0)), glass_from(2.0, Aperture::circle(12.0))};
  EXPECT_NO_THROW(check_apart(scene)) << "face to face";
  scene.glasses[1] = glass_from(1.0, Aperture::circle(12.0));
  scene.glasses[1].name = "other";
  EXPECT_EQ(apart_error(scene),
            "cover glass 'window' and cover glass 'other' share room; expected them apart");
  // Crossing it at an angle; smaller and within.
  scene.glasses[1].world_from_glass = Frame::rotation(Direction::from({1, 0, 0}), 1.0);
  EXPECT_THAT(apart_error(scene), HasSubstr("share room"));
  scene.glasses[1] = glass_from(0.5, Aperture::circle(2.0));
  scene.glasses[1].thickness_mm = 0.2;
  EXPECT_THAT(apart_error(scene), HasSubstr("share room"));
}

Mesh cylinder_mesh(double radius, double z, double height, bool outward) {
  Mesh m = solid_of_revolution(
      std::vector<std::array<double, 2>>{{0, z}, {radius, z}, {radius, z + height}, {0, z + height}}, 24);
  for (auto& t : m.triangles) {
    if (!outward) std::swap(t[1], t[2]);
  }
  return m;
}

Scene scene_of_shells(const std::vector<Mesh>& shells) {
  Mesh all;
  for (const Mesh& shell : shells) {
    const auto first = static_cast<std::uint32_t>(all.vertices_mm.size());
    all.vertices_mm.insert(all.vertices_mm.end(), shell.vertices_mm.begin(), shell.vertices_mm.end());
    for (const auto& t : shell.triangles) all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  Solid s;
  s.name = "cast";
  s.mesh = std::make_shared<const Mesh>(std::move(all));
  Scene scene;
  scene.solids = {s};
  return scene;
}

TEST(SolidsApart, ShellsOfAMeshAreBesideEachOtherOrHollows) {
  const Mesh low = cylinder_mesh(5, 0, 3, true), high = cylinder_mesh(5, 10, 3, true);
  const Mesh within = cylinder_mesh(2, 1, 1, true), hollow = cylinder_mesh(2, 1, 1, false);
  const Mesh across = cylinder_mesh(2, 1, 5, true), turned = cylinder_mesh(5, 10, 3, false);
  EXPECT_NO_THROW(check_apart(scene_of_shells({low, high})));
  EXPECT_NO_THROW(check_apart(scene_of_shells({low, hollow, high})));
  // All turned inside out is as good.
  EXPECT_NO_THROW(check_apart(scene_of_shells({cylinder_mesh(5, 0, 3, false), turned, within})));
  EXPECT_THAT(apart_error(scene_of_shells({low, turned})),
              HasSubstr("solid 'cast': one of 2 shells of its mesh is turned the wrong way"));
  EXPECT_THAT(apart_error(scene_of_shells({low, within})), HasSubstr("turned the wrong way"));
  EXPECT_THAT(apart_error(scene_of_shells({low, across})), HasSubstr("cut each other"));
}

/// A paraboloid that ends at z = 31.25, without its front.
PlacedReflector paraboloid(const Aperture& aperture) {
  PlacedReflector mirror;
  mirror.reflector = conic_reflector(ConicPreset::parabola, 20.0, 0.0, aperture);
  return mirror;
}

TEST(WithinPlates, MirrorsAreNamed) {
  const Aperture round = Aperture::circle(100.0, 8.0), square = Aperture::rectangle(70.0, 70.0),
                 holed = Aperture::rectangle(70.0, 70.0, 20.0);
  struct Case {
    Aperture mirror, glass;
    double z_mm, thickness_mm;
    bool is_within;
  };
  // The square's corners are at z = 30.6, the middle of its sides at 15.3.
  const Case cases[] = {
      {round, Aperture::circle(120.0), 31.25, 2.0, false},       // lies on the rim
      {round, Aperture::circle(120.0), 31.2, 2.0, true},         // holds the rim
      {round, Aperture::circle(120.0), 10.0, 0.01, true},        // is cut by the mirror
      {round, Aperture::circle(20.0), 15.0, 2.0, false},         // hangs within the mirror
      {round, Aperture::rectangle(20.0, 60.0), 9.0, 1.0, true},  // longer than the mirror is wide there
      {round, Aperture::circle(120.0), -3.0, 2.0, false},        // behind it
      {square, Aperture::rectangle(90.0, 90.0), 30.625, 2.0, false},
      {square, Aperture::rectangle(90.0, 90.0), 30.0, 2.0, true},
      {holed, Aperture::circle(6.0), 0.5, 2.0, false},  // lies in the hole
  };
  for (const Case& c : cases) {
    Scene scene;
    scene.reflectors = {paraboloid(c.mirror)};
    scene.glasses = {glass_from(c.z_mm, c.glass)};
    scene.glasses[0].thickness_mm = c.thickness_mm;
    // Turned and moved together, nothing changes.
    for (const Frame& frame :
         {Frame(), Frame::from_axis(Direction::from({1, 2, -1}), 0.3, {500, -200, 90})}) {
      Scene placed = scene;
      placed.reflectors[0].world_from_reflector = frame;
      placed.glasses[0].world_from_glass = frame * scene.glasses[0].world_from_glass;
      const std::vector<std::string> found = within_plates(placed);
      ASSERT_EQ(found.size(), c.is_within ? 1u : 0u) << c.z_mm << ' ' << c.thickness_mm;
      if (!c.is_within) continue;
      EXPECT_THAT(found[0], HasSubstr("reflector 1 reaches into cover glass 'window'"));
    }
  }
}

TEST(WithinPlates, BodiesAreNamed) {
  const auto lines = [](double low_mm, double height_mm) {
    Body lamp;
    lamp.name = "lamp";
    lamp.mesh = std::make_shared<const Mesh>(cylinder_mesh(4, low_mm, height_mm, true));
    Scene scene;
    scene.bodies = {lamp};
    scene.glasses = {glass_from(10.0, Aperture::circle(50.0))};
    return within_plates(scene);
  };
  EXPECT_THAT(lines(5.0, 5.0), testing::IsEmpty()) << "touches it";
  EXPECT_THAT(lines(12.0, 5.0), testing::IsEmpty()) << "stands on it";
  for (const auto& [low_mm, height_mm] : {std::pair{5.0, 5.1}, {5.0, 20.0}, {10.5, 1.0}})
    EXPECT_THAT(lines(low_mm, height_mm), testing::ElementsAre(HasSubstr("body 'lamp' reaches into")))
        << low_mm;
}

}  // namespace
}  // namespace lucerna
