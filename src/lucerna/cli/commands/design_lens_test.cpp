// SPDX-License-Identifier: Apache-2.0
// `lucerna design` of a lens as a user meets it: files, limits, what is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "lucerna/core/io/file.h"
#include "lucerna/mesh.h"
#include "lucerna/photometric_file.h"
#include "lucerna/project.h"
#include "tests/support/run_program.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::slurp;
using test::TempDir;
using testing::HasSubstr;
using Json = nlohmann::json;

void write_lens_project(const TempDir& dir, const std::string& design = "") {
  PhotometricFile beam;
  beam.distribution = uniform_distribution(0.0, 1.0);
  for (std::size_t g = 0; g < beam.distribution.gamma_deg.size(); ++g) {
    const double x = beam.distribution.gamma_deg[g] / 25.0;
    beam.distribution.at(0, g) = 1000.0 * std::exp(-x * x * x * x);
  }
  write_photometric_file(dir / "beam.ldt", beam, PhotometricFormat::ldt);
  write_file(dir / "p.toml", R"([[source]]
kind = "disk"
radius_mm = 0.5
axis = "-z"
[[body]]
role = "solid"
refractive_index = 1.49
outline_mm = [[0, 3], [9, 3], [9, 5], [6, 7.6], [3, 9.1], [0, 9.6]]
axis = "-z"
[target]
file = "beam.ldt"
[design]
free_sides = 2
intervals = 6
restarts = 1
time_s = 1e6
)" + design);
}

constexpr const char* kQuick = "design p.toml --rays 32768 -o out";

TEST(DesignLensCli, LeavesWhatAManufacturerAndATraceNeed) {
  const TempDir dir;
  write_lens_project(dir, "[design.limits]\nmax_height_mm = 6.8\nmax_diameter_mm = 18\n");
  const auto run = run_lucerna(dir.path(), std::string(kQuick) + " --report out.html");
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_THAT(run.out, HasSubstr("a lens of 7 parameters"));
  EXPECT_THAT(run.out, HasSubstr("limit max_height_mm"));
  EXPECT_THAT(run.out, testing::Not(HasSubstr("bound")));
  const Json result = Json::parse(slurp(dir / "out/result.json"));
  EXPECT_TRUE(result.at("lens").get<bool>());
  EXPECT_EQ(result.at("parameters"), 7);
  EXPECT_LT(result.at("error").at("c12").at("excess").get<double>(),
            result.at("start").at("error").at("c12").at("excess").get<double>());
  EXPECT_EQ(open_edges(read_mesh(dir / "out/lens.stl")), 0u) << "watertight";
  EXPECT_EQ(open_edges(read_mesh(dir / "out/lens.obj")), 0u);
  EXPECT_THAT(slurp(dir / "out/lens.step"), HasSubstr("MANIFOLD_SOLID_BREP"));
  EXPECT_THAT(slurp(dir / "out/lens.dxf"), HasSubstr("AC1009"));
  EXPECT_TRUE(slurp(dir / "out/lens.csv").starts_with("r_mm,z_mm"));
  EXPECT_THAT(slurp(dir / "out.html"), HasSubstr("Lens design"));
  EXPECT_EQ(run_lucerna(dir.path(), "trace out/lens.toml -o again --rays 10000").exit_code, 0);
  EXPECT_EQ(run_lucerna(dir.path(), "report out -o again.html").exit_code, 0);
}

TEST(DesignLensCli, RefusesWhatLensesDoNotHave) {
  const TempDir dir;
  write_lens_project(dir);
  for (const char* option : {" --tolerances", " --pareto", " --advise", " --resume"}) {
    const auto run = run_lucerna(dir.path(), kQuick + std::string(option));
    EXPECT_EQ(run.exit_code, 1) << option;
    EXPECT_THAT(run.err, HasSubstr("a lens is designed without; see " + std::string(option + 1)));
  }
  write_lens_project(dir, "[design.limits]\nmin_radius_mm = 3\n");
  const auto run = run_lucerna(dir.path(), kQuick);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("is a limit on mirrors"));
  write_lens_project(dir, "[design.limits]\nsymmetry = \"threefold\"\n");
  EXPECT_THAT(run_lucerna(dir.path(), kQuick).err, HasSubstr("c90-c270"));
}

/// A project for even light on a floor that a detector watches.
std::string floor_text(const std::string& source_axis, const std::string& height_mm,
                       const std::string& detector) {
  return "[[source]]\nkind = \"disk\"\naxis = \"" + source_axis + R"("
[[body]]
role = "solid"
refractive_index = 1.49
outline_mm = [[0, 0.5], [15, 0.5], [15, 3], [11.5, 6.2], [8, 8.2], [4, 9.6], [0, 10]]
[[detector]]
kind = "plane"
name = ")" +
         detector + R"("
[target]
kind = "plane"
file = "even.csv"
normal = "-z"
size_mm = [800, 400]
position_mm = [0, 0, )" +
         height_mm + R"(]
[design]
free_sides = 2
family = "bspline"
intervals = 4
restarts = 0
time_s = 1e6
)";
}

TEST(DesignLensCli, WhatCannotBeLitIsRefusedAndLeavesNoFolder) {
  const TempDir dir;
  write_file(dir / "even.csv", "1,1\n");
  const auto refused = [&](const std::string& text) {
    write_file(dir / "p.toml", text);
    const auto run = run_lucerna(dir.path(), kQuick);
    EXPECT_EQ(run.exit_code, 1) << run.out;
    EXPECT_FALSE(std::filesystem::exists(dir / "out"));
    return run.err;
  };
  EXPECT_THAT(refused(floor_text("-z", "1000", "floor")), HasSubstr("no light reaches the lens: of "));
  EXPECT_THAT(refused(floor_text("+z", "5", "floor")),
              testing::AllOf(HasSubstr("target.position_mm: the lens reaches the plane"),
                             HasSubstr("up to 5 mm behind")));
  for (const char* name : {"lens", "history", "tolerances"}) {
    EXPECT_THAT(refused(floor_text("+z", "1000", name)),
                HasSubstr(fmt::format("line 10: detector[0].name: found '{}'", name)));
  }
  write_file(dir / "even.csv", "1e308,1e308\n");
  EXPECT_THAT(refused(floor_text("+z", "1000", "floor")), HasSubstr("even.csv: the sum of the illuminances"));
}

// A lens of revolution leaves its outline too, a free form has none.
TEST(DesignLensCli, FilesOfTheLensBeforeAreGone) {
  const TempDir dir;
  write_file(dir / "even.csv", "1,1\n");
  write_file(dir / "p.toml", floor_text("+z", "1000", "floor"));
  std::filesystem::create_directory(dir / "out");
  for (const char* name : {"lens.dxf", "lens.csv", "mine.txt"}) write_file(dir.path() / "out" / name, "old");
  const auto run = run_lucerna(dir.path(), "design p.toml --rays 8192 -o out --force");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_FALSE(std::filesystem::exists(dir / "out/lens.dxf"));
  EXPECT_FALSE(std::filesystem::exists(dir / "out/lens.csv"));
  EXPECT_TRUE(std::filesystem::exists(dir / "out/mine.txt"));
}

}  // namespace
}  // namespace lucerna
