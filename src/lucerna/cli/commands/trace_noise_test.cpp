// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "lucerna/core/io/file.h"
#include "tests/support/run_program.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using testing::HasSubstr;
using Json = nlohmann::json;

constexpr const char* kSpot = R"([[source]]
kind = "led"
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 15.0
diameter_mm = 60.0
position_mm = [0, 0, 15]
axis = "-z"
[[detector]]
kind = "far-field"
name = "far"
c_step_deg = 15
gamma_step_deg = 2.5
)";

TEST(TraceNoiseCli, TracesUntilTheNoiseIsReachedAndSaysEveryError) {
  const test::TempDir dir;
  write_file(dir / "p.toml", kSpot);
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --noise 5% --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json json = Json::parse(run.out);
  const Json& far = json["detectors"][0];
  EXPECT_LE(far["node_noise"].get<double>(), 0.05);
  for (const Json& e : {far["flux"], far["peak"]["intensity"], far["centre"]["intensity"], far["cut_off_deg"],
                        far["planes"][0]["beam_angle_of_maximum_deg"], far["zones"]["zonal"][0]}) {
    EXPECT_TRUE(e["value"].is_number() && e["standard_error"].is_number()) << e;
  }
  const auto printed = run_lucerna(dir.path(), "trace p.toml -o again --noise 5%");
  EXPECT_THAT(printed.out, HasSubstr(" +- "));
  EXPECT_THAT(printed.out, HasSubstr("% of the peak at the noisiest angle"));
  EXPECT_EQ(test::slurp(dir / "again" / "far.ldt"), test::slurp(dir / "out" / "far.ldt"));
  EXPECT_EQ(run_lucerna(dir.path(), "trace p.toml -o bad --noise 0").exit_code, 2);
}

TEST(TraceNoiseCli, CtrlCWritesWhatWasWhole) {
  const test::TempDir dir;
  write_file(dir / "p.toml", kSpot);
  const std::string trace = "'" + test::program().string() + "' trace p.toml --noise 0.0001% --time 600 ";
  // Longer and longer, until one piece at least was whole.
  for (int seconds = 2; seconds <= 64 && !std::filesystem::exists(dir / "out" / "trace.sums"); seconds *= 2) {
    const std::string command = "cd '" + dir.path().string() + "' && " + "timeout --preserve-status -s INT " +
                                std::to_string(seconds) + " " + trace + "-o out --force > log 2>&1";
    const int status = std::system(command.c_str());
    ASSERT_TRUE(WIFEXITED(status));
    ASSERT_EQ(WEXITSTATUS(status), 3) << test::slurp(dir / "log");
  }
  EXPECT_THAT(test::slurp(dir / "log"), HasSubstr("interrupted: these are the rays"));
  EXPECT_THAT(test::slurp(dir / "log"), HasSubstr("Ctrl-C again ends the program at once"));
  const Json json = Json::parse(test::slurp(dir / "out" / "result.json"));
  const auto rays = std::to_string(json["ledger"]["rays"].get<std::uint64_t>());
  ASSERT_EQ(run_lucerna(dir.path(), "trace p.toml -o same --rays " + rays).exit_code, 0);
  EXPECT_EQ(test::slurp(dir / "out" / "trace.sums"), test::slurp(dir / "same" / "trace.sums"));
}

TEST(TraceNoiseCli, ATraceThatWasTooNoisyGoesOnToTheSameBits) {
  const test::TempDir dir;
  write_file(dir / "p.toml", kSpot);
  ASSERT_EQ(run_lucerna(dir.path(), "trace p.toml -o whole --rays 50000").exit_code, 0);
  ASSERT_EQ(run_lucerna(dir.path(), "trace p.toml -o parts --rays 20000").exit_code, 0);
  EXPECT_EQ(run_lucerna(dir.path(), "trace p.toml -o parts --rays 50000").exit_code, 1) << "not empty";
  const auto other_seed = run_lucerna(dir.path(), "trace p.toml -o parts --rays 50000 --resume --seed 3");
  EXPECT_EQ(other_seed.exit_code, 1);
  EXPECT_THAT(other_seed.err, HasSubstr("was traced with seed 1, found --seed 3"));
  ASSERT_EQ(run_lucerna(dir.path(), "trace p.toml -o parts --rays 50000 --resume").exit_code, 0);
  for (const char* file : {"far.csv", "far.ldt", "trace.sums"})
    EXPECT_EQ(test::slurp(dir / "parts" / file), test::slurp(dir / "whole" / file)) << file;
  EXPECT_EQ(run_lucerna(dir.path(), "trace p.toml -o parts --rays 10000 --resume").exit_code, 2);
  write_file(dir / "q.toml", std::string(kSpot) + "bins = 'tent'\n");
  const auto other = run_lucerna(dir.path(), "trace q.toml -o parts --resume");
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("another project"));
}

TEST(TraceNoiseCli, SaysWhenTheTimeOrTheRayFileEndsFirst) {
  const test::TempDir dir;
  write_file(dir / "p.toml", kSpot);
  const auto late = run_lucerna(dir.path(), "trace p.toml -o late --noise 0.001% --time 0.001");
  ASSERT_EQ(late.exit_code, 0) << late.err;
  EXPECT_THAT(late.err, HasSubstr("the time was over first"));
  ASSERT_EQ(run_lucerna(dir.path(), "make-source led -n 20000 -o s.tm25ray").exit_code, 0);
  std::string project = kSpot;
  project.replace(project.find("kind = \"led\""), 12, "file = 's.tm25ray'");
  write_file(dir / "f.toml", project);
  const auto file = run_lucerna(dir.path(), "trace f.toml -o file --noise 0.01%");
  ASSERT_EQ(file.exit_code, 0) << file.err;
  EXPECT_THAT(file.err, HasSubstr("a ray file has given all its rays"));
  EXPECT_THAT(file.out, HasSubstr("20000 rays"));
}

}  // namespace
}  // namespace lucerna
