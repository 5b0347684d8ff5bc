// SPDX-License-Identifier: Apache-2.0
// `lucerna-mpi design` under mpirun: files to the byte those of `lucerna design`.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "lucerna/random.h"
#include "tests/support/mpi_runs.h"

namespace lucerna {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kDesignScene = R"([[source]]
kind = "disk"
radius_mm = 1.0
[target]
file = "spot.ldt"
[[reflector]]
focal_mm = 8
diameter_mm = 60
hole_diameter_mm = 4
position_mm = [0, 0, 8]
axis = "-z"
reflectance = 0.9
)";
/// A far field of large cells, whose noise is reached in one round: the time, at most 10 s, does not end the
/// final trace. Of its tent bins light is not followed backward, which would take longer than all the rest.
constexpr const char* kFarField = R"([[detector]]
kind = "far-field"
c_step_deg = 90.0
gamma_step_deg = 5.0
bins = "tent"
)";
constexpr const char* kRevolution = R"(family = "revolution"
preset = "parabola"
[design]
intervals = 3
restarts = 0
optimizer = "least-squares"
time_s = 1e6
[design.tolerances]
source_shift_mm = 0
source_tilt_deg = 0
slope_error_mrad = 0
samples = 2
rays = 20000
)";
constexpr const char* kFreeForm = R"(family = "bspline"
[design]
intervals = [2, 2]
restarts = 0
time_s = 1e6
)";

/// Steps that are many and quick.
constexpr const char* kManySteps = R"(family = "revolution"
preset = "parabola"
[design]
intervals = 1
restarts = 0
optimizer = "cma-es"
time_s = 1e6
)";

class MpiDesignTest : public test::MpiTest {
 protected:
  void design_alone(const std::string& mirror) {
    PhotometricFile spot;
    spot.distribution = uniform_distribution(0.0, 1.0);
    for (std::size_t g = 0; g < spot.distribution.gamma_deg.size(); ++g) {
      const double gamma = spot.distribution.gamma_deg[g];
      spot.distribution.at(0, g) = 1000.0 * std::exp(-gamma * gamma / 200.0);
    }
    write_photometric_file(dir_ / "spot.ldt", spot, PhotometricFormat::ldt);
    write_file(dir_ / "p.toml", std::string(kFarField) + kDesignScene + mirror);
    fs::remove_all(dir_ / "alone");
    run_alone({"design", project(), "--rays", "8192", "--device", "cpu"});
  }
  std::string project() const { return (dir_ / "p.toml").string(); }

  pid_t start_ranks(int ranks, const std::string& out, const std::vector<std::string>& more,
                    const std::string& rays = "8192") const {
    std::vector<std::string> words{project(), "--rays", rays};
    words.insert(words.end(), more.begin(), more.end());
    return MpiTest::start_ranks(ranks, "design", out, words);
  }
  void expect_same(const std::string& out, const std::string& what) const {
    MpiTest::expect_same(out, 10, what);
  }

  /// Until a run has made another step of its design, or has ended.
  void wait_for_step(const std::string& out, pid_t run) const {
    const auto size = [&] {
      std::error_code none;
      const auto bytes = fs::file_size(dir_ / out / "history.csv", none);
      return none ? 0 : bytes;
    };
    const auto before = size();
    siginfo_t ended{};
    while (size() <= before &&
           ::waitid(P_PID, static_cast<id_t>(run), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           ended.si_pid == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  void expect_same_on(const std::vector<std::pair<int, const char*>>& ranks_and_threads) const {
    for (const auto& [ranks, threads] : ranks_and_threads) {
      ASSERT_EQ(test::wait_for(start_ranks(ranks, "out", {"--threads", threads, "--force"})), 0) << log();
      expect_same("out", fmt::format("{} ranks, {} threads", ranks, threads));
    }
  }
  /// Kills one of one to three ranks after at least one more step, until the design has ended or been killed
  /// so many times, and then lets it end; returns how many times.
  int kill_until_done(Rng& rng, int times) const {
    for (int kills = 0;; ++kills) {
      const int ranks = 1 + static_cast<int>(rng.bits() % 3);
      const pid_t run = start_ranks(ranks, "out", {"--resume", "--threads", "1"});
      if (kills < times) {
        wait_for_step("out", run);
        std::this_thread::sleep_for(std::chrono::milliseconds(rng.bits() % 200));
        const std::vector<pid_t> there = test::ranks_below(run);
        if (!there.empty()) ::kill(there[rng.bits() % there.size()], SIGKILL);
      }
      const int code = test::wait_for(run);
      if (code == 0) return kills;
      EXPECT_LT(kills, times) << log();
      if (kills >= times) return kills;
    }
  }
};

TEST_F(MpiDesignTest, FilesAreThoseOfOneProcessMpi) {
  design_alone(kRevolution);
  expect_same_on({{1, "2"}, {2, "1"}, {3, "2"}, {5, "1"}});
}

TEST_F(MpiDesignTest, FilesOfAFreeFormAreThoseOfOneProcessMpi) {
  design_alone(kFreeForm);
  expect_same_on({{1, "2"}, {3, "1"}});
}

TEST_F(MpiDesignTest, AnyKillAndAnotherNumberOfRanksLeaveTheBitsMpi) {
  Rng rng(17, 0);
  for (const char* mirror : {kManySteps, kFreeForm}) {
    design_alone(mirror);
    fs::remove_all(dir_ / "out");
    EXPECT_GE(kill_until_done(rng, 3), 1);
    expect_same("out", "after kills");
  }
}

TEST_F(MpiDesignTest, ASignalToOneRankWritesTheBestSoFarMpi) {
  design_alone(kManySteps);
  for (const int signal : {SIGUSR1, SIGTERM, SIGINT}) {
    const std::string out = fmt::format("out{}", signal);
    const pid_t run = start_ranks(3, out, {"--threads", "1"});
    wait_for_step(out, run);
    const std::vector<pid_t> ranks = test::ranks_below(run);
    ASSERT_EQ(ranks.size(), 3u) << log();
    ::kill(ranks[1], signal);
    ASSERT_EQ(test::wait_for(run), 3) << log();
    EXPECT_EQ(Json::parse(read_file(dir_ / out / "result.json", test::kMostBytes))["end"], "interrupted");
    EXPECT_TRUE(fs::exists(dir_ / out / "reflector.step"));
    ASSERT_EQ(test::wait_for(start_ranks(2, out, {"--resume"})), 0) << log();
    expect_same(out, "after a signal");
  }
}

/// A folder that `lucerna design` has left goes on by ranks, and one of ranks by it.
TEST_F(MpiDesignTest, GoesOnWithADesignOfOneProcessMpi) {
  design_alone(kRevolution);
  fs::create_directory(dir_ / "out");
  for (const char* file : {"checkpoint", "history.csv"})
    fs::copy_file(dir_ / "alone" / file, dir_ / "out" / file);
  ASSERT_EQ(test::wait_for(start_ranks(2, "out", {"--resume"})), 0) << log();
  expect_same("out", "after going on");
}

TEST_F(MpiDesignTest, ErrorsAreToldOnceAndEndAllMpi) {
  design_alone(kRevolution);
  EXPECT_EQ(test::wait_for(start_ranks(2, "alone", {})), 1) << log();
  EXPECT_THAT(log(), testing::HasSubstr("not empty"));
  EXPECT_EQ(test::wait_for(start_ranks(2, "out", {}, "100")), 1) << log();
  EXPECT_THAT(log(), testing::HasSubstr("expected at least 8192"));
  EXPECT_EQ(test::wait_for(start_ranks(2, "out", {"--device", "cpu"})), 2) << log();
  // Found in the middle of the computation.
  fs::create_directory(dir_ / "out");
  write_file(dir_ / "out" / "checkpoint", "lucerna-design nothing\n");
  EXPECT_EQ(test::wait_for(start_ranks(3, "out", {"--resume"})), 1) << log();
  EXPECT_THAT(log(), testing::HasSubstr("checkpoint"));
}

}  // namespace
}  // namespace lucerna
