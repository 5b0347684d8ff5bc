// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_design.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/report/html/grid_map.h"
#include "lucerna/results/folders/trace_files.h"
#include "lucerna/results/json/trace_json.h"
#include "lucerna/trace.h"
#include "lucerna/version.h"
#include "tests/support/html_check.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMirror = R"([[source]]
kind = "disk"
radius_mm = 0.5
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 15.0
diameter_mm = 60.0
position_mm = [0, 0, 15]
axis = "-z"
reflectance = 0.9
[[detector]]
kind = "far-field"
name = "far"
[[detector]]
kind = "plane"
name = "floor"
position_mm = [0, 0, -2000]
normal = "+z"
size_mm = [1500, 1000]
cells = [15, 10]
[design]
time_s = 1
)";
constexpr const char* kHistory =
    "evaluations,stage,step,rays,total_rays,relative_rms,floor,lambda,accepted,efficiency\n"
    "2,0,1,65536,131072,0.9,0.01,1,1,0.9\n3,0,2,65536,196608,0.95,0.01,1,0,0.9\n"
    "4,0,3,65536,262144,0.2,0.01,1,1,0.9\n5,1,1,65536,327680,0.1,0.02,1,1,0.89\n";

/// The detector that a design adds for a target of this plane.
constexpr const char* kWatch =
    "[[detector]]\nkind = 'plane'\nname = 'target'\nposition_mm = [0, 0, -1000]\nnormal = '+z'\n"
    "size_mm = [300, 300]\ncells = [30, 30]\n";

/// A folder as `lucerna design` leaves it: the mirror that was there, called the result.
void make_design(const test::TempDir& dir, const std::string& target, double target_factor = 1.0) {
  write_file(dir / "p.toml", kMirror + target);
  const Project project = read_project(dir / "p.toml");
  TraceOptions options;
  options.last_ray = 50'000;
  const TraceMetrics figures = trace_metrics(trace(project.scene, options));
  const Json kEstimate{{"value", 0.89}, {"standard_error", 0.002}};
  const Json kError{{"value", 0.0323}, {"floor", 0.0016}, {"excess", 0.0322}, {"standard_error", 0.0003}};
  Json json{{"program_version", std::string(version())},
            {"schema_version", kJsonSchemaVersion},
            {"command", "lucerna design"},
            {"seed", 1},
            {"threads", 2},
            {"isa", "scalar"},
            {"inputs", Json::array()},
            {"wall_s", {{"design", 1.5}}},
            {"error", {{"c12", kError}, {"c24", kError}, {"c48", kError}}},
            {"start", {{"error", {{"c48", kError}}}}},
            {"outside", {{"share", kEstimate}, {"direct", kEstimate}, {"error", kError}}},
            {"bound",
             {{"error", 0.021},
              {"etendue_error", 0.021},
              {"direct_error", 0.003},
              {"target_share", 0.42},
              {"max_share", 0.38},
              {"etendue_mm2sr", 51.5},
              {"reason", "the <brightest> boxes"}}},
            {"worst_cell", kEstimate},
            {"in_rectangle", kEstimate},
            {"target", {{"factor", target_factor}, {"peak", {{"intensity", 1234.0}}}}},
            {"peak", {{"intensity", {{"value", 1000.0}, {"standard_error", 10.0}}}}},
            {"scale", 993.8},
            {"efficiency", kEstimate},
            {"evaluations", 5},
            {"rays", 327680},
            {"parameters", 18},
            {"height_mm", 28.5},
            {"end", "time"},
            {"remarks", {"the target is <not> reached"}}};
  json.update(trace_json(figures));
  write_trace_files(dir.path(), trace_origin(project), figures, {}, json);
  write_file(dir / "history.csv", kHistory);
}

std::string report_of(const test::TempDir& dir) {
  write_design_report(dir.path(), dir / "report.html");
  return read_file(dir / "report.html", 1 << 24);
}

using test::has;

TEST(ReportDesign, ShowsTheTargetTheConvergenceAndTheLosses) {
  const test::TempDir dir;
  {
    // The target: the light of the same mirror: it fits but for the digits of the file.
    const test::TempDir other;
    make_design(other, "");
    std::filesystem::copy(other / "far.ldt", dir / "target.ldt");
  }
  make_design(dir, "[target]\nfile = 'target.ldt'\n");
  const std::string html = report_of(dir);
  EXPECT_EQ(test::html_fault(html), "");
  EXPECT_LT(html.size(), 1'500'000u);
  const auto seen = test::check_keyed_figures(html, test::embedded(html, "result"));
  for (const char* key :
       {"/error/c48/excess", "/error/c12/excess", "/start/error/c48/excess", "/outside/share/value",
        "/outside/error/excess", "/worst_cell/value", "/in_rectangle/value", "/efficiency/value",
        "/evaluations", "/ledger/absorbed/mirror/value", "/detectors/1/mean/value"})
    EXPECT_TRUE(seen.contains(key)) << key;
  EXPECT_TRUE(has(html, "the &lt;brightest&gt; boxes"));
  EXPECT_TRUE(has(html, "the target is &lt;not&gt; reached"));
  const Json fields = test::embedded(html, "far-fields");
  ASSERT_EQ(fields.size(), 2u) << "the result stands in the page once, and the target";
  const auto result = test::unpacked<float>(fields[0]["intensity"]),
             target = test::unpacked<float>(fields[1]["intensity"]);
  ASSERT_EQ(result.size(), target.size());
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double r = result[i], t = target[i];
    difference += (r - t) * (r - t);
    size += t * t;
  }
  EXPECT_LT(difference, 1e-4 * size);
  const Json curves = test::embedded(html, "curves");
  ASSERT_EQ(curves.size(), 2u);
  EXPECT_EQ(curves[1]["curves"][0]["y"], (Json{90.0, 20.0, 10.0}));
  EXPECT_EQ(curves[1]["curves"][2]["name"], "rejected");
  const Json grids = test::embedded(html, "grids");
  ASSERT_EQ(grids.size(), 1u);
  EXPECT_EQ(test::unpacked<float>(grids[0]["value"]).size(), 150u);
}

// One comparison: a factor and peaks of the report's own had been others than the design's.
TEST(ReportDesign, TheTargetIsScaledAsTheDesignWasComparedWithIt) {
  const test::TempDir dir, other;
  make_design(other, "");
  std::filesystem::copy(other / "far.ldt", dir / "target.ldt");
  make_design(dir, "[target]\nfile = 'target.ldt'\n", 2.0);
  const std::string html = report_of(dir);
  const Json fields = test::embedded(html, "far-fields");
  ASSERT_EQ(fields.size(), 2u);
  const auto result = test::unpacked<float>(fields[0]["intensity"]),
             target = test::unpacked<float>(fields[1]["intensity"]);
  ASSERT_EQ(result.size(), target.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    EXPECT_NEAR(target[i], 2.0f * result[i], 0.01f * result[i] + 0.01f) << i;
  }
  EXPECT_TRUE(has(html, "0.8104 ± 0.0081")) << "1000 +- 10 over 1234";
}

TEST(ReportDesign, PlaneTargetsAreComparedOnTheirRectangle) {
  const test::TempDir dir;
  write_file(dir / "wanted.csv", "1,2,1\n2,4,2\n1,2,1\n");
  const std::string target =
      "[target]\nkind = 'plane'\nfile = 'wanted.csv'\nposition_mm = [0, 0, -1000]\nnormal = '+z'\n"
      "size_mm = [300, 300]\n";
  make_design(dir, target + kWatch);
  const std::string html = report_of(dir);
  EXPECT_EQ(test::html_fault(html), "");
  const Json grids = test::embedded(html, "grids");
  ASSERT_EQ(grids.size(), 4u) << html.substr(html.find("id=\"target\""), 400);
  const auto wanted = test::unpacked<float>(grids[0]["value"]),
             found = test::unpacked<float>(grids[1]["value"]),
             difference = test::unpacked<float>(grids[2]["value"]);
  const std::string plane = html.substr(html.rfind("Illuminance: target"));
  EXPECT_TRUE(has(plane.substr(0, plane.find("</section>")), "data-grid=\"1\"")) << "the result's once more";
  const std::vector<double> traced = read_trace_folder(dir.path()).planes[1].value;
  ASSERT_EQ(found.size(), traced.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], traced[i], 1e-6 * traced[i]) << "one trace, one result";
  for (std::size_t i = 0; i < wanted.size(); ++i)
    EXPECT_NEAR(difference[i], found[i] - wanted[i],
                1e-3f * (std::abs(found[i]) + std::abs(wanted[i])) + 1e-3f);
}

// Such a lens has no [design] any more: nothing of its face could be designed on.
TEST(ReportDesign, FinishedFreeFormLensesAreComparedAndShown) {
  const test::TempDir dir;
  write_file(dir / "wanted.csv", "1,2,1\n2,4,2\n1,2,1\n");
  make_design(dir, kWatch);
  std::string flat = "[0";
  for (int i = 1; i < 49; ++i) flat += ", 0";
  write_file(dir / "project.toml",
             "[[source]]\nkind = 'disk'\nradius_mm = 0.5\n[[body]]\nrole = 'solid'\nmaterial = 'pmma'\n"
             "outline_mm = [[0, -6], [8, -6], [8, -3]]\n[body.face]\nhalf_mm = 8\nintervals = [4, 4]\n"
             "coefficients_mm = " +
                 flat +
                 "]\n[[detector]]\nkind = 'far-field'\n"
                 "[target]\nkind = 'plane'\nfile = 'wanted.csv'\nposition_mm = [0, 0, -1000]\n"
                 "normal = '+z'\nsize_mm = [300, 300]\n" +
                 kWatch);
  const std::string html = report_of(dir);
  EXPECT_EQ(test::html_fault(html), "");
  EXPECT_FALSE(has(html, "There is no comparison"));
  EXPECT_FALSE(has(html, "There is no 3D view"));
  EXPECT_EQ(test::embedded(html, "grids").size(), 4u);
}

TEST(ReportDesign, SaysWhyThereIsNoTarget) {
  const test::TempDir dir;
  make_design(dir, "[target]\nfile = 'gone.ldt'\n");
  const std::string html = report_of(dir);
  EXPECT_EQ(test::html_fault(html), "");
  EXPECT_TRUE(has(html, "There is no comparison: "));
  EXPECT_TRUE(has(html, "gone.ldt"));
}

TEST(ReportDesign, BadHistoriesNameTheirLine) {
  EXPECT_EQ(read_history(kHistory, "h.csv").size(), 4u);
  const auto message = [](const std::string& csv) {
    return test::message_of<InputError>([&] { read_history(csv, "h.csv"); });
  };
  EXPECT_TRUE(has(message("evaluations,stage\n1,2\n"), "h.csv: line 2: has no column 'total_rays'"));
  std::string bad = kHistory;
  bad.replace(bad.find("0.95"), 4, "x.95");
  EXPECT_TRUE(has(message(bad), "line 3: found 'x.95'")) << message(bad);
  EXPECT_TRUE(read_history("", "h.csv").empty());
}

TEST(GridMap, FigureHoldsTheValuesAndTheAxes) {
  HtmlPage page("k", "t");
  GridMap map;
  map.nx = 2, map.ny = 3;
  map.x_last = 4.0, map.y_last = 2.0;
  map.value = {1, 2, 3, 4, 5, -6};
  const std::string figure = grid_figure(page, map, "m", "a map");
  EXPECT_EQ(test::html_fault(figure), "");
  EXPECT_TRUE(has(figure, "data-grid=\"0\""));
  const Json grid = test::embedded(page.str(), "grids")[0];
  EXPECT_EQ(grid["range"], (Json{-6.0, 5.0}));
  EXPECT_EQ(test::unpacked<float>(grid["value"]), (std::vector<float>{1, 2, 3, 4, 5, -6}));
  map.diverging = true;
  grid_figure(page, map, "n", "another");
  EXPECT_EQ(test::embedded(page.str(), "grids")[1]["range"], (Json{-6.0, 6.0}));
  map.nx = 3;
  EXPECT_THROW(grid_svg(map), std::logic_error);
}

}  // namespace
}  // namespace lucerna
