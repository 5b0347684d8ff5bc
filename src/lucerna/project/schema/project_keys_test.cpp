// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project/schema/project_keys.h"

#include <gtest/gtest.h>

#include <set>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "tests/support/paths.h"

namespace lucerna {
namespace {

TEST(ProjectKeys, EachStandsOnceInATableThatIsThere) {
  std::set<std::pair<std::string_view, std::string_view>> seen;
  for (const ProjectKey& k : project_keys()) {
    EXPECT_TRUE(seen.emplace(k.table, k.key).second) << k.table << "." << k.key;
    EXPECT_EQ(k.type == KeyType::word, !k.words.empty()) << k.table << "." << k.key;
    EXPECT_FALSE(k.meaning.empty() || k.otherwise.empty()) << k.table << "." << k.key;
    if (k.table.empty()) continue;
    const std::size_t dot = k.table.rfind('.');
    const bool inner = dot != std::string_view::npos;
    const ProjectKey* above = find_key(project_keys(), inner ? k.table.substr(0, dot) : "",
                                       inner ? k.table.substr(dot + 1) : k.table);
    ASSERT_NE(above, nullptr) << k.table;
    EXPECT_TRUE(above->type == KeyType::table || above->type == KeyType::tables) << k.table;
  }
}

TEST(ProjectKeys, RangesHoldTheirEnds) {
  const KeyRange half_open{.min = 0.0, .max = 1.0, .min_excluded = true};
  EXPECT_FALSE(half_open.contains(0.0));
  EXPECT_TRUE(half_open.contains(1.0));
  EXPECT_FALSE(half_open.contains(1.1));
  EXPECT_EQ(half_open.text(), "> 0 and <= 1");
  const KeyRange whole{.min = 1.0, .max = 60.0, .whole = true};
  EXPECT_TRUE(whole.contains(60.0));
  EXPECT_FALSE(whole.contains(2.5));
  EXPECT_EQ(whole.text(), "a whole number from 1 to 60");
  EXPECT_EQ((KeyRange{.min = 0.0}).text(), ">= 0");
  EXPECT_EQ((KeyRange{.max = 90.0, .max_excluded = true}).text(), "< 90");
  EXPECT_EQ(KeyRange().text(), "");
  EXPECT_TRUE(KeyRange().contains(-1e300));
}

TEST(ProjectKeys, WordsAndUnits) {
  EXPECT_EQ(alternatives("a"), "a");
  EXPECT_EQ(alternatives("a b"), "a or b");
  EXPECT_EQ(alternatives("a b c"), "a, b or c");
  EXPECT_EQ(unit_of("focal_mm"), "mm");
  EXPECT_EQ(unit_of("max_cd_per_klm"), "cd/klm");
  EXPECT_EQ(unit_of("absorption_per_mm"), "1/mm");
  EXPECT_EQ(unit_of("reflectance"), "");
}

std::set<std::string> words_of(const char* table, const char* key) {
  std::set<std::string> words;
  std::string text(find_key(project_keys(), table, key)->words);
  for (std::size_t end = 0; !text.empty(); text.erase(0, end + (end < text.size() ? 1 : 0))) {
    end = std::min(text.find(' '), text.size());
    words.insert(text.substr(0, end));
  }
  return words;
}

TEST(ProjectKeys, WordsAreThoseThatTheLibraryKnows) {
  std::set<std::string> kinds, formats;
  for (int k = 0; k <= static_cast<int>(EmitterKind::cosine); ++k)
    kinds.emplace(to_string(static_cast<EmitterKind>(k)));
  EXPECT_EQ(words_of("source", "kind"), kinds);
  for (const std::string_view format : ray_formats()) formats.emplace(format);
  EXPECT_EQ(words_of("detector", "format"), formats);
  std::set<std::string> surfaces;
  for (const std::string& name : words_of("source", "surface"))
    surfaces.emplace(to_string(surface_kind(name)));
  EXPECT_EQ(words_of("source", "surface"), surfaces);
}

// That no parser reads a key which is not in the table, TomlReader checks; that the table has none which no
// parser reads is looked for in their text.
TEST(ProjectKeys, EachIsReadSomewhere) {
  std::string parsers;
  for (const char* file :
       {"project/sections/project.cpp", "project/sections/project_source.cpp",
        "project/sections/project_reflector.cpp", "project/sections/project_body.cpp",
        "project/sections/project_detector.cpp", "project/sections/project_surface.cpp",
        "design/run/design_problem.cpp", "design/problem/design_limits.cpp", "design/problem/target.cpp",
        "design/lens/lens_problem.cpp", "design/lens/lens_limits.cpp", "design/problem/target_zone.cpp",
        "design/validation/tolerances.cpp"}) {
    parsers += read_file(test::source_dir() / "src/lucerna" / file, 1 << 20);
  }
  for (const ProjectKey& k : project_keys()) {
    EXPECT_NE(parsers.find('"' + std::string(k.key) + '"'), std::string::npos) << k.table << "." << k.key;
  }
}

}  // namespace
}  // namespace lucerna
