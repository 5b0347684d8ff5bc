// SPDX-License-Identifier: Apache-2.0
// What the commands print with --json, against the table that the reference page is made from. Traces and
// designs: results/json/result_fields_test.cpp.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"
#include "lucerna/results/json/result_fields.h"
#include "tests/support/paths.h"
#include "tests/support/result_paths.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::TempDir;

/// What commands print with --json, and which fields of the table none of them has had.
class JsonFieldsCli : public testing::Test {
 protected:
  JsonFieldsCli() {
    for (const ResultField& f : command_fields()) unseen_[f.of].insert(f.path);
  }
  void run(const std::string& arguments) {
    const auto done = run_lucerna(dir.path(), arguments);
    ASSERT_EQ(done.exit_code, 0) << arguments << '\n' << done.err;
  }
  /// Every field that `command` prints is in the table.
  void expect_known(const std::string& command, const std::string& arguments, int exit_code = 0) {
    const auto done = run_lucerna(dir.path(), command + " " + arguments + " --json");
    ASSERT_EQ(done.exit_code, exit_code) << arguments << '\n' << done.err;
    const auto of = unseen_.find(command);
    ASSERT_NE(of, unseen_.end());
    EXPECT_EQ(test::unknown_paths(nlohmann::ordered_json::parse(done.out), {"both", of->first}, of->second),
              std::set<std::string>{})
        << command << ' ' << arguments;
  }
  /// Every field of the table has been printed, but for `others`.
  void expect_all_seen(std::string_view command, const std::set<std::string_view>& others = {}) {
    EXPECT_EQ(unseen_[command], others) << command;
  }
  TempDir dir;

 private:
  std::map<std::string_view, std::set<std::string_view>> unseen_;
};

TEST_F(JsonFieldsCli, Info) {
  run("make-source disk -n 5000 --surface sphere --surface-mm 3 -o disk.tm25ray");
  run("make-source cylinder --flux-w 2 -n 10000 -o rod.tm25ray");
  run("compress disk.tm25ray -o disk.nfl --held-out 0");
  run("compress rod.tm25ray -o rod.nfl --held-out 0");
  run("compress disk.tm25ray --method clusters -o clusters.nfl --held-out 0");
  write_file(dir / "lamp.toml", "[[source]]\nkind = \"disk\"\n");
  run("trace lamp.toml -o lamp --rays 5000");
  // A file of lines names no unit; a comma for a point is repaired.
  write_file(dir / "rays.txt", "0 0 0 0 0 1 1\n1 0 0 0 0 1 1\n0 1 0 0 0 1 1\n");
  expect_known("info", "rays.txt --format text");
  expect_known("info", "disk.tm25ray rod.tm25ray disk.nfl rod.nfl clusters.nfl");
  RaySet coloured = read_ray_set(dir / "disk.tm25ray");
  coloured.header.wavelength_nm = 550.0F;
  write_ray_set(dir / "line.tm25ray", coloured, "tm25");
  coloured.header.wavelength_nm.reset();
  coloured.header.spectra = {{{440.0F, 460.0F}, {1.0F, 1.0F}}};
  write_ray_set(dir / "blue.tm25ray", coloured, "tm25");
  run("compress line.tm25ray -o line.nfl --held-out 0");
  run("compress blue.tm25ray -o blue.nfl --held-out 0");
  expect_known("info", "line.nfl blue.nfl");
  expect_known("info", "lamp/far-field.ldt lamp/far-field.ies");
  write_file(dir / "made.agf", "NM A 1 0 1.5\nCD 2.25 0 0 0 0 0\nLD 0.4 0.7\nNM B 1\nLD 0.4 0.7\n");
  expect_known("info", "made.agf");
  expect_known("info", (test::source_dir() / "fuzz/corpus/bsdf/plane.bsdf").string());
  // Supports that these sources do not have.
  expect_all_seen("info", {"files[].chosen[].size_mm", "files[].chosen[].twist_rad_per_mm"});
}

TEST_F(JsonFieldsCli, CheckAndCompress) {
  run("make-source disk -n 2000 -o disk.tm25ray");
  run("make-source disk -n 2000 --flux-w 2 -o watts.tm25ray");
  expect_known("compress", "disk.tm25ray -o disk.nfl");
  expect_known("compress", "watts.tm25ray -o watts.nfl");
  write_file(dir / "broken.ies", "IESNA:LM-63-2002\n");
  expect_known("check", ".", 1);
  expect_all_seen("check");
  expect_all_seen("compress");
}

TEST_F(JsonFieldsCli, Compare) {
  run("make-source disk -n 20000 --seed 1 -o a.tm25ray");
  run("make-source disk -n 20000 --seed 2 -o b.tm25ray");
  expect_known("compare", "a.tm25ray b.tm25ray -o pictures --cells-um 300");
  write_file(dir / "lamp.toml", "[[source]]\nkind = \"disk\"\n");
  run("trace lamp.toml -o a --rays 5000 --seed 1");
  run("trace lamp.toml -o b --rays 5000 --seed 2");
  expect_known("compare", "a b");
  expect_all_seen("compare");
}

TEST_F(JsonFieldsCli, Bench) {
  expect_known("bench", "--rays 1000 --cells 8 --device cpu");
  const bool with_embree =
      test::has(run_lucerna(dir.path(), "bench --rays 1000 --cells 8 --json").out, "\"ratio\"");
  if (with_embree) {
    expect_all_seen("bench");
  } else {
    expect_all_seen(
        "bench", {"results[].embree.rays_per_cpu_s", "results[].embree.build_ms", "results[].embree.ratio"});
  }
}

}  // namespace
}  // namespace lucerna
