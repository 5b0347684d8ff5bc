// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/sections/project_content.h"

#include <gtest/gtest.h>

#include <sstream>

#include "lucerna/core/io/file.h"
#include "lucerna/intensity.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/scene.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::string content(const Project& project) {
  std::ostringstream text;
  text << content_tables(toml_tables(project), project.memory);
  return text.str();
}

std::string content_of(const RaySet& rays) {
  ProjectMemory memory;
  memory.rays["b"] = std::make_shared<RaySet>(rays);
  return content(parse_project("[[source]]\nfile = 'b'\n", "lamp.toml", memory));
}

RaySet rays_of(std::uint64_t seed = 1) {
  RaySet set;
  set.header.set_flux(100.0);
  set.rays = sample(*make_emitter({.kind = EmitterKind::led}), 2000, Sequence(SequenceKind::random, seed));
  return set;
}

TEST(ProjectContent, IsThatOfFilesWhereverTheyAre) {
  constexpr const char* kMesh = "[[source]]\nkind = 'disk'\n[[body]]\nfile = 'm.obj'\n";
  const test::TempDir one, two;
  const auto tetrahedron = [](const char* x) {
    return std::string("v 0 0 9\nv ") + x + " 0 9\nv 0 1 9\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  };
  const auto project_in = [&](const test::TempDir& folder) {
    write_file(folder / "m.obj", tetrahedron("1"));
    return parse_project(kMesh, folder / "lamp.toml");
  };
  const Project project = project_in(one);
  const std::string here = content(project);
  EXPECT_EQ(here, content(project_in(two)));
  EXPECT_EQ(here.find(one.path().string()), std::string::npos);
  write_file(one / "m.obj", tetrahedron("2"));
  EXPECT_NE(here, content(project));
  std::filesystem::remove(one / "m.obj");
  EXPECT_THROW(content(project), InputError);
}

TEST(ProjectContent, IsThatOfRaysInMemory) {
  const RaySet rays = rays_of();
  const std::string whole = content_of(rays);
  EXPECT_EQ(whole, content_of(rays));
  RaySet moved = rays, dimmed = rays;
  moved.rays.z_mm[1999] += 1e-3f;
  dimmed.header.set_flux(99.0);
  EXPECT_NE(whole, content_of(moved));
  EXPECT_NE(whole, content_of(dimmed));
  RaySet coloured = rays, numbered = rays;
  for (RaySet* set : {&coloured, &numbered}) set->rays.extra = {std::vector<float>(2000, 550.0f)};
  coloured.header.columns = {{ColumnKind::wavelength_nm, ""}};
  numbered.header.columns = {{ColumnKind::additional, ""}};
  EXPECT_NE(content_of(coloured), content_of(numbered)) << "the same numbers, another meaning";
}

TEST(ProjectContent, IsThatOfModelsAndTargetsInMemory) {
  const auto with = [](double peak_cd, std::uint64_t seed) {
    ProjectMemory memory;
    memory.models["m"] = compress(rays_of(seed));
    auto target = std::make_shared<IntensityDistribution>(uniform_distribution(90.0, 45.0));
    target->cd.assign(target->cd.size(), peak_cd);
    memory.targets["t"] = target;
    return content(parse_project("[[source]]\nfile = 'm'\n[target]\nfile = 't'\n", "lamp.toml", memory));
  };
  EXPECT_EQ(with(1.0, 1), with(1.0, 1));
  EXPECT_NE(with(1.0, 1), with(1.0 + 1e-15, 1)) << "the target's last bits";
  EXPECT_NE(with(1.0, 1), with(1.0, 2)) << "another model";
}

}  // namespace
}  // namespace lucerna
