// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/result_fields.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design_run.h"
#include "lucerna/results/json/design_json.h"
#include "lucerna/results/json/run_json.h"
#include "lucerna/results/json/trace_json.h"
#include "tests/support/result_paths.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using Json = nlohmann::ordered_json;
using test::unknown_paths;

TEST(ResultFields, PatternsStandForPaths) {
  EXPECT_TRUE(stands_for("a.b[].c", "a.b[].c"));
  EXPECT_FALSE(stands_for("a.b[].c", "a.b[]"));
  EXPECT_FALSE(stands_for("a.b", "a.b.c"));
  EXPECT_TRUE(stands_for("wall_s.*", "wall_s.trace"));
  EXPECT_FALSE(stands_for("wall_s.*", "wall_s.trace.x"));
  EXPECT_TRUE(stands_for("start.**", "start.error.c48"));
  EXPECT_FALSE(stands_for("start.**", "start"));
  EXPECT_TRUE(stands_for("s.*.min", "s.peak.min"));
}

constexpr const char* kEveryDetector = R"(
[[source]]
kind = "disk"
[[reflector]]
family = "bspline"
focal_mm = 15
diameter_mm = 60
position_mm = [0, 0, 15]
axis = "-z"
reflectance = 0.9
[[detector]]
kind = "far-field"
[[detector]]
kind = "plane"
position_mm = [0, 0, -500]
[[detector]]
kind = "luminance"
name = "afar"
from = [1, 0, -1]
[[detector]]
kind = "luminance"
name = "near"
from_mm = [300, 0, -500]
[[detector]]
kind = "rays"
)";

constexpr const char* kZones = R"([target]
kind = "plane"
position_mm = [0, 0, -500]
normal = "+z"
size_mm = [400, 400]
[[target.zone]]
x_mm = [-100, 100]
y_mm = [-100, 100]
min_lx = 10
)";

Project lamp(const std::filesystem::path& folder, const std::string& more) {
  write_file(folder / "lamp.toml", kEveryDetector + more);
  return read_project(folder / "lamp.toml");
}

Json trace_file_json(const Project& project) {
  TraceOptions options;
  options.last_ray = 1 << 15;
  const TraceResult result = trace(project.scene, options);
  Json json = run_json({"lucerna trace", project.inputs, {{"trace", 1.0}}}, 1, result.isa);
  json["sequence"] = "sobol";
  json["rays"] = {{"first", 0}, {"last", 1}};
  json["warnings"] = {"none"};
  json.update(trace_json(trace_metrics(result)));
  return json;
}

/// Everything that a design can have found, without the search.
Json design_file_json(const std::filesystem::path& folder, const std::string& target) {
  const DesignProblem problem = design_problem(lamp(folder, target), folder / "lamp.toml");
  DesignResult result(problem.start);
  result.pareto.emplace_back();
  result.advice.emplace_back();
  result.limits.push_back({"max_height_mm", 1.0, {1.0, 0.0}, true});
  result.remarks.emplace_back("none");
  ZoneCheck zone;
  zone.bounds.emplace_back();
  zone.bounds.back().direct = Estimate{};
  result.zones = result.start_zones = {zone};
  zone.on_plane = true;
  result.zones.push_back(zone);
  TraceOptions options;
  options.last_ray = 1 << 15;
  ToleranceRanges ranges;
  ranges.samples = 2;
  ranges.rays = 1 << 14;
  DesignMetrics figures = design_metrics(problem.target, result.error.scale,
                                         trace(problem.project.scene, options), problem.project.scene);
  figures.tolerances = tolerance_sweep(problem.project.scene, ranges, 1);
  Json json = design_json(problem.target, result, design_form(result), figures);
  DesignForm lens = design_form(result);
  lens.is_lens = true;
  json.merge_patch({{"lens", design_json(problem.target, result, lens, figures).at("lens")}});
  return json;
}

// Both ways: what is written is in the table, and what is in the table is written by one of these.
TEST(ResultFields, AreThoseOfRealFiles) {
  const test::TempDir dir;
  std::set<std::string_view> unseen;
  for (const ResultField& f : result_fields()) unseen.insert(f.path);
  EXPECT_EQ(unknown_paths(trace_file_json(lamp(dir.path(), "")), {"both", "trace"}, unseen),
            std::set<std::string>{});
  write_file(dir / "t.csv", "1,2\n3,4\n");
  const std::string file = "file = 't.csv'\n", from = "[[target.zone]]";
  const std::string zones = kZones, filed = std::string(kZones).replace(zones.find(from), 0, file);
  for (const std::string& target : {zones, filed})
    EXPECT_EQ(unknown_paths(design_file_json(dir.path(), target), {"design"}, unseen),
              std::set<std::string>{});
  unseen.erase("device");  // set by the program
  // A target of directions, which this one is not.
  for (const char* path : {"target.peak.**", "target.centre.**", "target.planes[].**"}) unseen.erase(path);
  EXPECT_EQ(unseen, std::set<std::string_view>{});
}

}  // namespace
}  // namespace lucerna
