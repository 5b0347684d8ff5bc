// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lucerna/core/io/file.h"
#include "lucerna/error.h"
#include "lucerna/photometric_file.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "lucerna/source_model.h"
#include "lucerna/trace_metrics.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

constexpr const char* kLamp = "[[source]]\nkind = 'disk'\n[[detector]]\nkind = 'far-field'\nname = 'far'\n";

TEST(Report, AFolderIsWrittenAndReported) {
  const test::TempDir dir;
  write_file(dir / "lamp.toml", kLamp);
  const Project project = read_project(dir / "lamp.toml");
  TraceOptions options;
  options.last_ray = 1 << 16;
  const TraceResult result = trace(project.scene, options);
  const auto names = write_trace(dir / "new/folder", project, result);
  EXPECT_THAT(names, testing::IsSupersetOf({"result.json", "project.toml", "far.ldt", "trace.sums"}));
  const PhotometricFile ldt = read_photometric_file(dir / "new/folder/far.ldt");
  EXPECT_NEAR(total_flux(ldt.distribution), ledger(result).out_direct.mean, 1e-4 * 1000.0);
  write_report(dir / "new/folder", dir / "report.html");
  EXPECT_THAT(read_file(dir / "report.html", 1 << 26), testing::HasSubstr("<html"));
}

TEST(Report, AModelIsReportedAgainstItsRays) {
  const test::TempDir dir;
  RaySet set;
  set.header.set_flux(100.0);
  set.rays.resize(20'000);
  make_emitter({.kind = EmitterKind::disk})->emit(Sequence(SequenceKind::random, 1), 0, set.rays);
  write_ray_set(dir / "d.tm25ray", set, "tm25");
  save_source_model(dir / "d.nfl", *compress(set));
  write_report(dir / "d.nfl", dir / "alone.html");
  write_report(dir / "d.nfl", dir / "compared.html", {dir / "d.tm25ray"});
  const std::string compared = read_file(dir / "compared.html", 1 << 26);
  EXPECT_THAT(compared, testing::HasSubstr("/views/far/excess"));
  EXPECT_THAT(compared, testing::HasSubstr("d.tm25ray"));
  EXPECT_THAT(read_file(dir / "alone.html", 1 << 26), testing::Not(testing::HasSubstr("/views/far/excess")));
  EXPECT_THROW(write_report(dir.path(), dir / "r.html", {dir / "d.tm25ray"}), UsageError);
}

TEST(Report, ADesignsFolderIsWrittenAndReported) {
  const test::TempDir dir;
  ProjectMemory memory;
  auto target = std::make_shared<IntensityDistribution>(uniform_distribution(360.0, 5.0));
  for (std::size_t g = 0; g < 8; ++g) target->at(0, g) = 100.0;
  memory.targets["wide"] = target;
  const Project project = parse_project(
      "[[source]]\nkind = 'disk'\n[[reflector]]\nfamily = 'revolution'\npreset = 'parabola'\nfocal_mm = 8\n"
      "diameter_mm = 60\nposition_mm = [0, 0, 8]\naxis = '-z'\n[target]\nfile = 'wide'\n",
      dir / "lamp", memory);
  DesignSettings settings;
  settings.max_rays = std::uint64_t{1} << 14;
  settings.time_s = 1.0;
  const DesignedMirror mirror = design(project, "lamp", settings);
  const auto names = write_design(dir / "folder", mirror);
  EXPECT_THAT(names, testing::IsSupersetOf({"result.json", "reflector.step", "history.csv", "checkpoint"}));
  EXPECT_TRUE(std::filesystem::exists(dir / "folder/wide.ldt")) << "what was in memory";
  write_report(dir / "folder", dir / "report.html");
  EXPECT_THAT(read_file(dir / "report.html", 1 << 26), testing::HasSubstr("<html"));
}

TEST(Report, RefusesWhatIsNoFolderOfATrace) {
  const test::TempDir dir;
  write_file(dir / "lamp.toml", kLamp);
  EXPECT_THROW(write_report(dir / "lamp.toml", dir / "r.html"), InputError);
  EXPECT_THROW(write_report(dir.path(), dir / "r.html"), InputError);
  const Project project = read_project(dir / "lamp.toml");
  TraceOptions options;
  options.last_ray = 1024;
  EXPECT_THROW(write_trace(dir / "lamp.toml/folder", project, trace(project.scene, options)), InputError);
}

}  // namespace
}  // namespace lucerna
