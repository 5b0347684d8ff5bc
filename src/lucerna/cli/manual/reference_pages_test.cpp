// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/manual/reference_pages.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/core/io/file.h"
#include "lucerna/project/schema/project_keys.h"
#include "lucerna/results/json/result_fields.h"
#include "tests/support/paths.h"

namespace lucerna::cli {
namespace {

TEST(ReferencePages, AreWhatTheCodeSays) {
  const auto pages = reference_pages();
  EXPECT_EQ(pages.size(), 4u);
  for (const auto& [name, text] : pages) {
    const auto file = test::source_dir() / "docs/reference" / name;
    ASSERT_TRUE(std::filesystem::exists(file)) << file << " is missing: make reference";
    EXPECT_TRUE(read_file(file, 1 << 20) == text) << name << " is stale: make reference";
  }
}

std::ptrdiff_t rows(const std::string& page, const std::string& start) {
  std::ptrdiff_t n = 0;
  for (std::size_t i = page.find('\n' + start); i != std::string::npos; i = page.find('\n' + start, i + 1))
    ++n;
  return n;
}

TEST(ReferencePages, HaveARowForEachKeyAndASectionForEachCommand) {
  const auto pages = reference_pages();
  EXPECT_EQ(rows(pages.at("project-file.md"), "| `"), static_cast<std::ptrdiff_t>(project_keys().size()));
  const std::string& cli = pages.at("cli.md");
  EXPECT_EQ(rows(cli, "## "), 1 + static_cast<std::ptrdiff_t>(kCommands.size()));
  for (const char* option : {"`--noise`", "`PROJECT`", "`-o, --output`", "`--advise`", "`FILE...`"})
    EXPECT_NE(cli.find(option), std::string::npos) << option;
}

TEST(ReferencePages, HaveARowForEachFieldOfTheResults) {
  const std::string page = reference_pages().at("result-json.md");
  EXPECT_EQ(rows(page, "| `"), static_cast<std::ptrdiff_t>(result_fields().size() + command_fields().size()));
}

}  // namespace
}  // namespace lucerna::cli
