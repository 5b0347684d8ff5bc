// SPDX-License-Identifier: Apache-2.0
// The exit codes that the program has are those that its pages list.
#include <gtest/gtest.h>

#include <set>

#include "lucerna/cli/manual/cli_reference.h"
#include "lucerna/cli/manual/manual_pages.h"
#include "lucerna/core/io/file.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::TempDir;

/// The digits that follow each `before` in a part of a text.
std::set<int> codes_after(std::string_view text, std::string_view before) {
  std::set<int> codes;
  for (std::size_t i = text.find(before); i != std::string_view::npos; i = text.find(before, i + 1)) {
    const char digit = text.substr(i + before.size(), 1).empty() ? ' ' : text[i + before.size()];
    if (digit >= '0' && digit <= '9') codes.insert(digit - '0');
  }
  return codes;
}

/// Stopped by Ctrl-C after a second.
int interrupted_code(const TempDir& dir) {
  write_file(dir / "lamp.toml", "[[source]]\nkind = \"disk\"\n");
  const std::string command = "cd '" + dir.path().string() + "' && timeout --preserve-status -s INT 1 '" +
                              test::program().string() + "' trace lamp.toml -o out --rays 1e12 >log 2>&1";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

TEST(ExitCodesCli, AreThoseOfThePages) {
  const TempDir dir;
  const std::set<int> found{run_lucerna(dir.path(), "make-source disk -n 10 -o s.tm25ray").exit_code,
                            run_lucerna(dir.path(), "info missing.tm25ray").exit_code,
                            run_lucerna(dir.path(), "info").exit_code, interrupted_code(dir)};
  EXPECT_EQ(found, (std::set<int>{0, 1, 2, 3}));

  const std::string page = cli::cli_reference();
  EXPECT_EQ(codes_after(test::between(page, "## Exit codes", "## ").at(0), "\n| "), found);
  for (const cli::ManualPage& manual : cli::manual_pages())
    EXPECT_EQ(codes_after(test::between(manual.text, ".SH EXIT STATUS", ".SH ").at(0), "\n.B "), found)
        << manual.name;
  const std::string readme = test::slurp(test::source_dir() / "README.md");
  EXPECT_TRUE(
      test::has(readme, "Exit codes: 0 done, 1 bad input or a failed check, 2\nusage, 3 interrupted."));
}

TEST(ExitCodes, CheckSeesWhatIsThere) {
  EXPECT_EQ(codes_after("\n| 0 | done |\n| 2 | usage |\n| code |\n", "\n| "), (std::set<int>{0, 2}));
  EXPECT_EQ(codes_after("none", "\n| "), std::set<int>{});
}

}  // namespace
}  // namespace lucerna
