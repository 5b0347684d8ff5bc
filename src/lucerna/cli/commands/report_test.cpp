// SPDX-License-Identifier: Apache-2.0
// The report as a user makes it.
#include <gtest/gtest.h>

#include "lucerna/core/io/file.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::slurp;

constexpr const char* kReportProject =
    "[[source]]\nkind = 'disk'\n[[reflector]]\nfamily = 'revolution'\npreset = 'parabola'\nfocal_mm = 15\n"
    "diameter_mm = 60\nposition_mm = [0, 0, 15]\naxis = '-z'\n";

TEST(ReportCli, SameFileNowAndLater) {
  const test::TempDir dir;
  write_file(dir / "p.toml", kReportProject);
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

TEST(ReportCli, ModelsWithAndWithoutTheirRays) {
  const test::TempDir dir;
  ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 2e4 -o d.tm25ray").exit_code, 0);
  const auto run = run_lucerna(dir.path(), "compress d.tm25ray -o d.nfl --report now.html");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(slurp(dir / "now.html").find("/views/far/excess"), std::string::npos);
  const auto later = run_lucerna(dir.path(), "report d.nfl -o later.html");
  ASSERT_EQ(later.exit_code, 0) << later.err;
  EXPECT_EQ(slurp(dir / "later.html").find("/views/far/excess"), std::string::npos);
  EXPECT_EQ(run_lucerna(dir.path(), "report d.nfl -o r.html --rays gone.tm25ray").exit_code, 1);
}

TEST(ReportCli, OtherFilesAreBadInput) {
  const test::TempDir dir;
  write_file(dir / "x.nfl", "junk");
  const auto run = run_lucerna(dir.path(), "report x.nfl -o r.html");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("x.nfl: is neither a source model"), std::string::npos) << run.err;
  const auto itself = run_lucerna(dir.path(), "report x.nfl -o x.nfl");
  EXPECT_EQ(itself.exit_code, 2);
  EXPECT_NE(itself.err.find("expected the ending .html"), std::string::npos) << itself.err;
  EXPECT_EQ(slurp(dir / "x.nfl"), "junk");
}

TEST(ReportCli, RaysGoWithAModelOnly) {
  const test::TempDir dir;
  const auto run = run_lucerna(dir.path(), "report . -o r.html --rays x.tm25ray");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("--rays goes with a model"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace lucerna
