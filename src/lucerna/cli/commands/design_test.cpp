// SPDX-License-Identifier: Apache-2.0
// `lucerna design` as a user meets it: files, tables, interruptions.
#include "lucerna/design/run/design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "lucerna/core/io/file.h"
#include "lucerna/design/constraints/limit_check.h"
#include "lucerna/design/search/checkpoint.h"
#include "lucerna/photometric_file.h"
#include "lucerna/random.h"
#include "lucerna/trace.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

using test::run_lucerna;
using test::slurp;
using test::TempDir;
using testing::HasSubstr;
using Json = nlohmann::json;

constexpr const char* kScene = R"([[source]]
kind = "disk"
radius_mm = 1.0
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 8
diameter_mm = 60
hole_diameter_mm = 4
position_mm = [0, 0, 8]
axis = "-z"
reflectance = 0.9
[[detector]]
name = "far"
kind = "far-field"
)";

/// A beam of 15 degrees as a EULUMDAT file, and a project that asks for it.
void write_project(const TempDir& dir, const std::string& design = "",
                   const std::string& target = "file = \"spot.ldt\"\n") {
  PhotometricFile spot;
  spot.distribution = uniform_distribution(0.0, 1.0);
  for (std::size_t g = 0; g < spot.distribution.gamma_deg.size(); ++g) {
    const double gamma = spot.distribution.gamma_deg[g];
    spot.distribution.at(0, g) = 1000.0 * std::exp(-gamma * gamma / 200.0);
  }
  write_photometric_file(dir / "spot.ldt", spot, PhotometricFormat::ldt);
  write_file(dir / "p.toml", kScene + ("[target]\n" + target) +
                                 "[design]\nintervals = 3\nrestarts = 1\ntime_s = 1e6\n" + design);
}

constexpr const char* kFast = "design p.toml --rays 8192 -o ";

/// The error of the rays that leave a traced project.
DesignError traced_error(const std::filesystem::path& project_file, const DesignProblem& problem) {
  Project project = read_project(project_file);
  project.scene.ray_detectors.emplace_back();
  TraceOptions options;
  options.seed = 99;
  options.last_ray = 1 << 20;
  const TraceResult traced = trace(project.scene, options);
  const ErrorBoxes boxes(target_rectangle(problem.target));
  std::vector<BoxSums> sums(kReplicates);
  for (BoxSums& r : sums) {
    r.flux.assign(boxes.size(), 0.0);
    r.emitted = (1 << 20) / static_cast<double>(kReplicates);
  }
  std::size_t at = 0;
  for (const OutRun& run : traced.out_runs) {
    for (std::uint32_t k = 0; k < run.rays; ++k, ++at) {
      const std::size_t cell = boxes.cell(traced.out_rays.origin_mm(at), traced.out_rays.direction(at));
      sums[run.block % kReplicates].flux[cell] += static_cast<double>(traced.out_rays.weight[at]);
    }
  }
  double flux = 0.0;
  for (const PlacedSource& s : project.scene.sources) flux += s.total_flux();
  return box_error(boxes, box_target(boxes, problem.target, flux), sums, problem.target.mode);
}

/// Few rays are traced here: in the coarsest boxes an error is seen best.
void expect_error(const Json& json, const DesignError& traced) {
  const double stated = json["error"]["c12"]["excess"], sigma = json["error"]["c12"]["standard_error"];
  EXPECT_NEAR(traced.c12.excess, stated, 5.0 * std::hypot(sigma, traced.c12.standard_error) + 0.003);
}

TEST(DesignCli, LeavesFilesWhoseTraceHasTheStatedError) {
  const TempDir dir;
  write_project(dir, "[design.tolerances]\nsamples = 2\nrays = 20000\n");
  const auto run = run_lucerna(dir.path(), std::string(kFast) + "out --report out.html");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  for (const char* file : {"reflector.toml", "reflector.step", "reflector.stl", "reflector.obj",
                           "reflector.dxf", "reflector.csv", "history.csv", "checkpoint", "tolerances.csv",
                           "result.json", "project.toml", "far.ldt", "far.ies"}) {
    EXPECT_TRUE(std::filesystem::exists(dir / "out" / file)) << file;
    EXPECT_THAT(run.out, HasSubstr(file));
  }
  EXPECT_TRUE(std::filesystem::exists(dir / "out.html"));
  const Json json = Json::parse(slurp(dir / "out" / "result.json"));
  for (const char* key : {"error", "outside", "worst_cell", "in_rectangle", "start", "validation",
                          "bergen_fit", "wasserstein_deg", "peak", "planes", "efficiency", "losses",
                          "tolerances", "ledger", "detectors", "target", "limits", "end"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["end"], "converged");
  const double stated = json["error"]["c12"]["excess"];
  EXPECT_LT(stated, 0.7 * json["start"]["error"]["c12"]["excess"].get<double>());
  const DesignProblem problem = design_problem(read_project(dir / "p.toml"), dir / "p.toml");
  expect_error(json, traced_error(dir / "out" / "reflector.toml", problem));
  // The start's light is nowhere near it: the comparison can tell.
  EXPECT_GT(traced_error(dir / "p.toml", problem).c12.excess, 1.3 * stated);
  const double sum =
      json["efficiency"]["value"].get<double>() + json["losses"]["mirror"]["value"].get<double>() +
      json["losses"]["mirror_back"]["value"].get<double>() + json["losses"]["lost"]["value"].get<double>();
  EXPECT_NEAR(sum, 1.0, 1e-9);
  for (const char* text : {"beam angle C0-C180", "error ", "48 x 48 boxes", "in the target's rectangle",
                           "Bergen fit", "Wasserstein", "losses", "tolerances", "std. dev."}) {
    EXPECT_THAT(run.out, HasSubstr(text));
  }
  const auto traced = run_lucerna(dir.path(), "trace out/reflector.toml -o again --rays 1e5 --json");
  ASSERT_EQ(traced.exit_code, 0) << traced.err;
  const Json ledger = Json::parse(traced.out)["ledger"];
  EXPECT_NEAR((ledger["out_direct"]["value"].get<double>() + ledger["out_reflected"]["value"].get<double>()) /
                  ledger["emitted"].get<double>(),
              json["efficiency"]["value"].get<double>(), 0.003);
}

TEST(DesignCli, LimitsAreHeldInTheExportedStl) {
  const TempDir dir;
  write_project(dir, R"([design.limits]
max_diameter_mm = 60
max_height_mm = 24
max_slope_deg = 58
min_radius_mm = 12
min_hole_diameter_mm = 4
min_efficiency = 0.5
[[design.limits.keep_out]]
kind = "cylinder"
from_mm = [0, 0, 6]
to_mm = [0, 0, 20]
radius_mm = 3
)");
  const auto run = run_lucerna(dir.path(), std::string(kFast) + "out --time 2");  // held whenever it stops
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const DesignProblem problem = design_problem(read_project(dir / "p.toml"), dir / "p.toml");
  const auto checks = check_limits(read_stl(dir / "out" / "reflector.stl"), problem.limits, 0.01, 2.0);
  EXPECT_EQ(checks.size(), 6u);
  for (const LimitCheck& c : checks)
    EXPECT_TRUE(c.held) << c.limit << ": " << c.found.mean << " of " << c.allowed;
  const Json result = Json::parse(slurp(dir / "out" / "result.json"));
  for (const Json& limit : result["limits"]) {
    EXPECT_TRUE(limit["held"].get<bool>()) << limit;
    const auto in_file = std::ranges::find(checks, limit["limit"].get<std::string>(), &LimitCheck::limit);
    if (in_file == checks.end()) continue;  // of the light
    // Single precision of the file matters to curvature.
    EXPECT_NEAR(limit["found"]["value"].get<double>(), in_file->found.mean, 0.01 * in_file->found.mean)
        << limit;
  }
}

TEST(DesignCli, ALimitThatTheLightCannotHoldIsSaidAndExitsWithOne) {
  const TempDir dir;
  // The disk shines past the mirror's rim, whatever its shape.
  write_project(dir, "[design.limits.glare]\nbeyond_deg = 60\nmax_cd_per_klm = 0.001\n");
  const auto run = run_lucerna(dir.path(), std::string(kFast) + "out --time 2");  // whenever it stops
  EXPECT_EQ(run.exit_code, 1) << run.err;
  EXPECT_THAT(run.out, HasSubstr("NOT HELD"));
  EXPECT_THAT(run.out, HasSubstr("glare 0.001 cd/klm beyond 60 deg"));
  EXPECT_THAT(run.out, HasSubstr("light that meets no mirror has"));
  EXPECT_TRUE(std::filesystem::exists(dir / "out" / "reflector.step"));
}

TEST(DesignCli, ARectangleOnTheFloor) {
  const TempDir dir;
  write_file(dir / "e.csv", "1,1\n1,1\n");
  write_project(dir, "",
                "kind = \"plane\"\nfile = \"e.csv\"\nposition_mm = [0, 0, -2000]\nnormal = \"+z\"\nsize_mm = "
                "[900, 900]\n");
  const auto run = run_lucerna(dir.path(), std::string(kFast) + "out");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("uniformity (min / mean)"));
  const Json json = Json::parse(slurp(dir / "out" / "result.json"));
  EXPECT_TRUE(json["bergen_fit"].is_null());
  EXPECT_GT(json["plane"]["mean"]["value"].get<double>(), 0.0);
  EXPECT_TRUE(std::filesystem::exists(dir / "out" / "target.csv"));
  const DesignProblem problem = design_problem(read_project(dir / "p.toml"), dir / "p.toml");
  expect_error(json, traced_error(dir / "out" / "reflector.toml", problem));
}

TEST(DesignCli, CtrlCWritesTheBestSoFar) {
  const TempDir dir;
  write_project(dir);
  // As soon as its first step is in the history.
  const std::string command = "cd '" + dir.path().string() + "' && '" + test::program().string() +
                              "' design p.toml -o out > log 2>&1 & "
                              "while kill -0 $! && ! [ -s '" +
                              (dir / "out/history.csv").string() +
                              "' ]; do sleep 0.02; done; "
                              "pkill -INT -P $! || kill -INT $!; wait $!";
  const int status = std::system(command.c_str());
  const std::string log = slurp(dir / "log");
  ASSERT_TRUE(WIFEXITED(status)) << log;
  ASSERT_EQ(WEXITSTATUS(status), 3) << log;
  EXPECT_THAT(log, HasSubstr("interrupted"));
  EXPECT_EQ(Json::parse(slurp(dir / "out" / "result.json"))["end"], "interrupted");
  EXPECT_EQ(read_project(dir / "out" / "reflector.toml").scene.reflectors.size(), 1u);
}

/// Runs `lucerna design` and kills it after a while; its exit code, or 137.
int killed_run(const std::filesystem::path& folder, const std::string& arguments, double seconds) {
  std::ostringstream command;
  command << "cd '" << folder.string() << "' && timeout -s KILL " << seconds << " '"
          << test::program().string() << "' " << arguments << " > log 2>&1";
  const int status = std::system(command.str().c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Kills a design at random moments, always resuming it, and compares its end with an undisturbed one's.
void expect_kills_do_no_harm(int kills, std::uint64_t seed) {
  const TempDir dir;
  write_project(dir);
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(run_lucerna(dir.path(), std::string(kFast) + "whole").exit_code, 0);
  const double whole_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  int killed = 0;
  for (std::uint64_t run = 0; killed < kills; ++run) {
    // Where the first run was slow, half of these come to their end: this many do not by chance.
    ASSERT_LT(run, 64 + 4 * static_cast<std::uint64_t>(kills)) << "only " << killed << " killed";
    Rng rng(seed, run);
    const int code = killed_run(dir.path(), std::string(kFast) + "out --resume", whole_s * rng.uniform());
    if (code == 0) {  // came to its end before: compare and begin anew
      std::filesystem::remove_all(dir / "out");
      continue;
    }
    ASSERT_EQ(code, 137) << slurp(dir / "log");
    ++killed;
    // Whatever is there is whole.
    if (std::filesystem::exists(dir / "out" / "reflector.toml")) {
      EXPECT_EQ(read_project(dir / "out" / "reflector.toml").scene.reflectors.size(), 1u);
    }
    if (std::filesystem::exists(dir / "out" / "checkpoint")) {
      EXPECT_GT(checkpoint_evaluations(slurp(dir / "out" / "checkpoint")), 0);
    }
    if (std::filesystem::exists(dir / "out" / "result.json")) {
      EXPECT_TRUE(Json::accept(slurp(dir / "out" / "result.json")));
    }
  }
  const auto last = run_lucerna(dir.path(), std::string(kFast) + "out --resume");
  ASSERT_EQ(last.exit_code, 0) << last.err;
  for (const char* file :
       {"checkpoint", "reflector.toml", "history.csv", "reflector.step", "reflector.stl", "far.ldt"}) {
    EXPECT_EQ(slurp(dir / "out" / file), slurp(dir / "whole" / file)) << file;
  }
}

TEST(DesignCli, KilledAndResumedItEndsWhereAnUndisturbedRunEnds) { expect_kills_do_no_harm(3, 1); }

TEST(DesignKillSlow, TwentyRandomMoments) { expect_kills_do_no_harm(20, 2); }

TEST(DesignCli, RefusesInOneLine) {
  const TempDir dir;
  write_project(dir, "[design.limits]\nmax_diameter_mm = 50\n");
  const auto run = run_lucerna(dir.path(), std::string(kFast) + "out");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("design.limits.max_diameter_mm: = 50 contradicts the reflector's aperture"));
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  write_project(dir);
  const auto few = run_lucerna(dir.path(), "design p.toml --rays 8191 -o out");
  EXPECT_EQ(few.exit_code, 1);
  EXPECT_THAT(few.err, HasSubstr("8191 rays of an evaluation asked for, expected at least 8192; see --rays"));
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  std::filesystem::create_directory(dir / "full");
  write_file(dir / "full" / "checkpoint", "lucerna");
  EXPECT_EQ(run_lucerna(dir.path(), std::string(kFast) + "full").exit_code, 1);
  const auto damaged = run_lucerna(dir.path(), std::string(kFast) + "full --resume");
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_THAT(damaged.err, HasSubstr("checkpoint"));
}

}  // namespace
}  // namespace lucerna
