// SPDX-License-Identifier: Apache-2.0
// The report as a user makes it.
#include <gtest/gtest.h>

#include "lucerna/core/file.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::slurp;

constexpr const char* kProject =
    "[[source]]\nkind = 'disk'\n[[reflector]]\nfamily = 'revolution'\npreset = 'parabola'\nfocal_mm = 15\n"
    "diameter_mm = 60\nposition_mm = [0, 0, 15]\naxis = '-z'\n";

TEST(ReportCli, SameFileNowAndLater) {
  const test::TempDir dir;
  write_file(dir / "p.toml", kProject);
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --rays 2e4 --report 'a b.html'");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto later = run_lucerna(dir.path(), "report out -o later.html");
  ASSERT_EQ(later.exit_code, 0) << later.err;
  const std::string html = slurp(dir / "a b.html");
  EXPECT_EQ(html, slurp(dir / "later.html"));
  EXPECT_NE(html.find("lucerna trace p.toml -o out --rays 2e4 --report 'a b.html'"), std::string::npos);
}

TEST(ReportCli, FolderWithoutATraceIsBadInput) {
  const test::TempDir dir;
  const auto run = run_lucerna(dir.path(), "report . -o r.html");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("result.json"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(dir / "r.html"));
}

}  // namespace
}  // namespace lucerna
