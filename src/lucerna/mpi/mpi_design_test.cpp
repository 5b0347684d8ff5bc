// SPDX-License-Identifier: Apache-2.0
// `lucerna-mpi design` under mpirun: files to the byte those of `lucerna design`.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "lucerna/random.h"
#include "tests/support/mpi_runs.h"
#include "tests/support/paths.h"
#include "tests/support/temp_dir.h"

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
/// final trace.
constexpr const char* kFarField = R"([[detector]]
kind = "far-field"
c_step_deg = 90.0
gamma_step_deg = 5.0
)";
constexpr const char* kRevolution = R"(family = "revolution"
preset = "parabola"
[design]
intervals = 3
restarts = 0
optimizer = "least-squares"
time_s = 1e6
[design.tolerances]
samples = 2
rays = 20000
)";
constexpr const char* kFreeForm = R"(family = "bspline"
[design]
intervals = [2, 2]
restarts = 0
time_s = 1e6
)";

class MpiDesignTest : public testing::Test {
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
    const std::vector<std::string> words{test::program().string(),
                                         "design",
                                         project(),
                                         "-o",
                                         (dir_ / "alone").string(),
                                         "--rays",
                                         "8192",
                                         "--device",
                                         "cpu"};
    ASSERT_EQ(test::wait_for(test::start(words, dir_ / "log")), 0) << log();
  }
  std::string project() const { return (dir_ / "p.toml").string(); }
  std::string log() const { return read_file(dir_ / "log", test::kMostBytes); }

  pid_t start_ranks(int ranks, const std::string& out, const std::vector<std::string>& more,
                    const std::string& rays = "8192") const {
    std::vector<std::string> words = test::mpi_command(ranks, "design");
    words.insert(words.end(), {project(), "-o", (dir_ / out).string(), "--rays", rays});
    words.insert(words.end(), more.begin(), more.end());
    return test::start(words, dir_ / "log");
  }

  /// Every file of the one folder is in the other to the byte; of result.json all but how it was made.
  void expect_same(const std::string& out, const std::string& what) const {
    std::size_t files = 0;
    for (const auto& entry : fs::directory_iterator(dir_ / "alone")) {
      const fs::path name = entry.path().filename();
      const std::string a = read_file(entry.path(), test::kMostBytes);
      const std::string b = read_file(dir_ / out / name, test::kMostBytes);
      ++files;
      if (name == "result.json") {
        EXPECT_EQ(without_run(a), without_run(b)) << what;
      } else {
        EXPECT_TRUE(a == b) << name << ", " << what;
      }
    }
    EXPECT_GE(files, 10u);
  }
  static std::string without_run(const std::string& json) {
    Json j = Json::parse(json);
    for (const char* key : {"command", "threads", "wall_s"}) j.erase(key);
    if (j.contains("validation")) j["validation"].erase("seconds");
    return j.dump(1);
  }

  test::TempDir dir_;
};

TEST_F(MpiDesignTest, FilesAreThoseOfOneProcessMpi) {
  for (const char* mirror : {kRevolution, kFreeForm}) {
    fs::remove_all(dir_ / "alone");
    design_alone(mirror);
    int run = 0;
    for (const int ranks : {1, 2, 3, 5}) {
      for (const char* threads : {"1", "2"}) {
        const std::string out = fmt::format("out{}", run++);
        ASSERT_EQ(test::wait_for(start_ranks(ranks, out, {"--threads", threads, "--force"})), 0) << log();
        expect_same(out, fmt::format("{} ranks, {} threads", ranks, threads));
      }
    }
  }
}

TEST_F(MpiDesignTest, AnyKillAndAnotherNumberOfRanksLeaveTheBitsMpi) {
  design_alone(kFreeForm);
  Rng rng(17, 0);
  int kills = 0;
  for (int round = 0; kills < 6; ++round) {
    const std::string out = fmt::format("out{}", round);
    for (int attempt = 0;; ++attempt) {
      const int ranks = 1 + static_cast<int>(rng.bits() % 4);
      const pid_t run = start_ranks(ranks, out, {"--resume", "--threads", "1"});
      if (attempt < 3) {
        std::this_thread::sleep_for(std::chrono::milliseconds(500 + rng.bits() % 4000));
        const std::vector<pid_t> there = test::ranks_below(run);
        if (!there.empty()) {
          ::kill(there[rng.bits() % there.size()], SIGKILL);
          ++kills;
        }
      }
      if (test::wait_for(run) == 0) break;
      ASSERT_LT(attempt, 5) << log();
    }
    expect_same(out, "after kills");
  }
}

TEST_F(MpiDesignTest, ASignalToOneRankWritesTheBestSoFarMpi) {
  design_alone(kFreeForm);
  for (const int signal : {SIGUSR1, SIGTERM, SIGINT}) {
    const std::string out = fmt::format("out{}", signal);
    const pid_t run = start_ranks(3, out, {"--threads", "1"});
    while (!fs::exists(dir_ / out / "checkpoint") && ::kill(run, 0) == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
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
