// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

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

}  // namespace lucerna::test
