// SPDX-License-Identifier: Apache-2.0
// The programs and projects of examples/, run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "tests/support/code_blocks.h"
#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tests/support/temp_dir.h"

namespace lucerna::test {
namespace {

namespace fs = std::filesystem;

/// What a program of examples/ prints, run in `folder`; its exit code is part of what is expected of it.
std::string run_example(const fs::path& folder, const std::string& name, const std::string& arguments) {
  const TempDir dir;
  const std::string command = "cd '" + folder.string() + "' && '" + (examples() / name).string() + "' " +
                              arguments + " >'" + (dir / "out").string() + "' 2>&1 </dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0) << name << ": " << slurp(dir / "out");
  return slurp(dir / "out");
}

void expect_prints(const std::string& expected, const std::string& printed) {
  EXPECT_TRUE(prints_as(expected, printed)) << printed << "instead of\n" << expected;
}

fs::path project(const std::string& name) { return source_dir() / "examples" / (name + ".toml"); }

/// result.json of a project that was traced with `rays` rays.
nlohmann::json traced(const TempDir& dir, const std::string& name, const std::string& rays) {
  const ProgramResult run =
      run_lucerna(dir.path(), "trace '" + project(name).string() + "' -o out --rays " + rays);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return nlohmann::json::parse(slurp(dir / "out/result.json"));
}

double lumen(const nlohmann::json& figure) { return figure.at("value").get<double>(); }

nlohmann::json detector(const nlohmann::json& result, const std::string& name) {
  for (const nlohmann::json& d : result.at("detectors")) {
    if (d.at("name") == name) return d;
  }
  return {};
}

TEST(ExamplesCli, RaysModelAndBeam) {
  const TempDir dir;
  ASSERT_EQ(run_lucerna(dir.path(), "make-source led -n 100000 -o led.tm25ray").exit_code, 0);
  expect_prints(
      "100000 rays of 1000 lm\nvirtual focus (..., ..., ...) mm\nnot in led.txt: text has no place for the "
      "texts\n",
      run_example(dir.path(), "rays", "led.tm25ray led.txt"));
  EXPECT_EQ(run_lucerna(dir.path(), "check led.txt").exit_code, 0);
  expect_prints(
      "800 lm, ... leaves, ... bytes\nfar     excess ...\nnear ...\nfocus ...\nbeam ...\nfour_d ...\n",
      run_example(dir.path(), "model", "led.nfl"));
  EXPECT_EQ(run_lucerna(dir.path(), "info led.nfl").exit_code, 0);
  expect_prints("flux 931.8 +- 0.006 lm\naxis ...\nbeam ...\n",
                run_example(dir.path(), "beam", "led.tm25ray beam.ldt"));
  expect_prints(
      "EULUMDAT, 72 planes\nflux 931.8 lm, within 30 degrees ... lm\npeak ...\nstraight down ...\n"
      "flux ratio 0.500, shape moved by 0.000 degrees\n",
      run_example(dir.path(), "photometry", "beam.ldt half.ies"));
  EXPECT_EQ(run_lucerna(dir.path(), "check beam.ldt half.ies").exit_code, 0);
}

TEST(ExamplesCli, MirrorForATarget) {
  const TempDir dir;
  const std::string printed =
      run_example(dir.path(), "mirror", "'" + project("floodlight").string() + "' 8 a.step a.toml");
  expect_prints("error ... +- ... %, at first ... %\nlight in the target ...\n", printed);
  EXPECT_TRUE(slurp(dir / "a.step").starts_with("ISO-10303-21;"));
  EXPECT_EQ(run_lucerna(dir.path(), "trace a.toml -o again --rays 10000").exit_code, 0);
}

// Few rays and one search that ends by itself: what it reaches does not depend on the machine's speed.
TEST(ExamplesCli, LensForATarget) {
  const TempDir dir;
  std::string text = slurp(project("lens"));
  const std::string time = "time_s = 20\n";
  ASSERT_NE(text.find(time), std::string::npos);
  text.replace(text.find(time), time.size(), "restarts = 0\ntime_s = 1e6\n");
  std::ofstream(dir / "lens.toml") << text;
  fs::copy(source_dir() / "examples/disk.csv", dir.path());
  const ProgramResult run =
      run_lucerna(dir.path(), "design lens.toml -o lens --rays 8192 --report lens.html");
  EXPECT_EQ(run.exit_code, 0) << run.err << run.out;
  const auto result = nlohmann::json::parse(slurp(dir / "lens/result.json"));
  EXPECT_LE(result.at("error").at("c48").at("excess").get<double>(),
            0.5 * result.at("start").at("error").at("c48").at("excess").get<double>());
  EXPECT_EQ(run_lucerna(dir.path(), "trace lens/lens.toml -o again --rays 10000").exit_code, 0);
}

TEST(ExamplesCli, LedInAParaboloid) {
  const TempDir dir;
  const auto ledger = traced(dir, "led-paraboloid", "100000").at("ledger");
  EXPECT_NEAR(lumen(ledger.at("out_reflected")), 920.0, 1.0) << "all light meets the mirror once";
}

TEST(ExamplesCli, TirCollimator) {
  const TempDir dir;
  const auto result = traced(dir, "tir-collimator", "100000");
  const auto& ledger = result.at("ledger");
  EXPECT_GT(lumen(ledger.at("out_direct")), 0.8 * 300.0) << "Fresnel's losses at two faces, and the medium's";
  EXPECT_LT(lumen(ledger.at("out_reflected")), 0.1 * 300.0);
}

TEST(ExamplesCli, FilamentInAnEllipsoid) {
  const TempDir dir;
  const auto result = traced(dir, "filament-ellipsoid", "100000");
  EXPECT_GT(lumen(result.at("ledger").at("out_direct")), 0.2 * 1200.0);
  EXPECT_GT(lumen(detector(result, "gate").at("flux")), 0.6 * 1200.0) << "the mirror fills the gate";
}

TEST(ExamplesCli, TroughDownlightAndFloodlight) {
  for (const auto& [name, flux] :
       {std::pair("trough", 2000.0), {"downlight", 1500.0}, {"floodlight", 1000.0}}) {
    const TempDir dir;
    const auto ledger = traced(dir, name, "50000").at("ledger");
    double sum = lumen(ledger.at("out_direct")) + lumen(ledger.at("out_reflected"));
    for (const auto& [cause, light] : ledger.at("absorbed").items()) sum += lumen(light);
    EXPECT_NEAR(sum, flux, 1e-3 * flux) << name;
  }
}

// What a newcomer opens first is not stale: every file of the folder is in its README and run above.
TEST(ExamplesCli, AllAreListedAndShort) {
  const std::string readme = slurp(source_dir() / "examples/README.md");
  std::size_t programs = 0, projects = 0;
  for (const auto& entry : fs::directory_iterator(source_dir() / "examples")) {
    const std::string ending = entry.path().extension(), name = entry.path().filename();
    if (ending != ".cpp" && ending != ".toml") continue;
    ++(ending == ".cpp" ? programs : projects);
    EXPECT_NE(readme.find("(" + name + ")"), std::string::npos) << name;
    const std::string text = slurp(entry.path());
    if (ending == ".cpp") {
      EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 40) << name;
      EXPECT_EQ(text.find("#include \""), std::string::npos) << name;
    }
  }
  EXPECT_EQ(programs, 5u);
  EXPECT_EQ(projects, 7u);
}

}  // namespace
}  // namespace lucerna::test
