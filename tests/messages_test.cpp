// SPDX-License-Identifier: Apache-2.0
// What the library says to its caller, who may be another program: no text of it names an option or a command
// of ours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/paths.h"

namespace fs = std::filesystem;

namespace {

/// The string literals of a source, those of several lines too; comments and character literals are passed
/// over.
std::vector<std::string> literals_of(const std::string& text) {
  std::vector<std::string> found;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "//") == 0) {
      i = std::min(text.find('\n', i), text.size());
    } else if (text.compare(i, 3, "R\"(") == 0) {
      const std::size_t end = std::min(text.find(")\"", i), text.size());
      found.push_back(text.substr(i + 3, end - i - 3));
      i = end + 1;
    } else if (text[i] == '\'' && (i == 0 || std::isalnum(static_cast<unsigned char>(text[i - 1])) == 0)) {
      i += text.compare(i + 1, 1, "\\") == 0 ? 3 : 2;
    } else if (text[i] == '"') {
      std::string literal;
      for (++i; i < text.size() && text[i] != '"' && text[i] != '\n'; ++i) {
        if (text[i] == '\\') literal += text[i++];
        if (i < text.size()) literal += text[i];
      }
      found.push_back(literal);
    }
  }
  return found;
}

bool is_lower(char c) { return c >= 'a' && c <= 'z'; }

/// Whether a text has an option of a program, like --rays: two hyphens that begin a word.
bool names_option(std::string_view text) {
  for (std::size_t at = text.find("--"); at != std::string_view::npos; at = text.find("--", at + 2)) {
    const bool begins = at == 0 || text[at - 1] == ' ' || text[at - 1] == '`' || text[at - 1] == '\'' ||
                        text[at - 1] == '(' || text[at - 1] == '"';
    if (begins && at + 2 < text.size() && is_lower(text[at + 2])) return true;
  }
  return false;
}

/// Whether a text has a command line of ours, like "lucerna trace".
bool names_command(std::string_view text) {
  for (const char* command : {"init", "info", "check", "convert", "make-source", "compress", "sample",
                              "trace", "merge", "compare", "design", "report", "bench"}) {
    if (text.find(std::string("lucerna ") + command) != std::string_view::npos) return true;
  }
  return false;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Whether a file, named from the repository, belongs to a program: one of its folders is `cli` or `mpi`.
bool of_the_program(const fs::path& file) {
  return std::any_of(file.begin(), file.end(),
                     [](const fs::path& part) { return part == "cli" || part == "mpi"; });
}

TEST(Messages, OfTheLibraryNameNoOptionOfTheProgram) {
  std::size_t literals = 0;
  for (const auto& entry : fs::recursive_directory_iterator(lucerna::test::source_dir() / "src")) {
    const fs::path& file = entry.path();
    if (file.extension() != ".h" && file.extension() != ".cpp" && file.extension() != ".cu") continue;
    if (of_the_program(file.lexically_relative(lucerna::test::source_dir())) ||
        file.stem().string().ends_with("_test"))
      continue;
    for (const std::string& text : literals_of(text_of(file))) {
      ++literals;
      // Pages that the program writes or prints are for its users: the template of a project, reference
      // pages.
      if (text.starts_with("# ")) continue;
      EXPECT_FALSE(names_option(text)) << file << ": " << text;
      EXPECT_FALSE(names_command(text)) << file << ": " << text;
    }
  }
  EXPECT_GT(literals, 2000u);
}

TEST(Messages, CheckSeesOptionsAndCommands) {
  EXPECT_EQ(literals_of("f(\"a \\\"b\", 'c', '\"', 1'000, R\"(d\ne)\");  // \"no\"\ng(\"h\");"),
            (std::vector<std::string>{"a \\\"b", "d\ne", "h"}));
  EXPECT_TRUE(names_option("no flux: give --flux"));
  EXPECT_TRUE(names_option("`--resume` goes on"));
  EXPECT_FALSE(names_option("a -- b, c--d, ---- e, --1"));
  EXPECT_TRUE(names_command("expected what lucerna trace has written"));
  EXPECT_FALSE(names_command("written by lucerna 0.2"));
}

}  // namespace
