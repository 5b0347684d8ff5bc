// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/session.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

namespace lucerna::cli {
namespace {

/// Presses Ctrl-C once, and where the program goes on, again.
[[noreturn]] void press_ctrl_c_twice() {
  Session session;
  session.threads = 1;
  session.start();
  if (session.progress().stop_requested()) std::_Exit(10);
  std::raise(SIGINT);
  if (!session.progress().stop_requested()) std::_Exit(11);
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  std::raise(SIGINT);
  std::_Exit(12);
}

TEST(SessionCli, TheFirstCtrlCAsksAndTheSecondEnds) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(press_ctrl_c_twice(), testing::KilledBySignal(SIGINT),
              "lucerna: stopping; Ctrl-C again ends the program at once");
}

TEST(SessionCli, SigtermAsksHoweverOften) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto ask_twice = [] {
    Session session;
    session.start();
    std::raise(SIGTERM);
    std::raise(SIGTERM);
    std::_Exit(session.progress().stop_requested() ? 3 : 10);
  };
  EXPECT_EXIT(ask_twice(), testing::ExitedWithCode(3), "");
}

TEST(SessionCli, ANoteIsToldOnce) {
  Session session;
  session.start();
  testing::internal::CaptureStderr();
  session.note("one");
  session.note("two");
  session.note("one");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "lucerna: one\nlucerna: two\n");
}

}  // namespace
}  // namespace lucerna::cli
