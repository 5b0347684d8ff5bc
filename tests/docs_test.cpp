// SPDX-License-Identifier: Apache-2.0
// The form of the pages in docs/: no line over 100 columns, no sentence over 40 words. The notebook is what
// was written at the time.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/paths.h"
#include "tests/support/prose.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxColumns = 100, kMaxWords = 40;

std::vector<fs::path> pages_of_docs() {
  std::vector<fs::path> pages;
  for (const auto& entry : fs::recursive_directory_iterator(source_dir() / "docs")) {
    const bool notebook = entry.path().string().find("/development/notebook/") != std::string::npos;
    if (entry.path().extension() == ".md" && !notebook) pages.push_back(entry.path());
  }
  return pages;
}

TEST(Docs, LinesAndSentencesAreShort) {
  const auto pages = pages_of_docs();
  ASSERT_GT(pages.size(), 15u);
  for (const fs::path& page : pages) {
    const std::string text = slurp(page);
    for (const std::size_t line : long_lines(text, kMaxColumns))
      ADD_FAILURE() << page << ":" << line << ": more than " << kMaxColumns << " columns";
    for (const std::string& sentence : long_sentences(text, kMaxWords))
      ADD_FAILURE() << page << ": more than " << kMaxWords << " words: " << sentence;
    for (const std::size_t line : lines_taken_for_marks(text))
      ADD_FAILURE() << page << ":" << line << ": begins like a comment or an item within a sentence";
  }
}

/// The sources and scripts that print messages, as one text, with strings that are cut into lines joined.
std::string messages_of_sources() {
  std::string all;
  for (const char* folder : {"src/lucerna", "python/src"}) {
    for (const auto& entry : fs::recursive_directory_iterator(source_dir() / folder)) {
      const std::string name = entry.path().filename();
      if (name.ends_with(".cpp") && !name.ends_with("_test.cpp")) all += slurp(entry.path());
    }
  }
  std::string joined;
  for (std::size_t at = 0; at < all.size();) {
    // "one " and "two" on the next line are one string.
    const std::size_t next = all[at] == '"' ? all.find_first_not_of(" \n", at + 1) : std::string::npos;
    if (next != std::string::npos && next > at + 1 && all[next] == '"') {
      at = next + 1;
    } else {
      joined += all[at++];
    }
  }
  return joined;
}

/// The messages that a page explains: what stands in backquotes in the first column of its tables.
std::vector<std::string> explained_messages(const std::string& page) {
  std::vector<std::string> messages;
  for (const std::string& cell : between(page, "\n| `", " | ")) {
    for (const std::string& message : between("`" + cell, "`", "`"))
      if (message.size() > 3 && message.front() != ',' && message.front() != ' ') messages.push_back(message);
  }
  return messages;
}

TEST(Docs, ExplainedMessagesAreOnesThatAreThere) {
  const std::string sources = messages_of_sources();
  const auto messages = explained_messages(slurp(source_dir() / "docs/troubleshooting.md"));
  EXPECT_GT(messages.size(), 20u);
  for (const std::string& message : messages) {
    if (message == "No module named 'lucerna'") continue;  // Python's own
    EXPECT_NE(sources.find(message), std::string::npos) << message;
  }
}

TEST(Docs, CheckSeesMessages) {
  EXPECT_EQ(explained_messages("\n| message | b |\n| `one two` with `three` | `four` |\n"),
            (std::vector<std::string>{"one two", "three"}));
}

TEST(Docs, CheckSeesLongLines) {
  const std::string line(101, 'x'), words = std::string(96, 'x') + " yy z";
  EXPECT_EQ(long_lines("short\n" + words + "\n", 100), (std::vector<std::size_t>{2}));
  EXPECT_EQ(long_lines(std::string(95, 'x') + " yy z", 100).size(), 0u);
  EXPECT_EQ(long_lines(line, 100).size(), 0u) << "a word cannot be broken";
  EXPECT_EQ(long_lines("```sh\n" + words + "\n```\n| " + words + " |\n", 100).size(), 0u);
  EXPECT_EQ(long_lines("\u00b5" + words.substr(1), 100).size(), 1u);
  EXPECT_EQ(long_lines("\u00b5" + words.substr(2), 100).size(), 0u) << "columns, not bytes";
}

TEST(Docs, CheckSeesLongSentences) {
  const auto count = [](const std::string& page) { return long_sentences(page, 4).size(); };
  EXPECT_EQ(count("One two three four. Five six.\n"), 0u);
  EXPECT_EQ(count("One two three\nfour five.\n"), 1u) << "over two lines";
  EXPECT_EQ(count("One two, 3.5 mm, e.g. four five. Six.\n"), 1u) << "a point within a sentence";
  EXPECT_EQ(count("- One two three four\n- five six\n"), 0u) << "items of a list";
  EXPECT_EQ(count("- One two three\n  four five\n"), 1u);
  EXPECT_EQ(count("| one two | three four five |\n"), 0u);
  EXPECT_EQ(count("| one two three four five | six |\n"), 1u);
  EXPECT_EQ(count("# One two three\nfour five\n"), 0u) << "a heading";
  EXPECT_EQ(count("```sh\none two three four five\n```\n    one two three four five\n"), 0u) << "code";
  EXPECT_EQ(count("One = two - three (four) +- five six.\n"), 1u);
  EXPECT_EQ(count("One = two - three + (four) +-.\n"), 0u) << "signs are no words";
}

TEST(Docs, CheckSeesSentencesThatBeginLikeMarks) {
  using Lines = std::vector<std::size_t>;
  EXPECT_EQ(lines_taken_for_marks("It is within 2\n% of that.\n"), Lines{2});
  EXPECT_EQ(lines_taken_for_marks("- above 3\n  %.\n"), Lines{2});
  EXPECT_EQ(lines_taken_for_marks("With seed\n1. The rest.\n"), Lines{2});
  EXPECT_EQ(lines_taken_for_marks("Times a\n- b.\n"), Lines{2});
  EXPECT_EQ(lines_taken_for_marks("- times a\n  - b.\n"), Lines{2});
  EXPECT_EQ(lines_taken_for_marks("All of these:\n- one\n- two\n\n1. three\n2. four\n"), Lines{});
  EXPECT_EQ(lines_taken_for_marks("# Heading\n- one\n  more\n- two\n"), Lines{});
  EXPECT_EQ(lines_taken_for_marks("```\n% a\nb\n- c\n```\n"), Lines{});
}

}  // namespace
}  // namespace lucerna::test
