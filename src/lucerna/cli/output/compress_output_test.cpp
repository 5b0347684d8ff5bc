// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/output/compress_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna::cli {
namespace {

using testing::HasSubstr;

class CompressOutput : public testing::Test {
 protected:
  CompressOutput() {
    RaySet set;
    set.header.set_flux(20.0);
    set.rays = draw_rays(*make_emitter({.kind = EmitterKind::disk}), Sequence(SequenceKind::random, 1), 400);
    write_ray_set(dir / "a.tm25ray", set, "tm25");
    arguments.inputs = {(dir / "a.tm25ray").string()};
    arguments.output = (dir / "m.nfl").string();
    made = compress(arguments.files());
    made.warnings = {"a.tm25ray: odd"};
  }
  std::string written(Session& session) {
    session.start();
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    write_compress_output(arguments, made, session);
    notes = testing::internal::GetCapturedStderr();
    return testing::internal::GetCapturedStdout();
  }
  test::TempDir dir;
  CompressArguments arguments;
  CompressedFiles made;
  std::string notes;
};

TEST_F(CompressOutput, TheModelIsOnDiskAndJudged) {
  Session session;
  const std::string text = written(session);
  EXPECT_EQ(load_source_model(arguments.output)->leaves(), made.model->leaves());
  EXPECT_THAT(text, HasSubstr("400 rays to "));
  EXPECT_THAT(text, HasSubstr("held out: a model of "));
  EXPECT_THAT(notes, HasSubstr("a.tm25ray: odd"));
}

TEST_F(CompressOutput, NoRayIsHeldOutWhereNoneIsWanted) {
  arguments.held_out = "0";
  Session session;
  EXPECT_THAT(written(session), testing::Not(HasSubstr("held out")));
}

TEST_F(CompressOutput, StrictlyWhatIsOddIsAnErrorBeforeAFileIsWritten) {
  Session session;
  session.strict = true;
  session.start();
  EXPECT_THROW(write_compress_output(arguments, made, session), InputError);
  EXPECT_FALSE(std::filesystem::exists(arguments.output));
}

}  // namespace
}  // namespace lucerna::cli
