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

}  // namespace
}  // namespace lucerna
