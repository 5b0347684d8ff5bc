// SPDX-License-Identifier: Apache-2.0
#include "tests/support/source_tree.h"

#include <fstream>

#include "tests/support/paths.h"

namespace lucerna::test {

namespace fs = std::filesystem;

std::vector<fs::path> source_files() {
  std::vector<fs::path> files;
  for (const char* top : {"src/lucerna", "include/lucerna"}) {
    for (const auto& entry : fs::recursive_directory_iterator(source_dir() / top)) {
      const std::string ending = entry.path().extension().string();
      if (ending == ".h" || ending == ".cpp" || ending == ".cu") files.push_back(entry.path());
    }
  }
  return files;
}

bool is_public(const fs::path& file) { return file.parent_path().parent_path().filename() == "include"; }

bool is_test(const fs::path& file) { return file.stem().string().ends_with("_test"); }

fs::path place_of(const fs::path& file) { return file.lexically_relative(source_dir() / "src/lucerna"); }

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace lucerna::test
