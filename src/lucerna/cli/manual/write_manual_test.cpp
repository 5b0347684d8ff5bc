// SPDX-License-Identifier: Apache-2.0
// The program that writes what is installed beside the program.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "lucerna/cli/manual/bash_completion.h"
#include "lucerna/cli/manual/manual_pages.h"
#include "tests/support/run_program.h"

namespace lucerna::cli {
namespace {

int written_with(const std::string& arguments) {
  const int status = std::system(("'" LUCERNA_MANUAL_PROGRAM "' " + arguments + " 2>/dev/null").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(WriteManualCli, EveryPageAndTheCompletionAreInTheFolder) {
  const test::TempDir dir;
  ASSERT_EQ(written_with("'" + (dir / "share/doc").string() + "'"), 0);
  const auto pages = manual_pages();
  ASSERT_GT(pages.size(), 5U);
  for (const ManualPage& page : pages)
    EXPECT_EQ(test::slurp(dir / "share/doc/man1" / page.name), page.text) << page.name;
  EXPECT_EQ(test::slurp(dir / "share/doc/lucerna.bash"), bash_completion());
}

TEST(WriteManualCli, WhatCannotBeWrittenIsAnExitCode) {
  EXPECT_EQ(written_with(""), 2);
  EXPECT_EQ(written_with("one two"), 2);
  EXPECT_EQ(written_with("/dev/null/folder"), 1);
}

}  // namespace
}  // namespace lucerna::cli
