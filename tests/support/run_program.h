// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/support/paths.h"
#include "tests/support/temp_dir.h"

namespace lucerna::test {

struct ProgramResult {
  int exit_code = -1;  ///< 128 + signal when it crashed
  std::string out, err;
};

inline std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Runs the program as a shell would, with `folder` as its working folder.
inline ProgramResult run_lucerna(const std::filesystem::path& folder, const std::string& arguments) {
  const TempDir dir;
  const std::string command = "cd '" + folder.string() + "' && '" + program().string() + "' " + arguments +
                              " >'" + (dir / "out").string() + "' 2>'" + (dir / "err").string() +
                              "' </dev/null";
  const int status = std::system(command.c_str());
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, slurp(dir / "out"), slurp(dir / "err")};
}

}  // namespace lucerna::test
