// SPDX-License-Identifier: Apache-2.0
// Every file that names the version of Lucerna names that of CMakeLists.txt, and the same day of release.
#include "lucerna/version.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna::test {
namespace {

/// What a release names itself in the files of the tree.
struct Release {
  std::string version;
  std::string day;  ///< "2026-11-24"; "unreleased" as long as CHANGELOG.md says so
};

/// The first heading of the changelog: "## 0.2.0 (unreleased)".
Release newest_release(const std::string& changelog) {
  const std::string heading = between(changelog, "\n## ", "\n").at(0);
  return {heading.substr(0, heading.find(' ')), between(heading, "(", ")").at(0)};
}

/// "24 Nov 2026" of Debian's changelogs as "2026-11-24"; empty if it is no date.
std::string iso_day(const std::string& text) {
  constexpr std::array kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                               "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  for (std::size_t month = 0; month < kMonths.size(); ++month) {
    const std::size_t at = text.find(kMonths[month]);
    if (at == std::string::npos || at < 3 || text.size() < at + 8) continue;
    std::array<char, 32> day{};
    std::snprintf(day.data(), day.size(), "%s-%02d-%s", text.substr(at + 4, 4).c_str(),
                  static_cast<int>(month) + 1, text.substr(at - 3, 2).c_str());
    return day.data();
  }
  return {};
}

/// What stands between the marks everywhere in a text, other than `wanted`.
std::vector<std::string> others(const std::string& text, std::string_view before, std::string_view after,
                                const std::string& wanted) {
  const std::vector<std::string> found = between(text, before, after);
  if (found.empty()) return {"none"};
  std::vector<std::string> wrong;
  for (const std::string& word : found)
    if (word != wanted) wrong.push_back(word);
  return wrong;
}

std::string file(const char* name) { return slurp(source_dir() / name); }

using Strings = std::vector<std::string>;

TEST(Version, IsTheSameInEveryFile) {
  const std::string version(lucerna::version());
  EXPECT_EQ(newest_release(file("CHANGELOG.md")).version, version);
  EXPECT_EQ(others(file("CITATION.cff"), "\nversion: ", "\n", version), Strings{});
  EXPECT_EQ(between(file("packaging/debian/changelog"), "lucerna (", "-").at(0), version);
  EXPECT_EQ(others(file("docs/Doxyfile"), "LUCERNA_VERSION=", " ", version), Strings{});
  const std::string install = file("docs/install.md");
  const std::string series = version.substr(0, version.rfind('.'));
  EXPECT_EQ(others(install, "./lucerna_", "-1_amd64.deb", version), Strings{});
  EXPECT_EQ(others(install, "./liblucerna" + series + "_", "-1_amd64.deb", version), Strings{});
  EXPECT_EQ(others(install, "./liblucerna-dev_", "-1_amd64.deb", version), Strings{});
  EXPECT_EQ(others(install, "`liblucerna", "`", series), (Strings{"-dev"}));
  EXPECT_TRUE(has(file("pyproject.toml"), "dynamic = [\"version\"]"))
      << "lucerna_build.py asks CMakeLists.txt";
}

TEST(Version, HasOneDayOfRelease) {
  const Release newest = newest_release(file("CHANGELOG.md"));
  if (newest.day == "unreleased") GTEST_SKIP() << newest.version << " is not released";
  EXPECT_EQ(others(file("CITATION.cff"), "\ndate-released: ", "\n", newest.day), Strings{});
  EXPECT_EQ(iso_day(between(file("packaging/debian/changelog"), "\n -- ", "\n").at(0)), newest.day);
}

TEST(Version, ChecksSeeWhatDiffers) {
  const Release newest = newest_release("# Changelog\n\n## 1.2.3 (2030-01-31)\n\n## 1.2.2 (2029-01-31)\n");
  EXPECT_EQ(newest.version + " " + newest.day, "1.2.3 2030-01-31");
  EXPECT_EQ(iso_day("A <a@b>  Thu, 31 Jan 2030 12:00:00 +0000"), "2030-01-31");
  EXPECT_EQ(iso_day("some day"), "");
  EXPECT_EQ(others("a_1_b a_2_b", "a_", "_b", "1"), (Strings{"2"}));
  EXPECT_EQ(others("nothing", "a_", "_b", "1"), (Strings{"none"}));
}

}  // namespace
}  // namespace lucerna::test
