// SPDX-License-Identifier: Apache-2.0
// `lucerna check`: every fault with its place, the counts, and the exit code.
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

/// A folder of good files: in it s.tm25ray and s.nfl, and below it sub/s.ldt.
class CheckCli : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(dir / "good/sub");
    ASSERT_EQ(run_lucerna(dir / "good", "make-source disk -n 5000 -o s.tm25ray").exit_code, 0);
    ASSERT_EQ(run_lucerna(dir / "good", "compress s.tm25ray -o s.nfl --held-out 0").exit_code, 0);
    IntensityDistribution even = uniform_distribution(30.0, 10.0);
    std::fill(even.cd.begin(), even.cd.end(), 10.0);
    PhotometricFile file{even, {}};
    file.luminaire.name = "test";
    write_file(dir / "good/sub/s.ldt", ldt_text(file));
  }
  test::TempDir dir;
};

TEST_F(CheckCli, AFolderIsItsFilesByName) {
  const auto run = run_lucerna(dir.path(), "check good");
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_EQ(run.out,
            "good/s.nfl: ok\ngood/s.tm25ray: ok\ngood/sub/s.ldt: ok\n"
            "  note: no size of the luminous area: a point\n"
            "  note: line 27: -1 lamps: absolute photometry, the flux is the luminaire's\n"
            "3 files: 3 ok, 0 with warnings, 0 with errors\n");
}

TEST_F(CheckCli, OfAFolderOnlyFilesOfItsKinds) {
  write_file(dir / "good/project.toml", "[[source]]\n");
  write_file(dir / "good/result.json", "{}\n");
  write_file(dir / "good/cut.nfl", "");  // by its ending: what is damaged is not passed over
  const auto run = run_lucerna(dir.path(), "check good");
  EXPECT_EQ(run.exit_code, 1) << run.out << run.err;
  EXPECT_TRUE(has(run.out, "good/cut.nfl: error\n")) << run.out;
  EXPECT_TRUE(has(run.out, "4 files: 3 ok, 0 with warnings, 1 with errors\n")) << run.out;
  EXPECT_TRUE(has(run.out, "2 other files are no ray files")) << run.out;
  // Given by name, any file is checked.
  EXPECT_EQ(run_lucerna(dir.path(), "check good/result.json").exit_code, 1);
}

TEST_F(CheckCli, GlassesBrdfsAndProjectsHaveFaultsToo) {
  const auto check = [&](const std::string& file, const std::string& text) {
    write_file(dir / file, text);
    return run_lucerna(dir.path(), "check " + file);
  };
  const std::string corpus = test::slurp(test::source_dir() / "fuzz/corpus/bsdf/plane.bsdf");
  EXPECT_EQ(check("even.bsdf", corpus).exit_code, 0);
  const auto cut = check("cut.bsdf", corpus.substr(0, corpus.size() / 2));
  EXPECT_EQ(cut.exit_code, 1);
  EXPECT_TRUE(has(cut.out, "error: cut.bsdf: line ")) << cut.out;
  const auto glasses =
      check("g.agf", "NM A 2 1 1.5 60\nCD 1 0.01 0 0 0 0\nLD 0.4 0.7\nNM B 99 1 1.5 60\nLD 0.4 0.7\n");
  EXPECT_EQ(glasses.exit_code, 0) << glasses.out;
  EXPECT_TRUE(has(glasses.out, "warning: B: ")) << glasses.out;
  EXPECT_EQ(run_lucerna(dir.path(), "check g.agf --strict").exit_code, 1);
  const std::string lamp =
      "[[source]]\nkind = 'disk'\nradius_mm = 1\n[[reflector]]\nfamily = 'revolution'\npreset = 'parabola'\n"
      "focal_mm = 15\ndiameter_mm = 60\n";
  EXPECT_EQ(check("lamp.toml", lamp).exit_code, 0);
  const auto unknown = check("unknown.toml", lamp + "radius = 3\n");
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_TRUE(has(unknown.out, "unknown.toml: line 9: reflector[0].radius")) << unknown.out;
  const auto target = check("target.toml", lamp + "[target]\nfile = 'none.ldt'\n");
  EXPECT_EQ(target.exit_code, 1) << "what a design reads";
  EXPECT_TRUE(has(target.out, "none.ldt")) << target.out;
}

TEST_F(CheckCli, GoesOnAfterABadFileAndCountsIt) {
  const std::string whole = test::slurp(dir / "good/s.tm25ray");
  write_file(dir / "cut.tm25ray", whole.substr(0, 20000));
  std::string flipped = test::slurp(dir / "good/s.nfl");
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x10);
  write_file(dir / "flipped.nfl", flipped);
  const auto run = run_lucerna(dir.path(), "check cut.tm25ray flipped.nfl missing good/s.tm25ray --json");
  EXPECT_EQ(run.exit_code, 1);
  const Json result = Json::parse(run.out);
  EXPECT_EQ(result["ok"], 1);
  EXPECT_EQ(result["with_warnings"], 0);
  EXPECT_EQ(result["with_errors"], 3);
  ASSERT_EQ(result["files"].size(), 4u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(result["files"][i]["errors"], 1) << i;
    EXPECT_EQ(result["files"][i]["faults"][0]["severity"], "error") << i;
  }
  EXPECT_TRUE(has(result["files"][0]["faults"][0]["text"].get<std::string>(), "byte 20000"));
  EXPECT_EQ(result["files"][3]["path"], "good/s.tm25ray");
  EXPECT_TRUE(result["files"][3]["faults"].empty());
}

TEST_F(CheckCli, NamesTheLineOfAPhotometricFault) {
  const std::string whole = test::slurp(dir / "good/sub/s.ldt");
  write_file(dir / "cut.ldt", whole.substr(0, whole.size() / 2));
  const auto run = run_lucerna(dir.path(), "check cut.ldt");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(run.out.find("cut.ldt: error\n"), 0u) << run.out;
  EXPECT_TRUE(has(run.out, "line ")) << run.out;
  EXPECT_TRUE(has(run.out, "1 files: 0 ok, 0 with warnings, 1 with errors\n")) << run.out;
}

TEST_F(CheckCli, AWarningIsAnErrorWhenStrict) {
  // Rays of zero flux are read, but somebody should know.
  ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 0 -o zero.tm25ray").exit_code, 0);
  const auto plain = run_lucerna(dir.path(), "check zero.tm25ray");
  EXPECT_EQ(plain.exit_code, 0) << plain.out;
  EXPECT_EQ(plain.out.find("zero.tm25ray: warning\n  warning: "), 0u) << plain.out;
  const auto strict = run_lucerna(dir.path(), "check zero.tm25ray --strict");
  EXPECT_EQ(strict.exit_code, 1);
  EXPECT_EQ(strict.out.find("zero.tm25ray: error\n"), 0u) << strict.out;
}

}  // namespace
}  // namespace lucerna
