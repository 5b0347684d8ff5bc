// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/output/design_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace lucerna::cli {
namespace {

FitRecord step_of(int number) {
  FitRecord r;
  r.step = number;
  r.error = 0.0123, r.floor = 0.004, r.efficiency = 0.871, r.total_rays = 12'300'000;
  return r;
}

TEST(DesignOutput, HistoryHasOneHeaderHoweverManySteps) {
  std::string history;
  add_step(step_of(1), history);
  const std::string header = history.substr(0, history.find('\n') + 1);
  add_step(step_of(2), history);
  add_step(step_of(3), history);
  EXPECT_EQ(std::ranges::count(history, '\n'), 4);
  EXPECT_EQ(history.find(header), 0U);
  EXPECT_EQ(history.rfind(header), 0U);
}

TEST(DesignOutput, AStepIsALineForPeople) {
  EXPECT_EQ(step_line(step_of(1)), "design: error 1.23 %, noise 0.40 %, efficiency 87.1 %, 12.3 M rays");
}

TEST(DesignOutput, PhasesAndNoiseThatIsLeftAreNoted) {
  Session session;
  session.start();
  FollowUp run;
  run.design_s = 3.0, run.trace_s = 2.0, run.figures_s = 1.0;
  run.noise_goal = 0.01;
  run.trace.noise = 0.02;
  run.trace.end = NoiseEnd::rays;
  testing::internal::CaptureStderr();
  note_phases(run, session);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(session.seconds("design"), 3.0);
  EXPECT_EQ(session.seconds("trace"), 2.0);
  run.trace.end = NoiseEnd::time;
  testing::internal::CaptureStderr();
  note_phases(run, session);
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::HasSubstr("10 s at most: noise 2 % of the peak, 1 % requested"));
}

}  // namespace
}  // namespace lucerna::cli
