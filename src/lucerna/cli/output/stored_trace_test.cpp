// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/output/stored_trace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/results/folders/trace_file.h"
#include "tests/support/project_scene.h"
#include "tests/support/temp_dir.h"

namespace lucerna::cli {
namespace {

class StoredTraceCli : public testing::Test {
 protected:
  StoredTraceCli() {
    write_file(dir_ / "p.toml", "[[source]]\nkind = 'disk'\n");
    const Project project = read_project(dir_ / "p.toml");
    origin_ = trace_origin(project);
    result_ = trace(project.scene, {.last_ray = 1000, .seed = 5});
    write_trace_file(dir_ / kTraceFileName, result_, origin_);
  }
  std::string refusal(const TraceOrigin& origin, const std::string& seed = "",
                      const std::string& sequence = "") {
    try {
      static_cast<void>(stored_trace(dir_.path().string(), seed, sequence, origin));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
  test::TempDir dir_;
  TraceOrigin origin_;
  TraceResult result_;
};

TEST_F(StoredTraceCli, IsTheOneThatWasWritten) {
  const auto stored = stored_trace(dir_.path().string(), "", "", origin_);
  ASSERT_TRUE(stored);
  EXPECT_EQ(encode_trace(*stored, origin_), encode_trace(result_, origin_));
  EXPECT_TRUE(stored_trace(dir_.path().string(), "5", "sobol", origin_));
}

TEST_F(StoredTraceCli, IsNothingInAnEmptyFolder) {
  const test::TempDir empty;
  EXPECT_FALSE(stored_trace(empty.path().string(), "", "", origin_));
}

TEST_F(StoredTraceCli, OfAnotherProjectVersionSeedOrSequenceIsRefused) {
  TraceOrigin other = origin_;
  other.scene_id = "another";
  EXPECT_THAT(refusal(other), testing::HasSubstr("of another project"));
  other = origin_;
  other.program_version = "0.0.1";
  EXPECT_THAT(refusal(other), testing::HasSubstr("this is 0.0.1"));
  EXPECT_THAT(refusal(origin_, "6"), testing::HasSubstr("was traced with seed 5, found --seed 6"));
  EXPECT_THAT(refusal(origin_, "", "random"),
              testing::HasSubstr("was traced with sequence sobol, found --sequence random"));
}

TEST_F(StoredTraceCli, ADamagedFileIsRefusedByItsName) {
  write_file(dir_ / kTraceFileName, "no trace");
  EXPECT_THAT(refusal(origin_), testing::HasSubstr(kTraceFileName));
}

}  // namespace
}  // namespace lucerna::cli
