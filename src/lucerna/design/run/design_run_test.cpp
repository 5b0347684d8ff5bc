// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/design_run.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string_view>

#include "lucerna/cad.h"
#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

/// A spot of 20 degrees at half its peak, from a disk in a mirror of revolution.
class DesignRuns : public testing::Test {
 protected:
  DesignRuns() {
    PhotometricFile target{uniform_distribution(360.0, 1.0), {}};
    for (std::size_t g = 0; g < target.distribution.gamma_deg.size(); ++g) {
      const double gamma = target.distribution.gamma_deg[g] / 10.0;
      target.distribution.at(0, g) = gamma < 4.0 ? 1000.0 * std::exp2(-gamma * gamma) : 0.0;
    }
    write_photometric_file(dir_ / "spot.ldt", target, PhotometricFormat::ldt);
    write_file(dir_ / "lamp.toml", R"([[source]]
kind = "disk"
radius_mm = 1.0
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 8.0
diameter_mm = 60.0
position_mm = [0, 0, 8]
axis = "-z"
[target]
file = "spot.ldt"
[design]
time_s = 3
)");
  }
  test::TempDir dir_;
};

TEST_F(DesignRuns, GiveTheMirrorItsErrorAndItsLight) {
  DesignSettings settings;
  settings.max_rays = std::uint64_t{1} << 16;
  settings.tolerances = true;
  write_file(dir_ / "lamp.toml",
             read_file(dir_ / "lamp.toml", 10'000) + "[design.tolerances]\nsamples = 2\nrays = 20000\n");
  const DesignedMirror mirror = design(dir_ / "lamp.toml", settings);
  EXPECT_LT(mirror.error.c48.excess, 0.2 * mirror.start_error.c48.excess);
  EXPECT_GE(mirror.error.c48.excess + 3.0 * mirror.error.c48.standard_error, mirror.bound.error);
  ASSERT_FALSE(mirror.light.far_fields.empty());
  // The validation's mesh and the trace's exact surface send the same light out.
  const Estimate traced = mirror.light.far_fields.front().metrics.flux;
  const double flux = mirror.light.ledger.emitted;
  EXPECT_NEAR(traced.mean / flux, mirror.efficiency.mean,
              5.0 * std::hypot(traced.standard_error / flux, mirror.efficiency.standard_error) + 1e-3);
  ASSERT_TRUE(mirror.tolerances.has_value());
  EXPECT_EQ(mirror.tolerances->cases.front().name, "nominal");
  EXPECT_FALSE(cad_mesh(mirror.reflector).triangles.empty());
}

/// Asks to stop once a phase has begun.
class StopIn final : public Progress {
 public:
  explicit StopIn(std::string_view phase) : phase_(phase) {}
  void update(std::string_view phase, std::uint64_t, std::uint64_t) override {
    if (phase == phase_) begun_ = true;
  }
  bool stop_requested() const override { return begun_; }

 private:
  std::string_view phase_;
  std::atomic<bool> begun_ = false;
};

// What follows a search can be stopped without the loss of what was found.
TEST_F(DesignRuns, StoppedAfterTheSearchTheyHaveTheirResult) {
  DesignSettings settings;
  settings.max_rays = std::uint64_t{1} << 14;
  settings.tolerances = true;
  StopIn stop("tolerances");
  const DesignedMirror mirror = design(dir_ / "lamp.toml", settings, stop);
  EXPECT_EQ(mirror.end, DesignTermination::interrupted);
  EXPECT_FALSE(mirror.tolerances);
  EXPECT_LT(mirror.error.c48.excess, 0.5 * mirror.start_error.c48.excess);
  EXPECT_FALSE(cad_mesh(mirror.reflector).triangles.empty());
  EXPECT_FALSE(mirror.light.far_fields.empty());
}

TEST(UnlessStopped, LeavesOutWhatWasStoppedAndWhatFollows) {
  DesignResult result(DesignShape::bspline(12, Aperture::circle(80), 4, 4));
  int computed = 0;
  unless_stopped({}, result, "one", [&] { ++computed; });
  EXPECT_NE(result.end, DesignTermination::interrupted);
  unless_stopped({}, result, "two", [] { throw Interrupted(); });
  EXPECT_EQ(result.end, DesignTermination::interrupted);
  unless_stopped({}, result, "three", [&] { ++computed; });
  EXPECT_EQ(computed, 1);
  EXPECT_EQ(result.remarks, (std::vector<std::string>{"left out, for the design was stopped before: two",
                                                      "left out, for the design was stopped before: three"}));
  DesignResult other(result.shape);
  EXPECT_THROW(unless_stopped({}, other, "four", [] { throw InputError("other"); }), InputError);
}

TEST_F(DesignRuns, AreWatchedAndGoOnToTheSameBits) {
  DesignSettings settings;
  settings.max_rays = std::uint64_t{1} << 14;
  settings.time_s = 1e6;
  const Project project = parse_project(
      "[[source]]\nkind = 'disk'\n[[reflector]]\nfamily = 'revolution'\npreset = 'parabola'\nfocal_mm = 8\n"
      "diameter_mm = 60\nposition_mm = [0, 0, 8]\naxis = '-z'\n[target]\nfile = 'spot.ldt'\n"
      "[design]\nrestarts = 0\n",
      dir_ / "lamp");
  std::vector<std::string> checkpoints;
  int evaluations = 0;
  const DesignedMirror whole = design(project, "lamp", settings, no_progress(),
                                      [&](const DesignStep& step, const std::string& checkpoint) {
                                        EXPECT_GE(step.evaluations, evaluations);
                                        evaluations = step.evaluations;
                                        checkpoints.push_back(checkpoint);
                                      });
  ASSERT_GT(checkpoints.size(), 2u);
  EXPECT_EQ(whole.history.size(), checkpoints.size());
  settings.checkpoint = checkpoints[checkpoints.size() / 2];
  const DesignedMirror resumed = design(project, "lamp", settings);
  EXPECT_EQ(resumed.project_text, whole.project_text);
  EXPECT_LT(resumed.history.size(), whole.history.size());
  settings.seed = 2;
  EXPECT_THROW(design(project, "lamp", settings), InputError) << "a checkpoint of another problem";
  settings.seed = DesignSettings().seed;
  PhotometricFile target = read_photometric_file(dir_ / "spot.ldt");
  for (double& cd : target.distribution.cd) cd *= cd;
  write_photometric_file(dir_ / "spot.ldt", target, PhotometricFormat::ldt);
  EXPECT_THROW(design(project, "lamp", settings), InputError) << "the same name, another target";
}

TEST_F(DesignRuns, LeaveAProjectThatMakesTheSameLight) {
  DesignSettings settings;
  settings.max_rays = std::uint64_t{1} << 16;
  const DesignedMirror mirror = design(dir_ / "lamp.toml", settings);
  write_file(dir_ / "found.toml", mirror.project_text);
  const Project found = read_project(dir_ / "found.toml");
  const TraceResult& had = mirror.traced;
  const TraceResult again = trace(
      found.scene, {.first_ray = had.first_ray, .last_ray = had.last_ray, .seed = had.seed, .device = {}});
  // The text rounds the spline's heights.
  const Ledger a = ledger(had), b = ledger(again);
  EXPECT_NEAR(a.out_reflected.mean, b.out_reflected.mean, 1e-5 * a.emitted);
}

TEST_F(DesignRuns, TraceTheResultAndTryTolerancesOnlyWhereAsked) {
  const DesignProblem problem = design_problem(read_project(dir_ / "lamp.toml"), dir_ / "lamp.toml");
  DesignOptions options;
  options.max_rays = std::uint64_t{1} << 14;
  const DesignRun run = run_design(problem, options);
  EXPECT_FALSE(run.figures.tolerances.has_value());
  EXPECT_GT(run.design_s, 0.0);
  EXPECT_GT(run.trace_s, 0.0);
  EXPECT_TRUE(run.trace.end == NoiseEnd::time || run.trace.noise <= run.noise_goal);
}

}  // namespace
}  // namespace lucerna
