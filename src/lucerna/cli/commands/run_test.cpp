// SPDX-License-Identifier: Apache-2.0
// The program as a user meets it: files, exit codes, messages.
#include "lucerna/cli/commands/run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "tests/support/data_dir.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::slurp;
using test::TempDir;
using Json = nlohmann::json;

constexpr const char* kProject = R"(
[[source]]
file = "s.tm25ray"
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 15.0
diameter_mm = 100.0
position_mm = [0, 0, 15]
axis = "-z"
reflectance = 0.9
)";

using test::has;

std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

std::size_t entries(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

void make_source(const TempDir& dir, const std::string& arguments = "led -n 20000") {
  const auto run = run_lucerna(dir.path(), "make-source " + arguments + " -o s.tm25ray");
  ASSERT_EQ(run.exit_code, 0) << run.err;
}

TEST(ProgramCli, MadeSourceIsWhatInfoSees) {
  const TempDir dir;
  make_source(dir, "disk -n 5e3 --flux-lm 337 --surface sphere --surface-mm 4");
  const auto run = run_lucerna(dir.path(), "info s.tm25ray --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json result = Json::parse(run.out);
  for (const char* key :
       {"program_version", "schema_version", "seed", "threads", "isa", "inputs", "wall_s", "files"}) {
    EXPECT_TRUE(result.contains(key)) << key;
  }
  const Json& file = result["files"][0];
  EXPECT_EQ(file["format"], "tm25");
  EXPECT_EQ(file["rays"], 5000);
  EXPECT_NEAR(file["flux_lm"].get<double>(), 337.0, 1e-4);
  EXPECT_TRUE(file["equal_weights"].get<bool>());
  EXPECT_EQ(file["backwards_share"], 0.0);
  EXPECT_EQ(result["inputs"][0]["sha256"].get<std::string>().size(), 64u);
}

TEST(ProgramCli, ConvertThinsTurnsAndMoves) {
  const TempDir dir;
  make_source(dir, "rectangle --size-mm 4,1 -n 4000");
  ASSERT_EQ(run_lucerna(dir.path(),
                        "convert s.tm25ray t.tm25ray --rays 500 --rotate z:90 --rotate x:180 --move 1,2,3")
                .exit_code,
            0);
  const Json info = Json::parse(run_lucerna(dir.path(), "info t.tm25ray --json").out)["files"][0];
  EXPECT_EQ(info["rays"], 500);
  EXPECT_NEAR(info["flux_lm"].get<double>(), 1000.0, 1e-3);
  EXPECT_NEAR(info["flux_ratio"].get<double>(), 1.0, 1e-5);
  EXPECT_EQ(info["backwards_share"], 1.0);
  const auto low = info["extent_mm"]["min"].get<std::vector<double>>();
  const auto high = info["extent_mm"]["max"].get<std::vector<double>>();
  EXPECT_NEAR(high[0] - low[0], 1.0, 0.05);
  EXPECT_NEAR(high[1] - low[1], 4.0, 0.05);
  EXPECT_NEAR(low[2], 3.0, 1e-6);
  EXPECT_EQ(run_lucerna(dir.path(), "convert s.tm25ray t.tm25ray --rays 5000").exit_code, 1);
  EXPECT_EQ(run_lucerna(dir.path(), "convert s.tm25ray t.tm25ray --rotate q:5").exit_code, 2);
}

TEST(ProgramCli, TraceWritesItsFilesAndItsLedgerCloses) {
  const TempDir dir;
  make_source(dir);
  write_file(dir / "p.toml", kProject);
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* name :
       {"result.json", "project.toml", "far-field.ldt", "far-field.ies", "far-field.csv", "far-field.svg"}) {
    EXPECT_TRUE(std::filesystem::exists(dir / "out" / name)) << name;
  }
  const Json result = Json::parse(run.out);
  EXPECT_EQ(result, Json::parse(slurp(dir / "out" / "result.json")));
  const Json& ledger = result["ledger"];
  double out = 0.0;
  for (const char* part : {"out_direct", "out_reflected", "lost"}) out += ledger[part]["value"].get<double>();
  for (const auto& [cause, flux] : ledger["absorbed"].items()) out += flux["value"].get<double>();
  EXPECT_NEAR(out, 1000.0, 1e-9 * 1000.0);
  EXPECT_EQ(ledger["emitted"], 1000.0);
  EXPECT_GT(ledger["out_reflected"]["value"].get<double>(), 500.0);
  EXPECT_GT(result["detectors"][0]["peak"]["intensity"]["value"].get<double>(), 1000.0);
}

TEST(ProgramCli, AWrittenProjectRunsAgainToTheSameBits) {
  const TempDir dir;
  make_source(dir);
  write_file(dir / "p.toml", kProject);
  ASSERT_EQ(run_lucerna(dir.path(), "trace p.toml -o one --threads 1 --seed 5").exit_code, 0);
  ASSERT_EQ(run_lucerna(dir.path(), "trace one/project.toml -o two --threads 2 --seed 5").exit_code, 0);
  const std::string csv = slurp(dir / "one" / "far-field.csv");
  EXPECT_GT(csv.size(), 1000u);
  EXPECT_EQ(csv, slurp(dir / "two" / "far-field.csv"));
  EXPECT_EQ(slurp(dir / "one" / "far-field.ldt"), slurp(dir / "two" / "far-field.ldt"));
}

TEST(ProgramCli, TwoSourcesAdd) {
  const TempDir dir;
  make_source(dir);
  write_file(dir / "p.toml", std::string(kProject) + "[[source]]\nfile = \"s.tm25ray\"\nflux_lm = 500\n");
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Json::parse(run.out)["ledger"]["emitted"], 1500.0);
}

TEST(ProgramCli, AModelIsMadeSampledComparedAndTraced) {
  const TempDir dir;
  make_source(dir, "disk -n 30000 --surface sphere --surface-mm 3 --flux-lm 200");
  const auto made = run_lucerna(dir.path(), "compress s.tm25ray -o s.nfl --json --method clusters");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json result = Json::parse(made.out);
  EXPECT_EQ(result["method"], "clusters");
  EXPECT_EQ(result["rays"], 30000);
  EXPECT_NEAR(result["flux_lm"].get<double>(), 200.0, 2e-4);
  EXPECT_EQ(result["bytes"], std::filesystem::file_size(dir / "s.nfl"));
  const Json info = Json::parse(run_lucerna(dir.path(), "info s.nfl --json").out)["files"][0];
  EXPECT_EQ(info["format"], "nfl");
  ASSERT_EQ(run_lucerna(dir.path(), "sample s.nfl -n 2e4 -o t.tm25ray --sequence sobol").exit_code, 0);
  EXPECT_EQ(run_lucerna(dir.path(), "sample s.nfl -n 0 -o u.tm25ray").exit_code, 1);
  const auto compared = run_lucerna(dir.path(), "compare s.tm25ray t.tm25ray --json");
  ASSERT_EQ(compared.exit_code, 0) << compared.err;
  const Json views = Json::parse(compared.out)["views"];
  for (const char* view : {"far", "near", "focus", "beam", "four_d"}) {
    for (const char* key : {"error", "floor", "excess", "standard_error", "raw"})
      EXPECT_TRUE(views[view].contains(key));
  }
  EXPECT_LT(views["far"]["excess"].get<double>(), 0.5);
  std::string project = kProject;
  project.replace(project.find("s.tm25ray"), 9, "s.nfl");
  write_file(dir / "p.toml", project);
  const auto traced = run_lucerna(dir.path(), "trace p.toml -o out --rays 2e4 --json");
  ASSERT_EQ(traced.exit_code, 0) << traced.err;
  EXPECT_NEAR(Json::parse(traced.out)["ledger"]["emitted"].get<double>(), 200.0, 1e-3);
}

TEST(ProgramCli, DamagedModelsAreOneClearLine) {
  const TempDir dir;
  make_source(dir, "disk -n 5000");
  ASSERT_EQ(run_lucerna(dir.path(), "compress s.tm25ray -o s.nfl --held-out 0").exit_code, 0);
  const std::string whole = slurp(dir / "s.nfl");
  std::string flipped = whole;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 0x10);
  write_file(dir / "flipped.nfl", flipped);
  write_file(dir / "cut.nfl", whole.substr(0, whole.size() - 9));
  for (const char* name : {"flipped.nfl", "cut.nfl"}) {
    const auto run = run_lucerna(dir.path(), std::string("info ") + name);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_EQ(lines(run.err), 1u) << run.err;
    EXPECT_TRUE(has(run.err, name)) << run.err;
  }
}

TEST(ProgramCli, PhotometricFilesAreDescribedCheckedConvertedAndCompared) {
  const TempDir dir;
  make_source(dir);
  write_file(dir / "p.toml", kProject);
  ASSERT_EQ(run_lucerna(dir.path(), "trace p.toml -o out --rays 2e4").exit_code, 0);
  const Json info = Json::parse(run_lucerna(dir.path(), "info out/far-field.ldt --json").out)["files"][0];
  EXPECT_NEAR(info["flux_lm"].get<double>(), 900.0, 1.0);
  EXPECT_TRUE(has(run_lucerna(dir.path(), "info out/far-field.ldt").out, "(of its grid's maximum)"));
  ASSERT_EQ(run_lucerna(dir.path(), "convert out/far-field.ldt b.ies --to ies-2002").exit_code, 0);
  const Json compared = Json::parse(run_lucerna(dir.path(), "compare out/far-field.ldt b.ies --json").out);
  EXPECT_LT(compared["relative_rms"]["value"].get<double>(), 1e-5);
  EXPECT_NEAR(compared["overlap"]["value"].get<double>(), 1.0, 1e-5);
  // A traced folder brings its noise: two runs of one scene differ by no more than it.
  ASSERT_EQ(run_lucerna(dir.path(), "trace p.toml -o two --rays 16384 --seed 2 --sequence random").exit_code,
            0);
  const Json noisy = Json::parse(run_lucerna(dir.path(), "compare out two --json").out);
  EXPECT_GT(noisy["floor"].get<double>(), 0.01);
  EXPECT_LT(noisy["relative_rms"]["value"].get<double>(), 3.0 * noisy["floor"].get<double>());
  EXPECT_EQ(run_lucerna(dir.path(), "check out/far-field.ldt out/far-field.ies b.ies").exit_code, 0);
  write_file(dir / "bad.ies", slurp(dir / "b.ies").substr(0, 900));
  const auto checked = run_lucerna(dir.path(), "check bad.ies b.ies --json");
  EXPECT_EQ(checked.exit_code, 1);
  EXPECT_EQ(Json::parse(checked.out)["with_errors"], 1);
  EXPECT_EQ(run_lucerna(dir.path(), "compare b.ies s.tm25ray").exit_code, 1);
}

TEST(ProgramCli, InitWritesAProjectThatTraces) {
  const TempDir dir;
  ASSERT_EQ(run_lucerna(dir.path(), "init -o p.toml").exit_code, 0);
  EXPECT_EQ(run_lucerna(dir.path(), "init -o p.toml").exit_code, 1) << "never replaces a file unasked";
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --rays 2e4");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(has(run.out, "beam angle")) << run.out;
}

/// One clear line with `part`, exit 1, and no file but the given number left in the folder.
void expect_refusal(const TempDir& dir, const std::string& arguments, const std::string& part) {
  const std::size_t before = entries(dir.path());
  const auto run = run_lucerna(dir.path(), arguments);
  EXPECT_EQ(run.exit_code, 1) << arguments << '\n' << run.err;
  EXPECT_EQ(lines(run.err), 1u) << run.err;
  EXPECT_TRUE(has(run.err, part)) << run.err;
  EXPECT_EQ(run.out, "") << arguments;
  EXPECT_EQ(entries(dir.path()), before) << arguments;
}

TEST(ProgramCli, BadRayFilesAreOneClearLine) {
  const TempDir dir;
  make_source(dir, "disk -n 100");
  const std::string whole = slurp(dir / "s.tm25ray");
  write_file(dir / "empty.tm25ray", "");
  write_file(dir / "short.tm25ray", whole.substr(0, whole.size() - 5));
  write_file(dir / "other.tm25ray", "this is no ray file at all\n");
  std::string nan = whole;
  for (std::size_t i = 36288; i < nan.size(); ++i) nan[i] = '\xff';
  write_file(dir / "nan.tm25ray", nan);
  expect_refusal(dir, "info empty.tm25ray", "empty.tm25ray");
  expect_refusal(dir, "info short.tm25ray", "short.tm25ray");
  expect_refusal(dir, "info other.tm25ray", "other.tm25ray");
  expect_refusal(dir, "info nan.tm25ray", "nan.tm25ray");
  expect_refusal(dir, "info missing.tm25ray", "missing.tm25ray");
  make_source(dir, "disk -n 0");
  EXPECT_EQ(run_lucerna(dir.path(), "info s.tm25ray").exit_code, 0) << "readers take a set of no rays";
  write_file(dir / "p.toml", kProject);
  expect_refusal(dir, "trace p.toml -o out", "no rays");
}

// The library does not know what the program calls its options, nor which a command has.
TEST(ProgramCli, ErrorsNameTheOptionThatHelpsWhereTheCommandHasIt) {
  const TempDir dir;
  write_file(dir / "rays.txt", "0 0 0 0 0 1 1\n0 0 1 0 0 1 1\n");
  const auto compressed = run_lucerna(dir.path(), "compress rays.txt -o m.nfl");
  EXPECT_EQ(compressed.exit_code, 1);
  EXPECT_TRUE(has(compressed.err, "states no total flux in lm: it has to be given; see --flux\n"))
      << compressed.err;
  write_file(dir / "p.toml", "[[source]]\nfile = \"rays.txt\"\n");
  const auto traced = run_lucerna(dir.path(), "trace p.toml -o out");
  EXPECT_EQ(traced.exit_code, 1);
  EXPECT_FALSE(has(traced.err, "--flux")) << traced.err;
  // But a damaged file can be made whole by another command.
  make_source(dir, "disk -n 100");
  const std::string whole = slurp(dir / "s.tm25ray");
  write_file(dir / "cut.tm25ray", whole.substr(0, whole.size() - 40));
  const auto cut = run_lucerna(dir.path(), "info cut.tm25ray");
  EXPECT_TRUE(has(cut.err, "98 whole rays; see lucerna convert --salvage\n")) << cut.err;
  const auto written = run_lucerna(dir.path(), "make-source disk -n 10 -o s.ray");
  EXPECT_EQ(written.exit_code, 2);
  EXPECT_TRUE(has(written.err, "; see --to\n")) << written.err;
}

TEST(ProgramCli, BadProjectsAreOneClearLine) {
  const TempDir dir;
  make_source(dir, "disk -n 100");
  const auto refuse = [&](const std::string& text, const std::string& part) {
    write_file(dir / "p.toml", text);
    expect_refusal(dir, "trace p.toml -o out", part);
  };
  refuse(std::string(kProject) + "focal_mn = 3\n", "nearest known one is 'focal_mm'");
  refuse(std::string(kProject) + "[[detectors]]\n", "nearest known one is 'detector'");
  refuse("[[source]]\nkind = 'disc'\n", "found 'disc', expected point, disk");
  refuse("[[source]]\nfile = 'none.tm25ray'\n", "none.tm25ray");
  refuse("[[source]]\nfile = 's.tm25ray'\nflux_w = 3\n", "never mixed");
  refuse("[[source]]\nkind = 'disk'\nflux_lm = -3\n", "line 3: source[0].flux_lm: found -3, expected > 0");
  refuse("", "at least one [[source]]");
  refuse("[[source]\n", "line 1");
}

TEST(ProgramCli, FoldersThatHoldFilesAreRefusedUnlessForced) {
  const TempDir dir;
  make_source(dir, "disk -n 100");
  write_file(dir / "p.toml", kProject);
  std::filesystem::create_directory(dir / "out");
  write_file(dir / "out" / "precious", "x");
  expect_refusal(dir, "trace p.toml -o out", "not empty");
  expect_refusal(dir, "trace p.toml -o p.toml", "p.toml");
  EXPECT_EQ(run_lucerna(dir.path(), "trace p.toml -o out --force").exit_code, 0);
  EXPECT_EQ(slurp(dir / "out" / "precious"), "x");
  expect_refusal(dir, "make-source disk -n 10 -o missing/s.tm25ray", "missing/s.tm25ray");
}

TEST(ProgramCli, UsageErrorsExitWithTwo) {
  const TempDir dir;
  for (const char* arguments :
       {"", "nonsense", "info", "make-source disk -n 10", "make-source disk -n ten -o a.tm25ray",
        "make-source torch -n 10 -o a.tm25ray", "make-source disk -n 10 -o a.ray",
        "make-source disk -n 10 -o a.tm25ray --sequence halton"}) {
    EXPECT_EQ(run_lucerna(dir.path(), arguments).exit_code, 2) << arguments;
  }
  EXPECT_EQ(entries(dir.path()), 0u);
  EXPECT_EQ(run_lucerna(dir.path(), "--help").exit_code, 0);
  EXPECT_EQ(run_lucerna(dir.path(), "--version").exit_code, 0);
}

TEST(ProgramCli, UsageErrorsSayWhatWasMeant) {
  const TempDir dir;
  const auto expect = [&](const std::string& arguments, const std::string& text) {
    const auto run = run_lucerna(dir.path(), arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_EQ(run.err, "lucerna: " + text + "\n");
    EXPECT_EQ(run.out, "");
  };
  expect("", "no command; see lucerna --help");
  expect("tracee p.toml -o out", "unknown command \"tracee\"; did you mean trace?; see lucerna --help");
  expect("frobnicate", "unknown command \"frobnicate\"; see lucerna --help");
  expect("trace p.toml -o out --nois 1%",
         "unknown option \"--nois\"; did you mean --noise?; see lucerna trace --help");
  expect("trace p.toml -o out --nois=1%",
         "unknown option \"--nois\"; did you mean --noise?; see lucerna trace --help");
  expect("trace p.toml q.toml -o out", "unexpected argument \"q.toml\"; see lucerna trace --help");
  expect("trace p.toml", "--output is required; see lucerna trace --help");
  expect("trace p.toml -o out --threads 0",
         "--threads: Value 0 not in range 1 to 4096; see lucerna trace --help");
  expect("trace p.toml -o out --rays ten", "--rays: 'ten' is not a whole number (such as 250000 or 1e6)");
  expect("trace p.toml -o out --rays 5:x", "--rays: 'x' is not a whole number (such as 250000 or 1e6)");
  EXPECT_EQ(entries(dir.path()), 0u);
}

TEST(ProgramCli, OptionsThatWouldBeIgnoredAreRefused) {
  const TempDir dir;
  make_source(dir, "disk -n 1000");
  write_file(dir / "p.toml", kProject);
  const std::size_t before = entries(dir.path());
  const auto refuse = [&](const std::string& arguments, const std::string& part) {
    const auto run = run_lucerna(dir.path(), arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments;
    EXPECT_EQ(lines(run.err), 1u) << run.err;
    EXPECT_TRUE(has(run.err, part)) << run.err;
  };
  refuse("trace p.toml -o out --rays 1000 --noise 1%", "--noise excludes --rays");
  refuse("trace p.toml -o out --time 3 --rays 1000", "--time excludes --rays");
  refuse("design p.toml -o out --time 0", "--time 0 is not > 0");
  refuse("compress s.tm25ray -o led.txt", "led.txt: a source model is written, expected the ending .nfl");
  EXPECT_EQ(entries(dir.path()), before);
}

// Half a minute of tracing would be lost otherwise.
TEST(ProgramCli, AReportThatCannotBeWrittenIsFoundBeforeTheWork) {
  const TempDir dir;
  make_source(dir, "disk -n 1000");
  write_file(dir / "p.toml", kProject);
  write_file(dir / "old.html", "old");
  for (const char* work : {"trace p.toml -o out --rays 1000", "compress s.tm25ray -o s.nfl --held-out 0"}) {
    const auto run = run_lucerna(dir.path(), std::string(work) + " --report missing/r.html");
    EXPECT_EQ(run.exit_code, 1) << work;
    EXPECT_EQ(lines(run.err), 1u) << run.err;
    EXPECT_TRUE(has(run.err, "missing/r.html: cannot write")) << run.err;
    EXPECT_EQ(run.out, "");
  }
  EXPECT_FALSE(std::filesystem::exists(dir / "out" / "result.json"));
  EXPECT_FALSE(std::filesystem::exists(dir / "s.nfl"));
  // Nobody may make files there, not even root.
  expect_refusal(dir, "trace p.toml -o /proc --force --rays 1000", "/proc/result.json: cannot write");
  // What is there stays as it is while nothing replaces it.
  EXPECT_EQ(run_lucerna(dir.path(), "compress none.tm25ray -o s.nfl --report old.html").exit_code, 1);
  EXPECT_EQ(slurp(dir / "old.html"), "old");
  EXPECT_EQ(run_lucerna(dir.path(), "trace p.toml -o out --rays 1000 --report out/r.html").exit_code, 0);
  EXPECT_GT(std::filesystem::file_size(dir / "out" / "r.html"), 1000u);
}

// "No ray file of a known format" would hide what the file is.
TEST(ProgramCli, FilesOfOtherKindsAreNamed) {
  const TempDir dir;
  make_source(dir, "disk -n 5000");
  write_file(dir / "p.toml", kProject);
  ASSERT_EQ(run_lucerna(dir.path(), "compress s.tm25ray -o s.nfl --held-out 0").exit_code, 0);
  ASSERT_EQ(run_lucerna(dir.path(), "trace p.toml -o out --rays 2000").exit_code, 0);
  expect_refusal(dir, "compress s.nfl -o t.nfl",
                 "s.nfl: rays expected, this is a source model; lucerna sample");
  expect_refusal(dir, "convert s.nfl t.tm25ray", "this is a source model");
  expect_refusal(dir, "compress out/far-field.ldt -o t.nfl", "this is a light distribution");
  expect_refusal(dir, "compress p.toml -o t.nfl",
                 "this is a project file; lucerna trace, design and check take it");
  expect_refusal(dir, "info p.toml", "this is a project file");
  EXPECT_EQ(run_lucerna(dir.path(), "check p.toml").exit_code, 0);
}

TEST(ProgramData, MeasuredLedHasItsFluxFocusAndBackwardShare) {
  LUCERNA_DATA_FILE(file, "rayfiles/rayfile_LERTDUW_S2WP_green_100k_20161013_IES_TM25.TM25RAY");
  const TempDir dir;
  const auto run = run_lucerna(dir.path(), "info --json '" + file.string() + "'");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const Json info = Json::parse(run.out)["files"][0];
  EXPECT_NEAR(info["flux_lm"].get<double>(), 337.0, 1e-4);
  EXPECT_NEAR(info["backwards_share"].get<double>(), 0.00056, 5e-6);
  const auto focus = info["virtual_focus_mm"].get<std::vector<double>>();
  EXPECT_LT(std::hypot(focus[0] + 0.684, focus[1] - 0.836, focus[2] + 0.449), 0.003);
  write_file(dir / "p.toml", "[[source]]\nfile = \"" + file.string() + "\"\n[[source]]\nfile = \"" +
                                 file.string() + "\"\nposition_mm = [5, 0, 0]\n" +
                                 std::string(kProject).substr(std::string(kProject).find("[[reflector]]")));
  const auto traced = run_lucerna(dir.path(), "trace p.toml -o out --json");
  ASSERT_EQ(traced.exit_code, 0) << traced.err;
  EXPECT_NEAR(Json::parse(traced.out)["ledger"]["emitted"].get<double>(), 674.0, 1e-3);
}

}  // namespace
}  // namespace lucerna
