// SPDX-License-Identifier: Apache-2.0
// The tutorials of docs/tutorials, run: every block of commands in order in a fresh folder, what it prints
// held against the block after it. Blocks of C++ and CMake are the files that the text before them names.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "tests/support/code_blocks.h"
#include "tests/support/paths.h"
#include "tests/support/run_program.h"
#include "tests/support/temp_dir.h"

namespace lucerna::test {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

/// What a shell prints, both streams together, with the program of this build first on its path. A command
/// that fails ends it.
ProgramResult run_shell(const fs::path& folder, const std::string& commands, const std::string& variables) {
  const TempDir dir;
  write(dir / "commands", commands);
  const std::string line = "cd '" + folder.string() + "' && PATH='" + program().parent_path().string() +
                           "':\"$PATH\" " + variables + " sh -e '" + (dir / "commands").string() + "' >'" +
                           (dir / "out").string() + "' 2>&1 </dev/null";
  const int status = std::system(line.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), slurp(dir / "out"), {}};
}

/// What is wrong with a page, one entry a block; empty where everything prints as it says. `variables`:
/// NAME='value' ... for the shell.
std::vector<std::string> faults_of(const std::string& page, const std::string& variables = "") {
  const TempDir dir;
  std::vector<std::string> faults;
  const std::vector<CodeBlock> blocks = code_blocks(page);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const CodeBlock& block = blocks[i];
    const std::string place = "line " + std::to_string(block.line) + ": ";
    if (block.language == "cpp" || block.language == "cmake") {
      write(dir / block.file, block.text);
    } else if (block.language == "sh") {
      const bool shows = i + 1 < blocks.size() && blocks[i + 1].language == "text";
      const ProgramResult result = run_shell(dir.path(), block.text, variables);
      if (result.exit_code != 0)
        faults.push_back(place + "ends with " + std::to_string(result.exit_code) + ": " + result.out);
      else if (!prints_as(shows ? blocks[i + 1].text : "", result.out))
        faults.push_back(place + "prints\n" + result.out);
    } else if (block.language != "text" || i == 0 || blocks[i - 1].language != "sh") {
      faults.push_back(place + "a block of '" + block.language + "' that nothing runs");
    }
  }
  return faults;
}

std::string tutorial(const std::string& name) {
  return slurp(source_dir() / "docs" / "tutorials" / (name + ".md"));
}

void expect_true(const std::string& name) {
  const std::string page = tutorial(name);
  EXPECT_GT(code_blocks(page).size(), 4u);
  for (const std::string& fault : faults_of(page)) ADD_FAILURE() << name << ".md, " << fault;
}

TEST(TutorialsCli, LedToModel) { expect_true("led-to-model"); }
TEST(TutorialsCli, ParaboloidToLdt) { expect_true("paraboloid-to-ldt"); }

// What a design prints depends on nothing but counts as long as its time (600 s) is not over.
TEST(TutorialsCli, DesignAFloodlight) {
#ifdef LUCERNA_SANITIZED
  GTEST_SKIP() << "with a sanitizer the time may be over first";
#endif
  expect_true("design-a-floodlight");
}

TEST(TutorialsCli, LensForADesk) {
#ifdef LUCERNA_SANITIZED
  GTEST_SKIP() << "with a sanitizer the time may be over first";
#endif
  expect_true("lens-for-a-desk");
}

// Compiled against what this build installs, so that nothing but the page and the package is needed.
TEST(TutorialsCli, AsALibrary) {
#ifdef LUCERNA_SANITIZED
  GTEST_SKIP() << "a program without the sanitizer cannot use a library with it";
#endif
  const std::string page = tutorial("as-a-library");
  const auto blocks = code_blocks(page);
  ASSERT_EQ(blocks.front().language + " " + blocks.front().file, "cpp beam.cpp");
  EXPECT_EQ(blocks.front().text, slurp(source_dir() / "examples/beam.cpp"));

  const TempDir installed;
  const std::string place = installed.path().string();
  const ProgramResult done = run_shell(
      installed.path(), "cmake --install '" + build_dir().string() + "' --prefix '" + place + "'", "");
  ASSERT_EQ(done.exit_code, 0) << done.out;
  const std::string variables = "CMAKE_PREFIX_PATH='" + place + "' CXX='" + compiler().string() + "'";
  for (const std::string& fault : faults_of(page, variables)) ADD_FAILURE() << "as-a-library.md, " << fault;
}

// Every page of the folder is one of those that are run; python.md is by python/tests/test_docs.py.
TEST(TutorialsCli, NoneIsLeftOut) {
  std::set<std::string> pages;
  for (const auto& entry : fs::directory_iterator(source_dir() / "docs" / "tutorials"))
    if (entry.path().extension() == ".md") pages.insert(entry.path().stem().string());
  EXPECT_EQ(pages, (std::set<std::string>{"as-a-library", "design-a-floodlight", "index", "led-to-model",
                                          "lens-for-a-desk", "paraboloid-to-ldt", "python"}));
}

TEST(TutorialsCli, CheckSeesWhatIsNotPrinted) {
  const std::string command = "```sh\nlucerna --version; echo 1.25 mm of C90\n```\n";
  const auto faults = [&](const std::string& after) { return faults_of(command + after).size(); };
  EXPECT_EQ(faults("```text\n...\n1.26 mm of C90\n```\n"), 0u);
  EXPECT_EQ(faults("```text\n...\n1.40 mm of C90\n```\n"), 1u);
  EXPECT_EQ(faults("```text\n...\n1.25 mm of C91\n```\n"), 1u);
  EXPECT_EQ(faults("```text\n1.25 mm of C90\n```\n"), 1u);
  EXPECT_EQ(faults(""), 1u) << "what is printed has to be shown";
  EXPECT_EQ(faults("```text\n...\n```\n```toml\na = 1\n```\n"), 1u) << "a block that nothing runs";
  EXPECT_EQ(faults_of("```sh\nfalse\n```\n").size(), 1u);
  EXPECT_EQ(
      faults_of("```sh\nfalse | true\necho 1 > a.txt\n```\n```sh\ncat a.txt\n```\n```text\n1\n```\n").size(),
      0u);
}

TEST(PrintsAs, ComparesNumbersNearlyAndWordsExactly) {
  EXPECT_TRUE(prints_as("peak 13130 +- 30 cd\n", "peak 13000 +- 50 cd\n"));
  EXPECT_FALSE(prints_as("peak 13130 +- 30 cd\n", "peak 12000 +- 30 cd\n"));
  EXPECT_FALSE(prints_as("peak 13130 +- 30 cd\n", "peak 13130 +- 70 cd\n"));
  EXPECT_FALSE(prints_as("peak 1 cd\n", "peak 1 lm\n"));
  EXPECT_TRUE(prints_as("-2.591 nats\n", "-2.590 nats\n"));
  EXPECT_FALSE(prints_as("-2.591 nats\n", "2.591 nats\n"));
  EXPECT_TRUE(prints_as("2.48e+03 times\n", "2.5e+03 times\n"));
  EXPECT_FALSE(prints_as("2.48e+03 times\n", "2.48e+04 times\n"));
  EXPECT_TRUE(prints_as("0.002 %\n", "0.003 %\n")) << "one in the last decimal";
  EXPECT_FALSE(prints_as("LM-63-2002\n", "LM-63-2019\n")) << "within 5 %, but a name";
  EXPECT_FALSE(prints_as("48 x 48\n", "40 x 48\n"));
}

TEST(PrintsAs, DotsStandForAnyText) {
  EXPECT_TRUE(prints_as("a ... c\n", "a b 17 c\n"));
  EXPECT_FALSE(prints_as("a ... c\n", "a b 17 d\n"));
  EXPECT_TRUE(prints_as("a\n  ...\nz\n", "a\nb\nc\nz\n"));
  EXPECT_TRUE(prints_as("a\n...\nz\n", "a\nz\n"));
  EXPECT_FALSE(prints_as("a\n...\nz\n", "a\nb\n"));
  EXPECT_FALSE(prints_as("a\n", "a\nb\n"));
  EXPECT_FALSE(prints_as("a\nb\n", "a\n"));
  EXPECT_FALSE(prints_as("a ... c\n", "a\nb c\n")) << "within a line";
}

TEST(CodeBlocks, KnowTheirLanguageTextAndFile) {
  const auto blocks =
      code_blocks("Save it as `beam.cpp`:\n\n```cpp\nint main() {}\n```\n\n```sh\ntrue\n```\n```text\n");
  ASSERT_EQ(blocks.size(), 2u);
  EXPECT_EQ(blocks[0].language + blocks[0].file + blocks[0].text, "cppbeam.cppint main() {}\n");
  EXPECT_EQ(blocks[0].line, 3u);
  EXPECT_EQ(blocks[1].text, "true\n");
}

}  // namespace
}  // namespace lucerna::test
