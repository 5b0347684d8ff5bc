// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/sections/project_memory.h"

#include <gtest/gtest.h>

#include "lucerna/photometric_file.h"
#include "lucerna/ray_file.h"
#include "lucerna/trace.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::shared_ptr<RaySet> led_rays(std::optional<double> flux) {
  auto set = std::make_shared<RaySet>();
  if (flux) set->header.set_flux(*flux);
  set->rays = sample(*make_emitter({.kind = EmitterKind::led}), 5000, Sequence(SequenceKind::random, 1));
  return set;
}

TraceResult light_of(const Project& project) {
  TraceOptions options;
  options.last_ray = 5000;
  return trace(project.scene, options);
}

constexpr const char* kTwo = "[[source]]\nfile = 'a.nfl'\n[[source]]\nfile = 'b'\nflux_lm = 7\n";

TEST(ProjectMemory, ObjectsStandForFilesAndCanBeSaved) {
  const auto rays = led_rays(100.0);
  ProjectMemory memory;
  memory.models["a.nfl"] = compress(*rays);
  memory.rays["b"] = rays;
  const test::TempDir dir;
  const Project project = parse_project(kTwo, dir / "lamp.toml", memory);
  EXPECT_EQ(total_flux(project.scene.sources), 107.0);
  EXPECT_TRUE(project.inputs.empty());
  const Project saved = save_memory(project, dir.path());
  EXPECT_EQ(saved.inputs.size(), 2u);
  EXPECT_TRUE(saved.memory.empty());
  const Project again = parse_project(project_text(saved), dir / "again.toml");
  EXPECT_TRUE(light_of(again) == light_of(project));
  EXPECT_THROW(parse_project(kTwo, dir / "lamp.toml"), InputError) << "no such files";
}

// Python names them all alike: a second scene in a folder must not change the first.
TEST(ProjectMemory, FilesOfOtherProjectsStay) {
  const test::TempDir dir;
  const auto saved = [&](double flux_lm) {
    const auto rays = led_rays(flux_lm);
    ProjectMemory memory;
    memory.models["a.nfl"] = compress(*rays);
    memory.rays["b"] = rays;
    return save_memory(parse_project(kTwo, dir / "lamp.toml", memory), dir.path());
  };
  const Project one = saved(100.0), other = saved(999.0), again = saved(999.0);
  EXPECT_NE(one.inputs, other.inputs);
  EXPECT_EQ(other.inputs, again.inputs) << "what is there already is not written again";
  EXPECT_EQ(total_flux(parse_project(project_text(one), dir / "1.toml").scene.sources), 107.0);
  EXPECT_EQ(total_flux(parse_project(project_text(other), dir / "2.toml").scene.sources), 1006.0);
  EXPECT_FALSE(std::filesystem::exists(dir / "a-3.nfl"));
}

TEST(ProjectMemory, RaysWithoutAFluxGetTheProjects) {
  ProjectMemory memory;
  memory.rays["b"] = led_rays(std::nullopt);
  const char* given = "[[source]]\nfile = 'b'\nflux_lm = 7\n";
  EXPECT_EQ(total_flux(parse_project(given, "lamp.toml", memory).scene.sources), 7.0);
  EXPECT_THROW(parse_project("[[source]]\nfile = 'b'\n", "lamp.toml", memory), InputError);
  EXPECT_THROW(parse_project("[[source]]\nfile = 'b'\nflux_w = 7\n", "lamp.toml", memory), InputError);
}

TEST(ProjectMemory, TargetsAreSavedToTheLastBit) {
  ProjectMemory memory;
  auto target = std::make_shared<IntensityDistribution>(uniform_distribution(90.0, 45.0));
  target->cd.assign(target->cd.size(), 1.0 / 3.0);
  memory.targets["t"] = target;
  const test::TempDir dir;
  const Project project =
      parse_project("[[source]]\nkind = 'disk'\n[target]\nfile = 't'\n", dir / "lamp.toml", memory);
  const Project saved = save_memory(project, dir.path());
  const PhotometricFile file = read_photometric_file(dir / "t.ldt");
  EXPECT_NEAR(file.distribution.cd.front(), 1.0 / 3.0, 1e-15);
  EXPECT_NE(project_text(saved).find("t.ldt"), std::string::npos);
}

TEST(ParseReflectors, ReadsMirrorsAlone) {
  const char* mirror =
      "[[reflector]]\nfamily = 'revolution'\npreset = 'parabola'\nfocal_mm = 10\ndiameter_mm = 40\n";
  const auto read = parse_reflectors(mirror, "mirror");
  ASSERT_EQ(read.size(), 1u);
  EXPECT_NEAR(read.front().reflector.surface->at(20.0, 0.0).z_mm, 10.0, 1e-12);
  EXPECT_THROW(parse_reflectors(std::string(mirror) + "[target]\n", "mirror"), InputError);
  EXPECT_THROW(parse_reflectors("[[reflector]\n", "mirror"), InputError);
}

}  // namespace
}  // namespace lucerna
