// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/manual/cli_reference.h"

#include <gtest/gtest.h>

#include "lucerna/cli/manual/program_options.h"
#include "tests/support/text_scan.h"

namespace lucerna::cli {
namespace {

std::size_t option_rows(const std::string& section) {
  std::size_t n = 0;
  for (std::size_t i = section.find("\n| `"); i != std::string::npos; i = section.find("\n| `", i + 1)) ++n;
  return n;
}

// The page against the parser, option by option: the count is that of the rows.
TEST(CliReference, HasARowForEachOptionOfEachCommand) {
  const std::string page = cli_reference();
  std::size_t options = 0;
  for (const CommandFacts& command : program_commands()) {
    const auto sections = test::between(page + "\n## ", "\n## " + command.name + "\n", "\n## ");
    ASSERT_EQ(sections.size(), 1u) << command.name;
    EXPECT_EQ(option_rows(sections.front()), command.options.size()) << command.name;
    for (const OptionFacts& option : command.options) {
      std::string names;
      for (const std::string& name : option.names) names += (names.empty() ? "| `" : ", ") + name;
      EXPECT_TRUE(test::has(sections.front(), names)) << command.name << ' ' << names;
      ++options;
    }
  }
  EXPECT_GT(options, 100u);
}

}  // namespace
}  // namespace lucerna::cli
