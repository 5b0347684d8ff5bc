// SPDX-License-Identifier: Apache-2.0
// Ranges of rays, traced apart as a job array does, and added.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "lucerna/results/folders/trace_file.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

using Json = nlohmann::json;
using test::run_lucerna;
using test::slurp;

constexpr const char* kMergeProject =
    "[[source]]\nkind = 'cylinder'\n[[source]]\nfile = 's.tm25ray'\nflux_lm = 300\n[[reflector]]\n"
    "family = 'revolution'\npreset = 'parabola'\nfocal_mm = 15\ndiameter_mm = 60\nposition_mm = [0, 0, 15]\n"
    "axis = '-z'\nslope_error_mrad = 3\n[[detector]]\nkind = 'far-field'\nc_step_deg = 30\n[[detector]]\n"
    "kind = 'plane'\nposition_mm = [0, 0, -900]\n[[detector]]\nkind = 'luminance'\nfrom = "
    "'-z'\n[[detector]]\n"
    "kind = 'rays'\n";

class MergeCli : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 20000 -o s.tm25ray").exit_code, 0);
    write_file(dir / "p.toml", kMergeProject);
  }
  void trace(const std::string& rays, const std::string& out, const std::string& more = "") {
    const auto run = run_lucerna(dir.path(), "trace p.toml --rays " + rays + " -o " + out + " " + more);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  void refuse(const std::string& folders, const std::string& part) {
    const auto run = run_lucerna(dir.path(), "merge " + folders + " -o sum");
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
    EXPECT_FALSE(std::filesystem::exists(dir / "sum"));
  }
  test::TempDir dir;
};

TEST_F(MergeCli, ShardsAddToTheBitsOfOneMachine) {
  trace("60000", "whole");
  trace("0:12345", "a", "--threads 1");
  trace("12345:40000", "b", "--threads 2");
  trace("40000:60000", "c");
  const auto run = run_lucerna(dir.path(), "merge c a b -o sum --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* name : {"far-field.ldt", "far-field.ies", "far-field.csv", "far-field.svg", "plane.csv",
                           "plane.png", "luminance.csv", "rays.tm25ray", "project.toml", "trace.sums"}) {
    const std::string sum = slurp(dir / "sum" / name);
    EXPECT_GT(sum.size(), 100u) << name;
    EXPECT_TRUE(sum == slurp(dir / "whole" / name)) << name << " differs";
  }
  const Json sum = Json::parse(slurp(dir / "sum" / "result.json"));
  const Json whole = Json::parse(slurp(dir / "whole" / "result.json"));
  EXPECT_EQ(sum, Json::parse(run.out));
  for (const char* key : {"ledger", "detectors", "rays", "seed", "isa", "sequence"})
    EXPECT_EQ(sum[key], whole[key]) << key;
  EXPECT_EQ(sum["inputs"].size(), 3u);
  EXPECT_NE(slurp(dir / "a" / "plane.csv"), slurp(dir / "whole" / "plane.csv"));
  // A sum is a trace: it can be added to, and reported.
  trace("60000:61000", "d");
  EXPECT_EQ(run_lucerna(dir.path(), "merge sum d -o more").exit_code, 0);
  EXPECT_EQ(run_lucerna(dir.path(), "report more -o r.html").exit_code, 0);
}

TEST_F(MergeCli, SaysWhatDoesNotFit) {
  trace("0:1000", "a");
  trace("1000:2000", "b");
  trace("3000:4000", "d");
  trace("500:1500", "e");
  trace("1000:2000", "seed", "--seed 2");
  trace("1000:2000", "random", "--sequence random");
  refuse("a b d", "rays 2000:3000 are missing between b and d");
  refuse("a e", "rays 500:1000 are in both a and e");
  refuse("a a", "rays 0:1000 are in both");
  refuse("a e d", "rays 500:1000 are in both a and e; rays 1500:3000 are missing between e and d");
  refuse("a seed", "one has seed 1 and sequence sobol, the other seed 2");
  refuse("a random", "one has seed 1 and sequence sobol, the other seed 1 and sequence random");
  refuse("a none", "none: holds no trace.sums");
  StoredTrace other = read_trace_file(dir / "b" / kTraceFileName);
  other.result.isa = "abacus";
  std::filesystem::create_directory(dir / "isa");
  write_trace_file(dir / "isa" / kTraceFileName, other.result, other.origin);
  refuse("a isa", "isa with abacus: they cannot be added to the bit");
  write_file(dir / "p.toml", std::string(kMergeProject) + "name = 'other'\n");
  trace("1000:2000", "named");
  refuse("a named", "a and named are traces of different projects");
  // The same words, but other rays in the file.
  write_file(dir / "p.toml", kMergeProject);
  ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 20000 --seed 9 -o s.tm25ray").exit_code, 0);
  trace("1000:2000", "changed");
  refuse("a changed", "different input files");
  const auto gap = run_lucerna(dir.path(), "merge b -o only");
  EXPECT_EQ(gap.exit_code, 0);
  EXPECT_NE(gap.err.find("rays 0:1000 are not in it"), std::string::npos);
  write_file(dir / "d" / kTraceFileName, "LUCTRACE");
  refuse("a d", "no trace of Lucerna's");
}

TEST_F(MergeCli, TheSameProjectElsewhereIsTheSameScene) {
  trace("0:1000", "a");
  std::filesystem::create_directory(dir / "elsewhere");
  for (const char* name : {"p.toml", "s.tm25ray"})
    std::filesystem::copy_file(dir / name, dir / "elsewhere" / name);
  const auto run = run_lucerna(dir / "elsewhere", "trace p.toml --rays 1000:2000 -o ../b");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run_lucerna(dir.path(), "merge a b -o sum").exit_code, 0);
}

}  // namespace
}  // namespace lucerna
