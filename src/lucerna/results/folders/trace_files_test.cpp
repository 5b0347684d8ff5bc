// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/trace_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"
#include "lucerna/results/folders/trace_folder.h"
#include "lucerna/results/json/trace_json.h"
#include "lucerna/trace.h"
#include "lucerna/version.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::vector<std::string> files_of(const std::string& flux_line) {
  const test::TempDir dir;
  write_file(dir / "p.toml", "[[source]]\nkind = 'disk'\n" + flux_line +
                                 "\n[[detector]]\nkind = 'far-field'\nname = 'far'\n");
  const Project project = read_project(dir / "p.toml");
  TraceOptions options;
  options.last_ray = 16'384;
  const TraceMetrics figures = trace_metrics(trace(project.scene, options));
  const std::string csv = far_field_csv(figures.far_fields[0]);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 72 * 181);
  auto names = write_trace_files(dir.path(), trace_origin(project), figures, {}, trace_json(figures));
  for (const std::string& name : names) EXPECT_GT(std::filesystem::file_size(dir / name), 50u) << name;
  return names;
}

TEST(TraceFiles, AllAreThereAndTheResultComesLast) {
  const auto names = files_of("flux_lm = 20");
  EXPECT_EQ(names, (std::vector<std::string>{"far.ldt", "far.ies", "far.csv", "far.svg", "project.toml",
                                             "result.json"}));
}

TEST(TraceFiles, EveryDetectorHasItsFilesAndCanBeReadBack) {
  const test::TempDir dir;
  write_file(
      dir / "p.toml",
      "[[source]]\nkind = 'disk'\nflux_w = 3\n[[detector]]\nkind = 'plane'\nname = 'roof'\nnormal = '-z'\n"
      "position_mm = [0, 0, 100]\ncells = [4, 3]\nsize_mm = [400, 300]\n[[detector]]\nkind = 'luminance'\n"
      "from_mm = [0, 0, 500]\ncells = [8, 8]\n[[detector]]\nkind = 'rays'\n[[detector]]\nkind = 'rays'\n"
      "name = 'text'\nformat = 'speos'\n");
  const Project project = read_project(dir / "p.toml");
  EXPECT_TRUE(project.scene.far_fields.empty()) << "the project says what it wants to see";
  TraceOptions options;
  options.last_ray = 20'000;
  const TraceResult traced = trace(project.scene, options);
  const TraceMetrics figures = trace_metrics(traced);
  nlohmann::ordered_json json = trace_json(figures);
  json["schema_version"] = kJsonSchemaVersion;
  const auto names = write_trace_files(dir.path(), trace_origin(project), figures, traced.out_rays, json);
  EXPECT_EQ(names, (std::vector<std::string>{"roof.csv", "roof.png", "luminance.csv", "luminance.png",
                                             "rays.tm25ray", "text.ray", "project.toml", "result.json"}));
  const TraceFolder folder = read_trace_folder(dir.path());
  ASSERT_EQ(folder.planes.size(), 2u);
  EXPECT_EQ(folder.planes[0].name, "roof");
  EXPECT_EQ(folder.planes[0].value_unit, "W/m2");
  EXPECT_EQ(folder.planes[0].value.size(), 12u);
  EXPECT_EQ(folder.planes[1].value_unit, "W/(m2 sr)");
  const RaySet rays = read_ray_set(dir / "rays.tm25ray");
  EXPECT_EQ(rays.rays.size(), 20'000u);
  EXPECT_NEAR(*rays.header.flux_w, 3.0, 1e-6);
  double sum = 0.0;
  for (const float w : rays.rays.weight) sum += static_cast<double>(w);
  EXPECT_NEAR(sum, 3.0, 1e-5) << "the rays of the file carry its flux";
  EXPECT_EQ(detect_ray_format(dir / "text.ray"), "speos");
}

TEST(TraceFiles, PicturesStandUprightAndAreLarge) {
  PlaneImage image;
  image.grid = {Frame(), 2.0, 2.0, 2, 2};
  image.value = {0.0, 0.0, 0.0, 5.0};  // bright to the right, above
  const PlanePicture p = plane_picture(image);
  EXPECT_EQ(p.width, 2u * 64u);
  EXPECT_EQ(p.rgb.size(), 3 * p.width * p.height);
  const auto red = [&](std::size_t column, std::size_t row) { return p.rgb[3 * (row * p.width + column)]; };
  EXPECT_EQ(red(p.width - 1, 0), 0xfd);
  EXPECT_EQ(red(0, 0), 0x44);
  EXPECT_EQ(red(p.width - 1, p.height - 1), 0x44);
}

TEST(TraceFiles, WattsHaveNoEulumdat) {
  const auto names = files_of("flux_w = 20");
  EXPECT_EQ(std::count(names.begin(), names.end(), "far.ldt"), 0);
  EXPECT_EQ(std::count(names.begin(), names.end(), "far.ies"), 1);
}

}  // namespace
}  // namespace lucerna
