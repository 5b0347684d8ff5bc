// SPDX-License-Identifier: Apache-2.0
// Projects that cannot be traced: one clear line each, exit 1, nothing written.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

using test::run_lucerna;

constexpr const char* kLamp = "[[source]]\nkind = 'cylinder'\n";
constexpr const char* kBowl =
    "[[reflector]]\nfamily = 'revolution'\npreset = 'parabola'\nfocal_mm = 15\ndiameter_mm = 60\n"
    "position_mm = [0, 0, 15]\naxis = '-z'\n";

class TraceInputCli : public testing::Test {
 protected:
  void refuse(const std::string& project, const std::string& part) {
    write_file(dir / "p.toml", project);
    const auto run = run_lucerna(dir.path(), "trace p.toml -o out --rays 2000");
    EXPECT_EQ(run.exit_code, 1) << project;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_NE(run.err.find("p.toml"), std::string::npos) << "the file is named: " << run.err;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  }
  void refuse_mirror(const std::string& keys, const std::string& part) {
    refuse(std::string(kLamp) + "[[reflector]]\nposition_mm = [0, 0, 15]\naxis = '-z'\n" + keys, part);
  }
  test::TempDir dir;
};

TEST_F(TraceInputCli, MirrorsThatCannotBe) {
  refuse_mirror("family = 'revolution'\nprofile_mm = [[0, 0], [20, 10], [15, 5], [10, 15], [25, 5]]\n",
                "reflector[0].profile_mm");
  const std::string parabola =
      "family = 'revolution'\npreset = 'parabola'\nfocal_mm = 15\ndiameter_mm = 60\n";
  refuse_mirror(parabola + "hole_diameter_mm = 70\n", "the hole");
  refuse_mirror(parabola + "reflectance = 1.01\n",
                "reflector[0].reflectance: reflectance: 1.01 is outside 0..1");
  refuse_mirror(parabola + "reflectance = [[0, 0.9], [50, -0.1]]\n", "-0.1 is outside 0..1");
  refuse_mirror(parabola + "reflectance = [[50, 0.9], [10, 0.8]]\n", "expected angles ascending");
  refuse_mirror(parabola + "reflectance = nan\n", "expected a finite number");
  refuse_mirror(parabola + "slope_error_mrad = -1\n", "slope_error_mrad");
  refuse_mirror(parabola + "reflectence = 0.9\n",
                "line 10: reflector[0].reflectence: unknown key; the nearest known one is 'reflectance'");
}

TEST_F(TraceInputCli, ClearBodiesThatMeet) {
  const std::string plate =
      "[[body]]\nrole = 'solid'\nrefractive_index = 1.5\noutline_mm = [[0, 3], [5, 3], [5, 5], [0, 5]]\n";
  refuse(std::string(kLamp) + plate + "name = 'a'\n" + plate + "name = 'b'\nposition_mm = [0, 0, 1]\n",
         "expected them apart");
}

TEST_F(TraceInputCli, AReportDoesNotTakeTheProjectsPlace) {
  const std::string project = std::string(kLamp) + kBowl;
  write_file(dir / "p.toml", project);
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --rays 2000 --report p.toml");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("p.toml: a report is an HTML file, expected the ending .html"), std::string::npos)
      << run.err;
  EXPECT_EQ(test::slurp(dir / "p.toml"), project);
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
}

TEST_F(TraceInputCli, ViewsWithoutASide) {
  refuse(std::string(kLamp) + kBowl + "[[detector]]\nkind = 'luminance'\nfrom = [0, 0, -1]\nup = '-z'\n",
         "detector[0].up: is along the line of sight");
}

TEST_F(TraceInputCli, FilesThatAreNoMirrors) {
  write_file(dir / "nan.csv", "1,2,3,4\n1,2,3,4\n1,nan,3,4\n1,2,3,4\n");
  write_file(dir / "sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write_file(dir / "half.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n");
  const auto refuse_file = [&](const std::string& keys, const std::string& part) {
    write_file(dir / "p.toml", std::string(kLamp) + keys);
    const auto run = run_lucerna(dir.path(), "trace p.toml -o out");
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  };
  const std::string map = "[[reflector]]\nfamily = 'heightmap'\nsize_mm = [9, 9]\nfile = ";
  refuse_file(map + "'nan.csv'\n", "nan.csv: line 3, column 2: found 'nan', expected a finite number");
  refuse_file(map + "'none.npy'\n", "none.npy");
  refuse_file("[[body]]\nfile = 'sheet.obj'\n", "body[0].file: the mesh is open: 3 edges");
  refuse_file("[[body]]\nfile = 'half.stl'\n", "half.stl");
  refuse_file("[[reflector]]\nfamily = 'mesh'\nfile = 'none.stl'\n", "none.stl");
}

TEST_F(TraceInputCli, ProfilesThatAreNoCurve) {
  const std::string curve = "family = 'revolution'\nfile = 'curve.csv'\n";
  const auto refuse_curve = [&](const std::string& csv, const std::string& part) {
    write_file(dir / "curve.csv", csv);
    write_file(dir / "p.toml", std::string(kLamp) + "[[reflector]]\n" + curve);
    const auto run = run_lucerna(dir.path(), "trace p.toml -o out");
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
  };
  refuse_curve("r_mm,z_mm\n0,0\n10,x\n", "curve.csv: line 3, column 2: found 'x'");
  refuse_curve("0,0,0\n10,5,5\n", "curve.csv: has 3 columns, expected two");
  refuse_curve("r,z\n", "curve.csv: has 0 columns, expected two");
  refuse_curve("0,0\n20,10\n20,30\n5,20\n10,5\n30,2\n",
               "reflector[0].file: reflector: the profile crosses itself");
  refuse_curve("5,0\n-1,10\n2,10\n", "point 2 is [-1, 10], expected finite numbers with r >= 0");
  refuse_curve("5,0\n5,0\n5,10\n", "points 1 and 2 are the same");
}

TEST_F(TraceInputCli, SourcesInTheMirror) {
  refuse(std::string(kLamp) + "position_mm = [0, 0, 14]\n" + kBowl,
         "the source reaches through the mirror; expected a hole_diameter_mm");
  write_file(dir / "p.toml",
             std::string(kLamp) + "position_mm = [0, 0, 14]\n" + kBowl + "hole_diameter_mm = 4\n");
  EXPECT_EQ(run_lucerna(dir.path(), "trace p.toml -o out --rays 2000").exit_code, 0);
}

TEST_F(TraceInputCli, KeysNameTheirNearest) {
  const std::string good = std::string(kLamp) + kBowl;
  refuse(good + "[[detector]]\nkind = 'plane'\nsize_nm = [1, 1]\n",
         "detector[0].size_nm: unknown key; the nearest known one is 'size_mm'");
  refuse(good + "[[boddy]]\nfile = 'x.stl'\n", "nearest known one is 'body'");
  refuse(good + "[[detector]]\nkind = 'plain'\n", "expected far-field, plane, luminance or rays");
  refuse(good + "[[detector]]\nkind = 'far-field'\nname = 'a'\n[[detector]]\nkind = 'rays'\nname = 'a'\n",
         "two detectors are named 'a'");
}

TEST_F(TraceInputCli, StepsThatDoNotDivideTheCircleAreToldAtTheirKey) {
  const std::string far = std::string(kLamp) + kBowl + "[[detector]]\nkind = 'far-field'\n";
  refuse(far + "gamma_step_deg = 0.7\n",
         "detector[0].gamma_step_deg: detector 'far-field': gamma_step_deg = 0.7");
  refuse(far + "gamma_step_deg = 1\nc_step_deg = 7\n",
         "detector[0].c_step_deg: detector 'far-field': c_step_deg = 7");
  refuse(far + "c_step_deg = 0.05\ngamma_step_deg = 0.01\n",
         "detector[0].gamma_step_deg: detector 'far-field'");
  refuse(far + "c_step_deg = 0.001\n", "detector[0].c_step_deg: detector 'far-field'");
}

TEST_F(TraceInputCli, LightThatReachesNoMirrorIsTold) {
  write_file(dir / "p.toml", "[[source]]\nkind = \"disk\"\naxis = \"-z\"\n" + std::string(kBowl));
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --rays 2000");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_NE(run.err.find("lucerna: no light reaches a mirror"), std::string::npos) << run.err;
  const auto json = nlohmann::json::parse(test::slurp(dir / "out" / "result.json"));
  ASSERT_EQ(json["warnings"].size(), 1u);
  EXPECT_NE(run.err.find(json["warnings"][0].get<std::string>()), std::string::npos);
}

TEST_F(TraceInputCli, BenchHasNoCudaHere) {
  const auto cuda = run_lucerna(dir.path(), "bench --device cuda");
  EXPECT_EQ(cuda.exit_code, 1);
  EXPECT_EQ(std::count(cuda.err.begin(), cuda.err.end(), '\n'), 1) << cuda.err;
  EXPECT_EQ(run_lucerna(dir.path(), "bench --device abacus").exit_code, 2);
  EXPECT_EQ(run_lucerna(dir.path(), "bench --cells 100").exit_code, 2);
  EXPECT_EQ(run_lucerna(dir.path(), "bench --rays 0").exit_code, 2);
}

TEST_F(TraceInputCli, BenchTellsOfEveryScene) {
  const auto run = run_lucerna(dir.path(), "bench --rays 2e4 --cells 64 --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["results"].size(), 3u);
  EXPECT_EQ(json["device"], "cpu");
  for (const auto& f : json["results"]) {
    for (const char* key : {"rays_per_s", "rays_per_cpu_s", "casts_per_ray", "build_ms", "update_ms",
                            "heights_mb", "hierarchy_mb"})
      EXPECT_GT(f[key].get<double>(), 0.0) << key;
    EXPECT_GE(f["casts_per_ray"].get<double>(), 1.0);
    EXPECT_TRUE(f["embree"].is_null() || f["embree"]["ratio"].get<double>() > 0.0);
    EXPECT_NEAR(f["heights_mb"].get<double>(), 65 * 65 * 12e-6, 1e-9);
  }
  EXPECT_EQ(json["results"][0]["scene"], "para");
  EXPECT_NE(json["isa"], "scalar");
}

TEST_F(TraceInputCli, ATraceOfNoTimeIsRefused) {
  write_file(dir / "p.toml", std::string(kLamp) + kBowl);
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --time 0");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("--time 0 is not > 0"), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(dir / "out")) << "it was made and nothing was written into it";
}

TEST_F(TraceInputCli, WhatIsNoTextIsNoProject) {
  write_file(dir / "p.toml", std::string("NFL\0\xff\xfe", 6));
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out");
  EXPECT_NE(run.err.find("p.toml: is no text; expected a project"), std::string::npos) << run.err;
}

// What a project assumes is told once, and stands in result.json too.
TEST_F(TraceInputCli, WarningsOfTheProjectAreInTheResult) {
  write_file(dir / "p.toml", std::string(kLamp) + kBowl +
                                 "[reflector.data_sheet]\ntotal = 0.8\ndiffuse = 0.2\ngloss_60 = 400\n");
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --rays 2000 --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto warnings = nlohmann::json::parse(run.out)["warnings"];
  ASSERT_FALSE(warnings.empty());
  const std::string first = warnings[0];
  EXPECT_NE(first.find("data_sheet: assumed"), std::string::npos) << first;
  EXPECT_NE(run.err.find(first), std::string::npos);
  EXPECT_EQ(run.err.find(first), run.err.rfind(first)) << run.err;
  const auto written = nlohmann::json::parse(read_file(dir / "out/result.json", 1 << 20));
  EXPECT_EQ(written["warnings"], warnings);
}

}  // namespace
}  // namespace lucerna
