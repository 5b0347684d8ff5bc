// SPDX-License-Identifier: Apache-2.0
// What the pages of the docs point to is there.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/source_tree.h"
#include "tests/support/text_scan.h"

namespace lucerna::test {
namespace {

namespace fs = std::filesystem;

/// What a page of ours links to, as written: [text](target), not addresses of the web, nor places within the
/// page.
std::vector<std::string> links_of(const std::string& page) {
  std::vector<std::string> links;
  for (const std::string& target : between(page, "](", ")")) {
    if (target.find("://") == std::string::npos && !target.starts_with('#'))
      links.push_back(target.substr(0, target.find('#')));
  }
  return links;
}

/// The files of ours that a page names in backquotes: those that begin with a folder of the tree and have an
/// ending.
std::vector<std::string> paths_of(const std::string& page) {
  std::vector<std::string> paths;
  for (const char* folder :
       {"src/", "include/", "tests/", "docs/", "scripts/", "cmake/", "fuzz/corpus", "bench/"}) {
    for (const std::string& rest : between(page, std::string("`") + folder, "`")) {
      const bool plain =
          rest.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./") ==
          std::string::npos;
      const std::size_t dot = rest.rfind('.');
      if (plain && dot != std::string::npos && dot + 1 < rest.size()) paths.push_back(folder + rest);
    }
  }
  return paths;
}

/// The private sources that a page names in backquotes by their place below src/lucerna:
/// `trace/run/trace.cpp`.
std::vector<std::string> places_of(const std::string& page) {
  std::vector<std::string> places;
  for (const auto& entry : fs::directory_iterator(source_dir() / "src/lucerna")) {
    const std::string room = entry.path().filename();
    for (const std::string& rest : between(page, "`" + room + "/", "`")) {
      const std::string ending = fs::path(rest).extension().string();
      const bool any = rest.find_first_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") != std::string::npos;  // COMMAND.cpp
      if (!any && (ending == ".h" || ending == ".cpp" || ending == ".cu"))
        places.push_back(room + "/" + rest);
    }
  }
  std::sort(places.begin(), places.end());
  return places;
}

std::string text_of(const fs::path& file) {
  std::string text;
  for (const std::string& line : lines_of(file)) text += line + "\n";
  return text;
}

std::vector<fs::path> pages() {
  const fs::path root = source_dir();
  std::vector<fs::path> pages;
  for (const auto& entry : fs::directory_iterator(root)) pages.push_back(entry.path());
  for (const auto& entry : fs::recursive_directory_iterator(root / "docs")) pages.push_back(entry.path());
  std::erase_if(pages, [](const fs::path& p) { return p.extension() != ".md"; });
  return pages;
}

TEST(Docs, LinksAndPathsLeadSomewhere) {
  std::size_t seen = 0;
  for (const fs::path& page : pages()) {
    const std::string text = text_of(page);
    for (const std::string& link : links_of(text)) {
      ++seen;
      EXPECT_TRUE(fs::exists(page.parent_path() / link)) << page << " links to " << link;
    }
    for (const std::string& path : paths_of(text)) {
      ++seen;
      EXPECT_TRUE(fs::exists(source_dir() / path)) << page << " names " << path;
    }
    for (const std::string& place : places_of(text)) {
      ++seen;
      EXPECT_TRUE(fs::exists(source_dir() / "src/lucerna" / place)) << page << " names " << place;
    }
  }
  EXPECT_GT(seen, 20u);
}

TEST(Docs, CheckSeesLinksAndPaths) {
  const std::string page =
      "[a](docs/a.md#part) [b](https://example.org) [c](#here) `tests/x_test.cpp` `src/lucerna` "
      "`scripts/y.sh Z`";
  EXPECT_EQ(links_of(page), (std::vector<std::string>{"docs/a.md"}));
  EXPECT_EQ(paths_of(page), (std::vector<std::string>{"tests/x_test.cpp"}));
  EXPECT_EQ(
      places_of(
          "`trace/run/x.cpp` `cli/commands/COMMAND.cpp` `trace/result.json` `core/io/y.h: f` `core/io/z.h`"),
      (std::vector<std::string>{"core/io/z.h", "trace/run/x.cpp"}));
}

}  // namespace
}  // namespace lucerna::test
