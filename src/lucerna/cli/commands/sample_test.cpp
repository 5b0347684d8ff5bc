// SPDX-License-Identifier: Apache-2.0
// `lucerna sample`: what the files hold, and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::has;
using test::run_lucerna;

class SampleCli : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(
        run_lucerna(dir.path(), "make-source disk -n 20000 --radius-mm 2 --flux-w 3 -o s.tm25ray").exit_code,
        0);
    ASSERT_EQ(run_lucerna(dir.path(), "compress s.tm25ray -o m.nfl --held-out 0").exit_code, 0);
  }
  RaySet drawn(const std::string& arguments) {
    const auto run = run_lucerna(dir.path(), "sample m.nfl -o t.tm25ray " + arguments);
    EXPECT_EQ(run.exit_code, 0) << arguments << ": " << run.err;
    return read_ray_set(dir / "t.tm25ray");
  }
  test::TempDir dir;
};

TEST_F(SampleCli, RaysAreThoseOfTheModel) {
  const RaySet set = drawn("-n 1e4");
  ASSERT_EQ(set.rays.size(), 10000u);
  EXPECT_EQ(set.header.flux_unit, FluxUnit::watt);
  EXPECT_FLOAT_EQ(static_cast<float>(*set.header.flux_w), 3.0F);
  double cosine = 0.0, square = 0.0;
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    const Vec3 from = set.rays.origin_mm(i);
    cosine += static_cast<double>(set.rays.kz[i]) / 1e4;
    square += (from.x * from.x + from.y * from.y) / 1e4;
  }
  // A Lambertian disk of radius 2: means of 2/3 and 2, of which the model knows 20000 rays. Bounds of six
  // standard errors of both, a false alarm in 5e8; rays that are even in solid angle have a mean of 1/2.
  EXPECT_NEAR(cosine, 2.0 / 3.0, 6.0 * 0.2357 * std::sqrt(1e-4 + 0.5e-4));
  EXPECT_NEAR(square, 2.0, 6.0 * 1.1547 * std::sqrt(1e-4 + 0.5e-4));
}

TEST_F(SampleCli, SameSeedSameRaysAndAnotherSeedOthers) {
  const auto rays = [&](const std::string& arguments) {
    const RaySet set = drawn("-n 1000 " + arguments);
    return std::pair(set.rays.x_mm, set.rays.kz);
  };
  const auto first = rays("--threads 1");
  EXPECT_EQ(first, rays("--seed 1 --threads 2"));
  EXPECT_NE(first, rays("--seed 2"));
  EXPECT_NE(first, rays("--sequence sobol"));
}

TEST_F(SampleCli, PrintsWhatItWroteAndWhatTheFormatCouldNotHold) {
  const auto run = run_lucerna(dir.path(), "sample m.nfl -n 10 -o t.dat --to zemax-binary");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "t.dat: 10 rays of 3 W as zemax-binary, ")) << run.out;
  EXPECT_TRUE(has(run.err, "t.dat: zemax-binary has no place for the texts")) << run.err;
  EXPECT_EQ(read_ray_set(dir / "t.dat").rays.size(), 10u);
}

TEST_F(SampleCli, RefusesInOneLineAndWritesNothing) {
  write_file(dir / "cut.nfl", test::slurp(dir / "m.nfl").substr(0, 300));
  const auto refuse = [&](const std::string& arguments, int code, const std::string& part) {
    const auto run = run_lucerna(dir.path(), "sample " + arguments);
    EXPECT_EQ(run.exit_code, code) << arguments << ": " << run.err;
    EXPECT_TRUE(has(run.err, part)) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_FALSE(std::filesystem::exists(dir / "x.tm25ray")) << arguments;
  };
  refuse("m.nfl -n 0 -o x.tm25ray", 1, "zero rays asked for, expected at least one");
  refuse("m.nfl -n 10 -o x.tm25ray --sequence halton", 2, "expected random or sobol");
  refuse("m.nfl -n 10 -o x.tm25ray --seed -1", 2, "--seed: '-1' is not a whole number");
  refuse("m.nfl -n 10 -o x.tm25ray --to nothing", 2, "unknown ray format 'nothing'");
  refuse("m.nfl -n 10 -o x.unknown", 2, "the ending '.unknown' does not say the format");
  refuse("none.nfl -n 10 -o x.tm25ray", 1, "none.nfl: cannot read");
  refuse("s.tm25ray -n 10 -o x.tm25ray", 1, "s.tm25ray: byte 0: not a Lucerna model file");
  refuse("cut.nfl -n 10 -o x.tm25ray", 1, "cut.nfl: byte 16: the file should have");
  refuse("m.nfl -n 10 -o none/x.tm25ray", 1, "none/x.tm25ray: cannot write");
  const std::string model = test::slurp(dir / "m.nfl");
  refuse("m.nfl -n 10 -o ./m.nfl --to tm25", 2, "./m.nfl: found the model itself");
  EXPECT_EQ(test::slurp(dir / "m.nfl"), model);
}

}  // namespace
}  // namespace lucerna
