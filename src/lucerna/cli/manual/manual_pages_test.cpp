// SPDX-License-Identifier: Apache-2.0
// The manual against what the program itself says: `lucerna COMMAND --help`.
#include "lucerna/cli/manual/manual_pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "tests/support/help_text.h"

namespace lucerna::cli {
namespace {

using test::commands_in_help, test::help_of, test::lines_in, test::names_in_help;
using testing::Contains;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

/// The same text without the marks of man(7).
std::string without_marks(std::string text) {
  for (const std::string mark : {"\\fB", "\\fI", "\\fR", "\\&"}) {
    for (std::size_t at = 0; (at = text.find(mark)) != std::string::npos;) text.erase(at, mark.size());
  }
  for (std::size_t at = 0; (at = text.find("\\-")) != std::string::npos;) text.erase(at, 1);
  return text;
}

/// What stands in a page as the heading of an entry: "-o, --output OUTPUT".
std::set<std::string> names_in_page(const std::string& page) {
  std::set<std::string> names;
  const auto lines = lines_in(without_marks(page));
  for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
    if (lines[i] != ".TP") continue;
    std::istringstream in(lines[i + 1]);
    for (std::string word; in >> word;) {
      if (word.ends_with(',')) word.pop_back();
      names.insert(word);
    }
  }
  return names;
}

std::set<std::string> missing_names(const std::string& help, const std::string& page) {
  const auto asked = names_in_help(help), there = names_in_page(page);
  std::set<std::string> missing;
  std::set_difference(asked.begin(), asked.end(), there.begin(), there.end(),
                      std::inserter(missing, missing.end()));
  return missing;
}

std::map<std::string, std::string> pages_by_name() {
  std::map<std::string, std::string> pages;
  for (const ManualPage& page : manual_pages()) pages[page.name] = page.text;
  return pages;
}

TEST(ManualCli, EveryCommandHasAPageWithAllItsOptions) {
  const auto commands = commands_in_help();
  const auto pages = pages_by_name();
  ASSERT_GE(commands.size(), 13u);
  EXPECT_EQ(pages.size(), commands.size() + 1);
  for (const std::string& command : commands) {
    const auto page = pages.find("lucerna-" + command + ".1");
    ASSERT_NE(page, pages.end()) << command;
    const std::string help = help_of(command);
    EXPECT_GE(names_in_help(help).size(), 4u) << help;
    EXPECT_THAT(missing_names(help, page->second), IsEmpty()) << command;
    EXPECT_NE(without_marks(pages.at("lucerna.1")).find("lucerna-" + command + " (1)"), std::string::npos)
        << command;
  }
}

TEST(Manual, CheckSeesAnOptionThatIsMissing) {
  const std::string help = "Positionals:\n  FILE TEXT\n\nOptions:\n  -o,--output TEXT\n  --seed TEXT=1\n";
  EXPECT_THAT(missing_names(help, ".TP\n\\fB\\-o\\fR, \\fB\\-\\-output\\fR\nx \\-\\-seed FILE\n"),
              UnorderedElementsAre("FILE", "--seed"));
}

// What the examples give is known to the program.
TEST(ManualCli, ExamplesUseWhatThereIs) {
  std::size_t examples = 0;
  const auto lines = lines_in(without_marks(pages_by_name().at("lucerna.1")));
  for (std::size_t i = 1; i < lines.size(); ++i) {
    std::istringstream in(lines[i]);
    std::string word, command;
    in >> word >> command;
    if (word != "lucerna" || lines[i - 1] != ".TP") continue;
    ++examples;
    const auto known = names_in_help(help_of(command));
    ASSERT_FALSE(known.empty()) << lines[i];
    while (in >> word) {
      if (!word.starts_with('-')) continue;
      EXPECT_THAT(known, Contains(word)) << lines[i];
    }
  }
  EXPECT_EQ(examples, commands_in_help().size());
}

}  // namespace
}  // namespace lucerna::cli
