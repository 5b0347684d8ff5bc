// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/output/trace_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lucerna::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// What stands on stderr for a trace that ended with `noise` of the peak and 1 % requested.
std::string note(double noise, NoiseEnd end) {
  NoiseTrace traced;
  traced.noise = noise;
  traced.end = end;
  Session session;
  testing::internal::CaptureStderr();
  note_noise("far field: ", traced, 0.01, session);
  return testing::internal::GetCapturedStderr();
}

TEST(NoteNoise, SaysHowMuchIsMissingAndWhy) {
  EXPECT_THAT(note(0.034, NoiseEnd::time),
              AllOf(HasSubstr("far field: noise 3.4 % of the peak, 1 % requested"),
                    HasSubstr(to_string(NoiseEnd::time)), Not(HasSubstr("peak itself"))));
  EXPECT_THAT(note(0.034, NoiseEnd::finite_source), HasSubstr(to_string(NoiseEnd::finite_source)));
}

TEST(NoteRayFile, SaysThatItEndedBeforeTheRaysThatWereAskedFor) {
  NoiseTrace traced;
  traced.result.last_ray = 3000;
  for (const NoiseEnd end : {NoiseEnd::finite_source, NoiseEnd::rays}) {
    traced.end = end;
    Session session;
    testing::internal::CaptureStderr();
    note_ray_file(10000, traced, session);
    EXPECT_EQ(testing::internal::GetCapturedStderr().find("rays up to 3000 of 10000 asked for: a ray file") !=
                  std::string::npos,
              end == NoiseEnd::finite_source);
  }
}

TEST(NoteNoise, SaysThatOnlyThePeakIsMissing) {
  EXPECT_THAT(note(0.008, NoiseEnd::time),
              AllOf(HasSubstr("noise 0.8 % of the peak, as requested"),
                    HasSubstr("the peak itself is not known to 0.5 % yet"), Not(HasSubstr("1 % requested"))));
}

}  // namespace
}  // namespace lucerna::cli
