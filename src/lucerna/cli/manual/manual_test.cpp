// SPDX-License-Identifier: Apache-2.0
// What is installed beside the program, against what the program itself says: `lucerna COMMAND --help`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "lucerna/bounding_surface.h"
#include "lucerna/cli/manual/bash_completion.h"
#include "lucerna/cli/manual/manual_pages.h"
#include "lucerna/core/io/file.h"
#include "lucerna/random.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "lucerna/source_model.h"
#include "lucerna/trace.h"
#include "tests/support/run_program.h"

namespace lucerna::cli {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

std::vector<std::string> lines_in(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The first words of the indented lines below a heading of a help text.
std::vector<std::string> listed_below(const std::string& help, const std::string& title) {
  std::vector<std::string> words;
  bool inside = false;
  for (const std::string& line : lines_in(help)) {
    if (!line.starts_with(' ')) inside = line == title;
    if (inside && line.starts_with("  ") && line.size() > 2 && line[2] != ' ')
      words.push_back(line.substr(2, line.find_first_of(" ,", 2) - 2));
  }
  return words;
}

/// "--output" and "-o" of the lines "  -o,--output TEXT ...", and the arguments of a help text.
std::set<std::string> names_in_help(const std::string& help) {
  std::set<std::string> names;
  for (const std::string& line : lines_in(help)) {
    if (!line.starts_with("  -")) continue;
    std::istringstream in(line.substr(2, line.find(' ', 2) - 2));
    for (std::string name; std::getline(in, name, ',');) names.insert(name);
  }
  for (const std::string& name : listed_below(help, "Positionals:")) names.insert(name);
  return names;
}

std::string help_of(const std::string& command) {
  const test::TempDir dir;
  return test::run_lucerna(dir.path(), command + " --help").out;
}

std::vector<std::string> commands_in_help() { return listed_below(help_of(""), "Subcommands:"); }

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

/// What bash would offer for the last of `words`, one a line.
std::vector<std::string> completions(const std::string& words, const std::string& files = "") {
  const test::TempDir dir;
  write_file(dir / "lucerna.bash", bash_completion());
  write_file(dir / "ask.bash",
             ". ./lucerna.bash\nCOMP_WORDS=(lucerna " + words +
                 ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_lucerna\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
  const std::string command = "cd '" + dir.path().string() + "' && mkdir place && " +
                              (files.empty() ? "" : "touch " + files + " && ") +
                              "bash ask.bash >out 2>err </dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0) << test::slurp(dir / "err");
  EXPECT_EQ(test::slurp(dir / "err"), "");
  return lines_in(test::slurp(dir / "out"));
}

bool has_bash() {
  return std::system("bash -c 'complete -p >/dev/null; mapfile </dev/null' 2>/dev/null") == 0;
}

TEST(CompletionCli, OffersEveryCommandAndItsOptions) {
  if (!has_bash()) GTEST_SKIP() << "no bash";
  const auto offered = completions("''");
  for (const std::string& command : commands_in_help()) {
    EXPECT_THAT(offered, Contains(command));
    const auto options = completions(command + " -");
    for (const std::string& name : names_in_help(help_of(command))) {
      if (!name.starts_with('-')) continue;
      EXPECT_THAT(options, Contains(name)) << command;
    }
  }
}

TEST(CompletionCli, FollowsWhatIsTyped) {
  if (!has_bash()) GTEST_SKIP() << "no bash";
  EXPECT_THAT(completions("tr"), UnorderedElementsAre("trace"));
  EXPECT_THAT(completions("compress --method a"), UnorderedElementsAre("adaptive"));
  EXPECT_THAT(completions("compress --method = cl"), UnorderedElementsAre("clusters"));
  EXPECT_THAT(completions("convert --ies-turn ''"), UnorderedElementsAre("0", "90"));
  EXPECT_THAT(completions("make-source phong"), UnorderedElementsAre("phong500", "phong25"));
  EXPECT_THAT(completions("trace --seed ''"), UnorderedElementsAre(""));
  EXPECT_THAT(completions("trace lamp", "lamp.toml 'lamp two.toml' other"),
              UnorderedElementsAre("lamp.toml", "lamp two.toml"));
  EXPECT_THAT(completions("trace lamp.toml -o pl", "lamp.toml"), UnorderedElementsAre("place"));
}

// Words that the parser does not know, but the library does.
TEST(CompletionCli, OffersWordsThatAreTaken) {
  if (!has_bash()) GTEST_SKIP() << "no bash";
  for (const auto& word : completions("make-source ''")) EXPECT_NO_THROW((void)emitter_kind(word));
  for (const auto& word : completions("trace --sequence ''")) EXPECT_NO_THROW((void)sequence_kind(word));
  for (const auto& word : completions("trace --device ''")) EXPECT_NO_THROW((void)trace_device(word));
  for (const auto& word : completions("compress --method ''")) EXPECT_NO_THROW((void)compress_method(word));
  for (const auto& word : completions("make-source --surface ''")) EXPECT_NO_THROW((void)surface_kind(word));
  const auto formats = completions("info --format ''");
  EXPECT_EQ(formats.size(), ray_formats().size());
  for (const auto& word : formats) EXPECT_NO_THROW((void)ray_file_ending(word));
}

}  // namespace
}  // namespace lucerna::cli
