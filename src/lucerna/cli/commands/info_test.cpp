// SPDX-License-Identifier: Apache-2.0
// `lucerna info`: one entry a file, of every kind that it reads.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::has;
using test::run_lucerna;
using Json = nlohmann::json;

/// A ray file, its model and a photometric file.
class InfoFilesCli : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 5000 -o s.tm25ray").exit_code, 0);
    ASSERT_EQ(run_lucerna(dir.path(), "compress s.tm25ray -o s.nfl --held-out 0").exit_code, 0);
    IntensityDistribution even = uniform_distribution(30.0, 10.0);
    std::fill(even.cd.begin(), even.cd.end(), 10.0);
    write_file(dir / "s.ldt", ldt_text({even, {}}));
  }
  test::TempDir dir;
};

TEST_F(InfoFilesCli, HasAnEntryForEachFileInOrder) {
  const auto run = run_lucerna(dir.path(), "info s.nfl s.tm25ray s.ldt --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json result = Json::parse(run.out);
  ASSERT_EQ(result["files"].size(), 3u);
  EXPECT_EQ(result["files"][0]["format"], "nfl");
  EXPECT_EQ(result["files"][0]["method"], "adaptive");
  EXPECT_EQ(result["files"][1]["format"], "tm25");
  EXPECT_EQ(result["files"][1]["rays"], 5000);
  EXPECT_NEAR(result["files"][2]["flux_lm"].get<double>(), 125.66, 0.1);  // 4 pi 10
  ASSERT_EQ(result["inputs"].size(), 3u);
  EXPECT_EQ(result["inputs"][1]["path"], "s.tm25ray");
  EXPECT_TRUE(result["seed"].is_null());
}

TEST_F(InfoFilesCli, PrintsLinesUnderEachName) {
  const auto run = run_lucerna(dir.path(), "info s.tm25ray s.nfl");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out.find("s.tm25ray\n  format              tm25"), 0u) << run.out;
  EXPECT_TRUE(has(run.out, "\ns.nfl\n  ")) << run.out;
  EXPECT_TRUE(has(run.out, "  rays                5000, all of equal flux\n")) << run.out;
}

TEST_F(InfoFilesCli, ListsTheGlassesOfACatalogue) {
  write_file(dir / "made.agf",
             "NM CLEAR 1 0 1.5\nCD 2.25 0 0 0 0 0\nLD 0.4 0.7\nIT 0.5 0.9 10\nNM BROKEN 1\nLD 0.4 0.7\n");
  const auto run = run_lucerna(dir.path(), "info made.agf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "agf, 2 glasses")) << run.out;
  EXPECT_TRUE(has(run.out, "CLEAR               index 1.50000  400 to 700 nm, formula 1; transmittance 500"))
      << run.out;
  EXPECT_TRUE(has(run.out, "warning: BROKEN: made.agf: line 6: found 0 coefficients")) << run.out;
  EXPECT_EQ(run_lucerna(dir.path(), "info made.agf --strict").exit_code, 1);
}

TEST_F(InfoFilesCli, AWarningIsAnErrorWhenStrict) {
  // A file of lines names no unit: lm is assumed, with a warning.
  write_file(dir / "s.txt", "0 0 0 0 0 1 1\n1 0 0 0 0 1 1\n0 1 0 0 0 1 1\n");
  const auto plain = run_lucerna(dir.path(), "info s.txt --format text");
  EXPECT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_TRUE(has(plain.out, "  warning: ")) << plain.out;
  const auto strict = run_lucerna(dir.path(), "info s.txt --format text --strict");
  EXPECT_EQ(strict.exit_code, 1);
  EXPECT_TRUE(has(strict.err, "s.txt: ")) << strict.err;
}

TEST_F(InfoFilesCli, ABadFileDoesNotHideTheOthers) {
  write_file(dir / "note.md", "no light here\n");
  const auto run = run_lucerna(dir.path(), "info note.md s.nfl missing s.ldt");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_TRUE(has(run.out, "s.nfl\n  ")) << run.out;
  EXPECT_TRUE(has(run.out, "\ns.ldt\n  ")) << run.out;
  EXPECT_TRUE(has(run.err, "note.md")) << run.err;
  EXPECT_TRUE(has(run.err, "missing")) << run.err;
  const auto json = run_lucerna(dir.path(), "info note.md s.nfl --json");
  EXPECT_EQ(json.exit_code, 1);
  EXPECT_EQ(Json::parse(json.out)["files"].size(), 1u);
}

TEST_F(InfoFilesCli, RefusesWhatItCannotRead) {
  write_file(dir / "note.md", "no light here\n");
  for (const char* name : {"note.md", "missing"}) {
    const auto run = run_lucerna(dir.path(), std::string("info ") + name);
    EXPECT_EQ(run.exit_code, 1) << name;
    EXPECT_TRUE(has(run.err, name)) << run.err;
  }
  write_file(dir / "cut.LDT", "A company\n1\n1\n");
  const auto cut = run_lucerna(dir.path(), "info cut.LDT");
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_TRUE(has(cut.err, "cut.LDT: line 3: 3 lines, a EULUMDAT file has more than 26")) << cut.err;
  EXPECT_EQ(run_lucerna(dir.path(), "info s.tm25ray --format floppy").exit_code, 2);
  EXPECT_EQ(run_lucerna(dir.path(), "info s.tm25ray --format speos").exit_code, 1) << "it is no SPEOS file";
}

}  // namespace
}  // namespace lucerna
