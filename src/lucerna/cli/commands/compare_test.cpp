// SPDX-License-Identifier: Apache-2.0
// `compare` of ray sets and models, as a user meets it.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::slurp;
using test::TempDir;
using Json = nlohmann::json;

using test::has;

void run_well(const TempDir& dir, const std::string& command) {
  const auto run = run_lucerna(dir.path(), command);
  ASSERT_EQ(run.exit_code, 0) << command << '\n' << run.err;
}

Json json_of(const TempDir& dir, const std::string& command) {
  const auto run = run_lucerna(dir.path(), command + " --json");
  EXPECT_EQ(run.exit_code, 0) << command << '\n' << run.err;
  return Json::parse(run.out);
}

TEST(CompareCli, TwoSetsOfOneSourceDifferByNoiseInEveryFigure) {
  const TempDir dir;
  run_well(dir, "make-source disk -n 20000 --seed 1 -o a.tm25ray");
  run_well(dir, "make-source disk -n 20000 --seed 2 -o b.tm25ray");
  const Json result = json_of(dir, "compare a.tm25ray b.tm25ray -o out --cells-um 100,300");
  EXPECT_EQ(Json::parse(slurp(dir / "out/result.json")), result);
  ASSERT_EQ(result["focus_plane"].size(), 2u);
  EXPECT_EQ(result["focus_plane"][1]["cell_um"], 300.0);
  for (const Json& plane : result["focus_plane"]) {
    EXPECT_NEAR(plane["l1"].get<double>() / plane["floor"].get<double>(), 1.0, 0.5);
  }
  for (const char* field : {"near", "mid", "far"}) {
    const Json& c = result["cross_correlation"][field];
    EXPECT_NEAR(c["value"].get<double>(), c["noise_limit"].get<double>(), 0.05) << field;
  }
  // pi^2 / 2 mm2 sr hold half of the flux of a Lambertian disk of 1 mm.
  for (const char* side : {"reference", "test"}) {
    EXPECT_NEAR(result["etendue_mm2sr"][side]["p50"].get<double>() / 4.9348, 1.0, 0.1) << side;
  }
  ASSERT_EQ(result["pictures"].size(), 1u) << "no light to the side";
  EXPECT_EQ(result["pictures"][0]["file"], "luminance-front.png");
  EXPECT_EQ(slurp(dir / "out/luminance-front.png").substr(1, 3), "PNG");
  const auto text = run_lucerna(dir.path(), "compare a.tm25ray b.tm25ray");
  for (const char* part : {"four_d", "focus plane", "cross-correlation", "etendue", "noise"}) {
    EXPECT_TRUE(has(text.out, part)) << part << '\n' << text.out;
  }
}

TEST(CompareCli, AnotherSourceIsSeen) {
  const TempDir dir;
  run_well(dir, "make-source disk -n 20000 --seed 1 -o a.tm25ray");
  run_well(dir, "make-source disk --radius-mm 1.3 -n 20000 --seed 2 -o b.tm25ray");
  const Json result = json_of(dir, "compare a.tm25ray b.tm25ray --cells-um 300");
  EXPECT_GT(result["focus_plane"][0]["l1"].get<double>(),
            3.0 * result["focus_plane"][0]["floor"].get<double>());
  const Json& e = result["etendue_mm2sr"];
  EXPECT_NEAR(e["test"]["p50"].get<double>() / e["reference"]["p50"].get<double>(), 1.69, 0.2);
  EXPECT_FALSE(result.contains("pictures")) << "none without a folder";
}

TEST(CompareCli, WrongWordsAreOneClearLine) {
  const TempDir dir;
  run_well(dir, "make-source disk -n 2000 -o a.tm25ray");
  const auto zero = run_lucerna(dir.path(), "compare a.tm25ray a.tm25ray --cells-um 0");
  EXPECT_EQ(zero.exit_code, 2);
  EXPECT_TRUE(has(zero.err, "cells of 0 um")) << zero.err;
  EXPECT_EQ(run_lucerna(dir.path(), "compare a.tm25ray a.tm25ray --cells-um x").exit_code, 2);
  const auto missing = run_lucerna(dir.path(), "compare a.tm25ray none.tm25ray");
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_EQ(std::count(missing.err.begin(), missing.err.end(), '\n'), 1) << missing.err;
}

// Rays on one point, one line and in one plane go the whole way.
TEST(ModelsCli, PointsLinesAndPlanesAreCompressedSampledAndTraced) {
  const TempDir dir;
  const auto write_rays = [&](const std::string& name, const std::string& start) {
    std::string text = "# x y z kx ky kz flux\n";
    for (int i = 0; i < 3000; ++i) {
      const double t = i / 3000.0, s = 2.399963 * i, c = 0.05 + 0.9 * std::fmod(0.618034 * i, 1.0);
      const double x = start == "point" ? 0.0 : t - 0.5,
                   y = start == "plane" ? std::fmod(0.7548777 * i, 1.0) : 0.0;
      const double r = std::sqrt(1.0 - c * c);
      text += std::to_string(x) + ' ' + std::to_string(y) + " 0 " + std::to_string(r * std::cos(s)) + ' ' +
              std::to_string(r * std::sin(s)) + ' ' + std::to_string(c) + " 1\n";
    }
    write_file(dir / name, text);
  };
  for (const std::string start : {"point", "line", "plane"}) {
    write_rays(start + ".txt", start);
    run_well(dir, "convert " + start + ".txt " + start + ".tm25ray --flux 100");
    for (const std::string method : {"adaptive", "clusters"}) {
      run_well(dir, "compress " + start + ".tm25ray -o m.nfl --method " + method);
      run_well(dir, "info m.nfl");
      run_well(dir, "sample m.nfl -n 2000 -o s.tm25ray");
      write_file(
          dir / "p.toml",
          "[[source]]\nfile = \"m.nfl\"\n[[reflector]]\nfamily = \"revolution\"\npreset = \"parabola\"\n"
          "focal_mm = 15.0\ndiameter_mm = 100.0\nposition_mm = [0, 0, 15]\naxis = \"-z\"\n");
      const Json traced = json_of(dir, "trace p.toml -o " + start + method + " --rays 2000");
      EXPECT_NEAR(traced["ledger"]["emitted"].get<double>(), 100.0, 1e-3) << start << method;
    }
  }
}

}  // namespace
}  // namespace lucerna
