// SPDX-License-Identifier: Apache-2.0
// The program under mpirun: files to the byte those of `lucerna trace`.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "lucerna/core/io/file.h"
#include "lucerna/random.h"
#include "tests/support/mpi_runs.h"

namespace lucerna {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLamp = R"([[source]]
kind = "led"
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 15
diameter_mm = 60
hole_diameter_mm = 6
position_mm = [0, 0, 15]
axis = "-z"
reflectance = 0.9
[[detector]]
kind = "far-field"
[[detector]]
kind = "plane"
position_mm = [0, 0, -1000]
normal = "+z"
size_mm = [2000, 2000]
[[detector]]
kind = "luminance"
from = [0.1, 0, -1]
size_mm = [80, 80]
cells = [20, 20]
)";
constexpr const char* kKept = "[[detector]]\nkind = \"rays\"\n";

class MpiTraceTest : public test::MpiTest {
 protected:
  /// The trace of one process, which all others are to equal.
  void trace_alone(const std::string& project, const std::vector<std::string>& how) {
    how_ = how;
    write_file(dir_ / "lamp.toml", project);
    std::vector<std::string> words{"trace", lamp(), "--quiet"};
    words.insert(words.end(), how.begin(), how.end());
    run_alone(words);
  }
  void trace_alone(const std::string& project, const std::string& rays) {
    trace_alone(project, std::vector<std::string>{"--rays", rays});
  }
  std::string lamp() const { return (dir_ / "lamp.toml").string(); }

  pid_t start_ranks(int ranks, const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> words{lamp()};
    words.insert(words.end(), how_.begin(), how_.end());
    words.insert(words.end(), more.begin(), more.end());
    return MpiTest::start_ranks(ranks, "trace", out, words);
  }
  void expect_same(const std::string& out, const std::string& what) const {
    MpiTest::expect_same(out, 8, what);
  }

  /// The options that say how much is traced.
  std::vector<std::string> how_;
};

TEST_F(MpiTraceTest, FilesAreThoseOfOneProcessMpi) {
  trace_alone(std::string(kLamp) + kKept, "100:40011");
  int run = 0;
  for (const int ranks : {1, 2, 3, 5, 8}) {
    for (const char* threads : {"1", "2"}) {
      for (const char* chunk : {"512", "4096", "1e6"}) {
        const std::string out = "out" + std::to_string(run++);
        const int code = test::wait_for(start_ranks(ranks, out, {"--threads", threads, "--chunk", chunk}));
        ASSERT_EQ(code, 0) << log();
        expect_same(out, fmt::format("{} ranks, {} threads, chunks of {}", ranks, threads, chunk));
      }
    }
  }
}

TEST_F(MpiTraceTest, ByNoiseTheRoundsAreThoseOfOneProcessMpi) {
  trace_alone(kLamp, std::vector<std::string>{"--noise", "2%", "--time", "1e6"});
  for (const int ranks : {1, 3}) {
    const std::string out = "out" + std::to_string(ranks);
    ASSERT_EQ(test::wait_for(start_ranks(ranks, out, {"--threads", "1", "--chunk", "65536"})), 0) << log();
    expect_same(out, fmt::format("{} ranks", ranks));
  }
}

TEST_F(MpiTraceTest, AFinishedTraceGetsMoreRaysMpi) {
  trace_alone(std::string(kLamp) + kKept, "40011");
  how_ = {"--rays", "12345"};
  ASSERT_EQ(test::wait_for(start_ranks(2, "out", {"--seed", "1"})), 0) << log();
  how_ = {"--rays", "40011"};
  ASSERT_EQ(test::wait_for(start_ranks(3, "out", {"--resume", "--chunk", "512"})), 0) << log();
  EXPECT_NE(log().find("12345 rays are there already"), std::string::npos) << log();
  expect_same("out", "after going on");
  EXPECT_EQ(test::wait_for(start_ranks(2, "out", {"--resume", "--seed", "7"})), 1) << log();
}

TEST_F(MpiTraceTest, ASignalWritesAndExitsWithThreeMpi) {
  trace_alone(kLamp, "8e6");
  for (const int signal : {SIGUSR1, SIGTERM}) {
    const std::string out = "out" + std::to_string(signal);
    const pid_t run = start_ranks(2, out, {"--threads", "1", "--chunk", "65536"});
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    const std::vector<pid_t> ranks = test::ranks_below(run);
    ASSERT_EQ(ranks.size(), 2u) << log();
    ::kill(ranks[1], signal);
    EXPECT_EQ(test::wait_for(run), 3) << log();
    EXPECT_FALSE(fs::is_empty(dir_ / out / "parts"));
    EXPECT_NE(log().find("rays are traced and kept"), std::string::npos) << log();
    EXPECT_FALSE(fs::exists(dir_ / out / "result.json"));
    ASSERT_EQ(test::wait_for(start_ranks(3, out, {"--resume", "--threads", "1"})), 0) << log();
    EXPECT_NE(log().find("are there already"), std::string::npos) << log();
    expect_same(out, "after a signal");
  }
}

// A random rank is killed at a random moment, twenty times; runs that go on have other numbers of ranks.
TEST_F(MpiTraceTest, AnyKillCostsAnIntervalAndNoBitMpiSlow) {
  trace_alone(std::string(kLamp) + kKept, "2e6");
  Rng rng(11, 0);
  int kills = 0;
  for (int round = 0; kills < 20; ++round) {
    const std::string out = "out" + std::to_string(round);
    for (int attempt = 0;; ++attempt) {
      const int ranks = 1 + static_cast<int>(rng.bits() % 4);
      const pid_t run =
          start_ranks(ranks, out, {"--resume", "--threads", "1", "--chunk", "16384", "--checkpoint", "0.05"});
      if (attempt < 4) {
        std::this_thread::sleep_for(std::chrono::milliseconds(300 + rng.bits() % 2000));
        const std::vector<pid_t> there = test::ranks_below(run);
        if (!there.empty()) {
          ::kill(there[rng.bits() % there.size()], SIGKILL);
          ++kills;
        }
      }
      if (test::wait_for(run) == 0) break;
      ASSERT_LT(attempt, 6) << log();
    }
    expect_same(out, "after kills");
  }
}

TEST_F(MpiTraceTest, ErrorsAreToldOnceAndEndAllMpi) {
  how_ = {"--rays", "1000"};
  write_file(dir_ / "lamp.toml", "[[source]]\nkind = \"nothing\"\n");
  EXPECT_EQ(test::wait_for(start_ranks(3, "out", {})), 1) << log();
  const std::string text = log();
  const std::size_t first = text.find("nothing");
  ASSERT_NE(first, std::string::npos) << text;
  write_file(dir_ / "lamp.toml", kLamp);
  EXPECT_EQ(test::wait_for(start_ranks(2, "out", {"--chunk", "0"})), 2) << log();
  EXPECT_EQ(test::wait_for(start_ranks(2, "out", {"--no-such-option"})), 2) << log();
  for (const char* seconds : {"0", "-1", "nan"})
    EXPECT_EQ(test::wait_for(start_ranks(2, "out", {"--checkpoint", seconds})), 2) << log();
  // A run that was refused is not in the way of the next one.
  ASSERT_EQ(test::wait_for(start_ranks(2, "out", {})), 0) << log();
  EXPECT_FALSE(fs::exists(dir_ / "out" / "parts"));
}

}  // namespace
}  // namespace lucerna
