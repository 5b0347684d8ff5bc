// SPDX-License-Identifier: Apache-2.0
// `lucerna bench`: a line and a JSON entry a measurement, and what it refuses. No time is asserted.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::has;
using test::run_lucerna;
using Json = nlohmann::json;

TEST(BenchCli, HasAnEntryForEachSceneAndSize) {
  const test::TempDir dir;
  const auto run = run_lucerna(dir.path(), "bench --rays 20000 --cells 8,64 --device cpu --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json result = Json::parse(run.out);
  EXPECT_EQ(result["device"], "cpu");
  EXPECT_FALSE(result["isa"].get<std::string>().empty());
  std::set<std::pair<std::string, int>> measured;
  for (const Json& r : result["results"]) {
    measured.emplace(r["scene"], r["cells"]);
    EXPECT_EQ(r["rays"], 20000);
    EXPECT_GT(r["rays_per_s"].get<double>(), 0.0);
    EXPECT_GE(r["casts_per_ray"].get<double>(), 1.0) << "every ray is cast at least once";
    EXPECT_LT(r["casts_per_ray"].get<double>(), 6.0) << "and at most five times";
    EXPECT_GT(r["heights_mb"].get<double>(), 0.0);
  }
  EXPECT_EQ(measured.size(), result["results"].size()) << "no scene and size twice";
  std::set<std::string> scenes;
  for (const auto& [scene, cells] : measured) scenes.insert(scene);
  EXPECT_EQ(measured.size(), 2 * scenes.size());
  EXPECT_TRUE(scenes.contains("para") && scenes.contains("wavy") && scenes.contains("deep"));
}

TEST(BenchCli, PrintsATable) {
  const test::TempDir dir;
  const auto run = run_lucerna(dir.path(), "bench --rays 1000 --cells 8");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out.find("1000 rays in random order, "), 0u) << run.out;
  EXPECT_TRUE(has(run.out, "\nscene cells  M rays/s")) << run.out;
  EXPECT_TRUE(has(run.out, "\npara      8 ")) << run.out;
  EXPECT_TRUE(has(run.out, "\ninstruction set: ")) << run.out;
}

TEST(BenchCli, RefusesWhatItCannotMeasure) {
  const test::TempDir dir;
  const auto refuse = [&](int code, const std::string& arguments, const std::string& part) {
    const auto run = run_lucerna(dir.path(), "bench " + arguments);
    EXPECT_EQ(run.exit_code, code) << arguments << run.err;
    EXPECT_TRUE(has(run.err, part)) << run.err;
    EXPECT_EQ(run.out, "");
  };
  refuse(2, "--rays 0", "--rays 0: expected 1 to 1e8");
  refuse(2, "--rays 2e8", "--rays 2e8: expected 1 to 1e8");
  refuse(2, "--cells 7", "--cells 7: expected powers of two from 8 to 8192");
  refuse(2, "--cells 8,16384", "expected powers of two from 8 to 8192");
  refuse(2, "--device abacus", "unknown device 'abacus'; expected auto, cpu or cuda");
  refuse(1, "--device cuda", "--device cuda: ");
}

}  // namespace
}  // namespace lucerna
