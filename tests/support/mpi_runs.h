// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lucerna/core/io/file.h"
#include "tests/support/paths.h"
#include "tests/support/temp_dir.h"

/// Programs under mpirun, for mpi_tests, which says where they are.
namespace lucerna::test {

/// Of a file that is read.
inline constexpr std::uint64_t kMostBytes = 1u << 26;

/// More ranks than cores, also as root: what each library needs for that.
inline std::vector<std::string> mpi_command(int ranks, const std::string& command) {
  std::vector<std::string> words{LUCERNA_MPIEXEC};
  if (std::string(LUCERNA_MPI_LIBRARY).find("openmpi") != std::string::npos)
    words.insert(words.end(), {"--allow-run-as-root", "--oversubscribe", "--quiet"});
  words.insert(words.end(), {"-n", std::to_string(ranks), LUCERNA_MPI_PROGRAM, command});
  return words;
}

/// Starts a command in a group of its own, its output in a file; returns its process.
inline pid_t start(const std::vector<std::string>& words, const std::filesystem::path& log) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  ::setpgid(0, 0);
  if (std::freopen(log.c_str(), "w", stdout) == nullptr) std::_Exit(126);
  ::dup2(1, 2);
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  ::execvp(argv[0], argv.data());
  std::_Exit(127);
}

inline int wait_for(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// The children of a process and theirs that run lucerna-mpi: the ranks.
inline std::vector<pid_t> ranks_below(pid_t top) {
  std::vector<pid_t> all{top}, ranks;
  for (std::size_t i = 0; i < all.size(); ++i) {
    std::error_code none;
    const std::filesystem::path tasks = std::filesystem::path("/proc") / std::to_string(all[i]) / "task";
    for (const auto& task : std::filesystem::directory_iterator(tasks, none)) {
      // Files of /proc have no size: they are read as streams.
      std::ifstream children(task.path() / "children");
      for (pid_t child = 0; children >> child;) all.push_back(child);
    }
    const std::filesystem::path program =
        std::filesystem::read_symlink(std::filesystem::path("/proc") / std::to_string(all[i]) / "exe", none);
    if (program.filename() == "lucerna-mpi") ranks.push_back(all[i]);
  }
  return ranks;
}

/// A run of one process and runs under mpirun, whose files are to be the same.
class MpiTest : public testing::Test {
 protected:
  /// `lucerna` with these words and the folder "alone".
  void run_alone(std::vector<std::string> words) const {
    words.insert(words.begin(), program().string());
    words.insert(words.end(), {"-o", (dir_ / "alone").string()});
    ASSERT_EQ(wait_for(start(words, dir_ / "log")), 0) << log();
  }
  /// `lucerna-mpi` with these words and the folder `out`.
  pid_t start_ranks(int ranks, const std::string& command, const std::string& out,
                    const std::vector<std::string>& more) const {
    std::vector<std::string> words = mpi_command(ranks, command);
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"-o", (dir_ / out).string()});
    return start(words, dir_ / "log");
  }
  /// Output of the latest run.
  std::string log() const { return read_file(dir_ / "log", kMostBytes); }

  /// Every file of "alone", at least so many, is in the other folder to the byte; of result.json all but how
  /// it was made.
  void expect_same(const std::string& out, std::size_t least, const std::string& what) const {
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(dir_ / "alone")) {
      const std::filesystem::path name = entry.path().filename();
      const std::string a = read_file(entry.path(), kMostBytes), b = read_file(dir_ / out / name, kMostBytes);
      ++files;
      if (name == "result.json") {
        EXPECT_EQ(without_run(a), without_run(b)) << what;
      } else {
        EXPECT_TRUE(a == b) << name << ", " << what;
      }
    }
    EXPECT_GE(files, least);
    EXPECT_FALSE(std::filesystem::exists(dir_ / out / "parts")) << what;
  }

  TempDir dir_;

 private:
  static std::string without_run(const std::string& json) {
    auto j = nlohmann::ordered_json::parse(json);
    for (const char* key : {"command", "threads", "wall_s"}) j.erase(key);
    if (j.contains("validation")) j["validation"].erase("seconds");
    return j.dump(1);
  }
};

}  // namespace lucerna::test
