// SPDX-License-Identifier: Apache-2.0
// `lucerna make-source`: what the files hold, and what it refuses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lucerna/ray_file.h"
#include "lucerna/ray_statistics.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::has;
using test::run_lucerna;

RaySet made(const test::TempDir& dir, const std::string& arguments) {
  const auto run = run_lucerna(dir.path(), "make-source " + arguments + " -o s.tm25ray");
  EXPECT_EQ(run.exit_code, 0) << arguments << ": " << run.err;
  return read_ray_set(dir / "s.tm25ray");
}

TEST(MakeSourceCli, KindsHaveTheSizesThatWereAskedFor) {
  const test::TempDir dir;
  const RaySet disk = made(dir, "disk -n 4000 --radius-mm 2.5 --flux-lm 70");
  EXPECT_EQ(disk.rays.size(), 4000u);
  EXPECT_FLOAT_EQ(static_cast<float>(*disk.header.flux_lm), 70.0F);
  double farthest = 0.0;
  for (std::size_t i = 0; i < disk.rays.size(); ++i) {
    const Vec3 from = disk.rays.origin_mm(i);
    farthest = std::max(farthest, std::hypot(from.x, from.y));
    ASSERT_GT(disk.rays.kz[i], 0.0F);
  }
  EXPECT_LE(farthest, 2.5 * (1.0 + 1e-6));
  EXPECT_GT(farthest, 2.4) << "the chance that 4000 places miss the outer 8 % of the disk is e^-327";
  const RaySet rectangle = made(dir, "rectangle -n 4000 --size-mm 6,2");
  const RaySummary s = summarize(rectangle.rays);
  ASSERT_TRUE(s.extent_min_mm && s.extent_max_mm);
  EXPECT_NEAR(s.extent_max_mm->x - s.extent_min_mm->x, 6.0, 0.1);
  EXPECT_NEAR(s.extent_max_mm->y - s.extent_min_mm->y, 2.0, 0.05);
}

TEST(MakeSourceCli, WattsAreWatts) {
  const test::TempDir dir;
  const RaySet set = made(dir, "point -n 100 --flux-w 3");
  EXPECT_EQ(set.header.flux_unit, FluxUnit::watt);
  EXPECT_FLOAT_EQ(static_cast<float>(*set.header.flux_w), 3.0F);
}

TEST(MakeSourceCli, TheSurfaceIsWhereRaysStart) {
  const test::TempDir dir;
  const RaySet set = made(dir, "disk -n 500 --surface sphere --surface-mm 4");
  for (std::size_t i = 0; i < set.rays.size(); ++i) EXPECT_NEAR(length(set.rays.origin_mm(i)), 4.0, 1e-5);
}

TEST(MakeSourceCli, SameSeedSameBytesAndAnotherSeedOthers) {
  const test::TempDir dir;
  const auto bytes = [&](const std::string& arguments) {
    made(dir, "led -n 1000 " + arguments);
    const RaySet set = read_ray_set(dir / "s.tm25ray");
    return std::pair(set.rays.x_mm, set.rays.kz);
  };
  const auto first = bytes("--seed 3 --threads 1");
  EXPECT_EQ(first, bytes("--seed 3 --threads 2"));
  EXPECT_NE(first, bytes("--seed 4"));
  EXPECT_NE(first, bytes("--seed 3 --sequence sobol"));
}

TEST(MakeSourceCli, PrintsWhatItWroteAndWhatTheFormatCouldNotHold) {
  const test::TempDir dir;
  const auto run = run_lucerna(dir.path(), "make-source disk -n 10 -o s.dat --to zemax-binary");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "s.dat: 10 rays of 1000 lm as zemax-binary")) << run.out;
  EXPECT_TRUE(has(run.err, "zemax-binary has no place for the texts but for the light source's name"))
      << run.err;
  const auto nameless = run_lucerna(dir.path(), "make-source disk -n 10 -o s.txt --to zemax-text");
  EXPECT_TRUE(has(nameless.err, "zemax-text has no place for the texts\n")) << nameless.err;
}

TEST(MakeSourceCli, RefusesWhatContradictsAndWritesNothing) {
  const test::TempDir dir;
  const auto refuse = [&](const std::string& arguments, const std::string& part) {
    const auto run = run_lucerna(dir.path(), "make-source " + arguments + " -o s.tm25ray");
    EXPECT_EQ(run.exit_code, 2) << arguments << run.err;
    EXPECT_TRUE(has(run.err, part)) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(std::filesystem::is_empty(dir.path())) << arguments;
  };
  refuse("disk -n 10 --flux-lm 1e300", "--flux-lm 1e300 is not > 0, or not what a ray file can");
  refuse("disk -n 10 --flux-w 1e-300", "--flux-w 1e-300");
  refuse("disk -n 10 --flux-lm 3 --flux-w 3", "--flux-lm and --flux-w exclude each other");
  refuse("disk -n 10 --surface-mm 3", "--surface-mm needs --surface");
  refuse("rectangle -n 10 --size-mm 3", "3");
  refuse("disk -n -1", "-1");
}

}  // namespace
}  // namespace lucerna
