// SPDX-License-Identifier: Apache-2.0
// Checks on the source tree: includes point one way only, files stay short, every file carries its licence.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/support/paths.h"

namespace fs = std::filesystem;

namespace {

using Layers = std::map<std::string, std::set<std::string>>;

/// Which folder may include which: the table of ARCHITECTURE.md. A folder may always include itself.
const Layers kMayInclude{
    {"core", {}},
    {"rayset", {"core"}},
    {"photometry", {"core"}},
    {"source", {"core", "rayset"}},
    {"reflector", {"core"}},
    {"trace", {"core", "rayset", "photometry", "source", "reflector"}},
    {"design", {"core", "rayset", "photometry", "source", "reflector", "trace"}},
    {"report", {"core", "rayset", "photometry", "source", "reflector", "trace", "design"}},
    {"cli", {"core", "rayset", "photometry", "source", "reflector", "trace", "design", "report"}},
};

std::vector<fs::path> source_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(lucerna::test::source_dir() / "src/lucerna")) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".h" || ending == ".cpp" || ending == ".cu") files.push_back(entry.path());
  }
  return files;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The folders that `lines` include and `folder` may not.
std::vector<std::string> forbidden_includes(const std::string& folder,
                                            const std::vector<std::string>& lines) {
  static const std::regex include(R"re(^\s*#\s*include\s+"lucerna/([a-z]+)/.*)re");
  std::vector<std::string> bad;
  for (const std::string& line : lines) {
    std::smatch match;
    if (!std::regex_match(line, match, include) || match[1] == folder) continue;
    if (!kMayInclude.at(folder).contains(match[1])) bad.push_back(line);
  }
  return bad;
}

TEST(Layering, IncludesPointLeft) {
  const auto files = source_files();
  ASSERT_GT(files.size(), 10u);
  for (const fs::path& file : files) {
    const std::string folder = file.parent_path().filename();
    ASSERT_TRUE(kMayInclude.contains(folder)) << file << " is in no known folder";
    for (const auto& line : forbidden_includes(folder, lines_of(file))) ADD_FAILURE() << file << ": " << line;
  }
}

TEST(Layering, CheckSeesABackwardInclude) {
  EXPECT_EQ(forbidden_includes("core", {"#include \"lucerna/trace/tracer.h\""}).size(), 1u);
  EXPECT_EQ(forbidden_includes("photometry", {"#include \"lucerna/rayset/ray_set.h\""}).size(), 1u);
  EXPECT_TRUE(forbidden_includes("trace", {"#include \"lucerna/core/vec.h\""}).empty());
}

TEST(Tree, FilesAreShortAndLicensed) {
  for (const fs::path& file : source_files()) {
    const auto lines = lines_of(file);
    EXPECT_LE(lines.size(), 600u) << file << ": one concept a file";
    ASSERT_FALSE(lines.empty()) << file;
    EXPECT_EQ(lines.front(), "// SPDX-License-Identifier: Apache-2.0") << file;
  }
}

}  // namespace
