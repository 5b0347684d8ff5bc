// SPDX-License-Identifier: Apache-2.0
// --device as a user meets it on a machine without a CUDA device.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "lucerna/trace/device/accelerator.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::TempDir;

void write_device_project(const TempDir& dir) {
  write_file(dir.path() / "p.toml", "[[source]]\nkind = \"disk\"\nradius_mm = 1.0\nflux_lm = 100\n");
}

TEST(DeviceCli, CudaWithoutADeviceIsOneLineAndExitOne) {
  if (cuda_unavailable_reason().empty()) GTEST_SKIP() << "there is a CUDA device";
  const TempDir dir;
  write_device_project(dir);
  for (const char* command : {"trace p.toml -o out --device cuda", "design p.toml -o out --device cuda"}) {
    const auto run = run_lucerna(dir.path(), command);
    EXPECT_EQ(run.exit_code, 1) << command;
    EXPECT_NE(run.err.find("no CUDA device: "), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_FALSE(std::filesystem::exists(dir.path() / "out")) << "nothing may be written";
  }
}

TEST(DeviceCli, AutoFallsBackToTheCpu) {
  if (cuda_unavailable_reason().empty()) GTEST_SKIP() << "there is a CUDA device";
  const TempDir dir;
  write_device_project(dir);
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --rays 2000 --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(nlohmann::json::parse(run.out)["isa"], "cuda");
}

TEST(DeviceCli, UnknownDeviceIsAUsageError) {
  const TempDir dir;
  write_device_project(dir);
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --device abacus");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("'abacus'; expected auto, cpu or cuda"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace lucerna
