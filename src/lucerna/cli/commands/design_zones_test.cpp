// SPDX-License-Identifier: Apache-2.0
// `lucerna design` with a table of zones: verdicts, files, exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design_problem.h"
#include "tests/support/paths.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::slurp;
using test::TempDir;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;

constexpr const char* kZoneLamp = R"(
[[source]]
kind = "disk"
radius_mm = 1.0
flux_lm = 100
axis = "-x"
[[reflector]]
family = "bspline"
focal_mm = 8
diameter_mm = 60.0
position_mm = [-8, 0, 0]
axis = "+x"
[target]
axis = "+x"
)";

/// The plain mirror's spot already has what the first zone asks for, wherever the search is stopped.
constexpr const char* kEasy = R"([[target.zone]]
name = "middle"
h_deg = 0
v_deg = 0
cell_deg = 4
min_cd = 1
[[target.zone]]
name = "all round"
gamma_deg = [0, 180]
c_deg = [0, 360]
cell_deg = 10
max_cd = 1e6
)";

TEST(DesignZonesCli, ZonesThatAreMetExitWithNought) {
  const TempDir dir;
  write_file(dir / "p.toml", std::string(kZoneLamp) + kEasy);
  const auto run = run_lucerna(dir.path(), "design p.toml --rays 8192 --time 1 -o out --report r.html");
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_THAT(run.out, HasSubstr("2 of 2 zones met\n"));
  EXPECT_THAT(run.out, Not(HasSubstr("48 x 48")));  // there is no target to be off
  const Json json = Json::parse(slurp(dir / "out" / "result.json"));
  EXPECT_EQ(json["target"]["mode"], "zones");
  EXPECT_FALSE(json.contains("error"));
  ASSERT_EQ(json["zones"].size(), 2u);
  const Json& middle = json["zones"][0];
  EXPECT_EQ(middle["name"], "middle");
  EXPECT_EQ(middle["verdict"], "met");
  EXPECT_EQ(middle["cells"], 1);
  EXPECT_EQ(middle["bounds"][0]["bound"], "min_cd");
  EXPECT_EQ(middle["bounds"][0]["found"]["value"], middle["min"]["value"]);
  EXPECT_GT(middle["min"]["standard_error"], 0.0);
  EXPECT_EQ(json["start"]["zones"].size(), 2u);
  const std::string report = slurp(dir / "r.html");
  EXPECT_THAT(report, HasSubstr("Zones met"));
  EXPECT_THAT(report, HasSubstr("all round"));
  // What a design leaves reads again, zones and all.
  EXPECT_TRUE(design_problem(read_project(dir / "out" / "project.toml"), dir / "out" / "project.toml")
                  .target.zones_only);
}

TEST(DesignZonesCli, AMissedZoneIsNamedAndExitsWithOne) {
  const TempDir dir;
  write_file(dir / "p.toml", std::string(kZoneLamp) + kEasy + R"([[target.zone]]
name = "far too much"
h_deg = [-30, 30]
v_deg = [-30, 30]
cell_deg = 10
min_cd = 1e4
)");
  const auto run = run_lucerna(dir.path(), "design p.toml --rays 8192 --time 1 -o out");
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(run.out, HasSubstr("2 of 3 zones met; missed: far too much (min_cd: "));
  const Json json = Json::parse(slurp(dir / "out" / "result.json"));
  EXPECT_EQ(json["zones"][2]["verdict"], "missed");
  EXPECT_GT(json["zones"][2]["bounds"][0]["missing"], 0.5);
}

TEST(DesignZonesCli, TheExamplesOfTheDocsRead) {
  for (const char* name : {"rear-fog-lamp.toml", "road.toml"}) {
    const std::filesystem::path file = test::source_dir() / "docs/examples" / name;
    const DesignProblem problem = design_problem(read_project(file), file);
    EXPECT_TRUE(problem.target.zones_only) << name;
    EXPECT_GE(problem.target.zones->zones().size(), 3u) << name;
  }
}

TEST(DesignZonesCli, TheExampleWithABodyReads) {
  const std::filesystem::path file = test::source_dir() / "docs/examples/strut.toml";
  const DesignProblem problem = design_problem(read_project(file), file);
  EXPECT_EQ(problem.project.scene.bodies.size(), 1u);
}

}  // namespace
}  // namespace lucerna
