// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_trace.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/project.h"
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

constexpr const char* kProject = R"([[source]]
kind = "led"
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 15.0
diameter_mm = 80.0
position_mm = [0, 0, 15]
axis = "-z"
reflectance = 0.9
[[detector]]
kind = "far-field"
name = "far <b>"
)";

/// Traces kProject into `dir`.
void make_trace(const test::TempDir& dir, const std::string& project_toml = kProject) {
  write_file(dir / "p.toml", project_toml);
  const Project project = read_project(dir / "p.toml");
  TraceOptions options;
  options.last_ray = 20'000;
  const TraceMetrics figures = trace_metrics(trace(project.scene, options));
  nlohmann::ordered_json json{{"program_version", std::string(version())},
                              {"schema_version", kJsonSchemaVersion},
                              {"command", "lucerna trace"},
                              {"seed", 1},
                              {"threads", 2},
                              {"isa", "reference"},
                              {"inputs", {{{"path", "p.toml"}, {"sha256", std::string(64, 'a')}}}},
                              {"wall_s", {{"trace", 0.25}}},
                              {"sequence", "sobol"},
                              {"rays", {{"first", 0}, {"last", 20'000}}}};
  json.update(trace_json(figures));
  write_trace_files(dir.path(), trace_origin(project), figures, {}, json);
}

using test::has;

TEST(ReportTrace, IsOneWellFormedFileThatAsksNothingOfAnyNetwork) {
  const test::TempDir dir;
  make_trace(dir);
  write_trace_report(dir.path(), dir / "report.html");
  const std::string html = read_file(dir / "report.html", 1 << 24);
  EXPECT_EQ(test::html_fault(html), "");
  EXPECT_LT(html.size(), 1'500'000u);
  EXPECT_TRUE(has(html, "default-src 'none'"));
  // Names that are no requests: XML namespaces.
  std::string rest = html;
  const std::string space = "http://www.w3.org/";
  for (std::size_t at = rest.find(space); at != std::string::npos; at = rest.find(space))
    rest.erase(at, space.size());
  for (const char* part : {"http:", "https:", "//cdn", "@import", "src=\"", "<link", "<iframe", "fetch("}) {
    EXPECT_FALSE(has(rest, part)) << part << " at " << rest.substr(rest.find(part), 120);
  }
  EXPECT_TRUE(has(html, "three.js authors")) << "the licence of the bundle goes with it";
}

TEST(ReportTrace, CheckSeesBrokenHtml) {
  EXPECT_EQ(test::html_fault("<p><b>x</b></p>"), "");
  EXPECT_NE(test::html_fault("<p><b>x</p></b>"), "");
  EXPECT_NE(test::html_fault("<p>"), "");
  EXPECT_NE(test::html_fault("<p a=b></p>"), "");
  EXPECT_NE(test::html_fault("<p id=\"a\"></p><p id=\"a\"></p>"), "");
}

TEST(ReportTrace, EveryKeyedFigureIsTheOneOfTheJson) {
  const test::TempDir dir;
  make_trace(dir);
  const TraceFolder folder = read_trace_folder(dir.path());
  const std::string html = trace_report_html(folder);
  const std::set<std::string> seen = test::check_keyed_figures(html, folder.result);
  for (const char* key : {"/ledger/emitted", "/ledger/out_reflected/value", "/ledger/absorbed/mirror/value",
                          "/detectors/0/flux/value", "/detectors/0/peak/intensity/value",
                          "/detectors/0/planes/0/beam_angle_of_maximum_deg/value", "/seed"}) {
    EXPECT_TRUE(seen.contains(key)) << key;
  }
}

TEST(ReportTrace, NamesOfTheUserAreText) {
  const test::TempDir dir;
  make_trace(dir);
  const std::string html = trace_report_html(read_trace_folder(dir.path()));
  EXPECT_FALSE(has(html, "far <b>"));
  EXPECT_TRUE(has(html, "far &lt;b&gt;"));
}

TEST(ReportTrace, SaysWhyThereIsNoView) {
  const test::TempDir dir;
  make_trace(dir);
  write_file(dir / "project.toml", "[[source]]\nfile = 'gone.tm25ray'\n");
  write_trace_report(dir.path(), dir / "report.html");
  const std::string html = read_file(dir / "report.html", 1 << 24);
  EXPECT_TRUE(has(html, "There is no 3D view: "));
  EXPECT_TRUE(has(html, "gone.tm25ray"));
  EXPECT_FALSE(has(html, "three.js authors"));
  EXPECT_LT(html.size(), 600'000u);
  EXPECT_EQ(test::html_fault(html), "");
}

TEST(ReportTrace, MissingFiguresNameTheirKey) {
  const test::TempDir dir;
  make_trace(dir);
  TraceFolder folder = read_trace_folder(dir.path());
  folder.result["ledger"].erase("out_direct");
  const std::string message = test::message_of<InputError>([&] { trace_report_html(folder); });
  EXPECT_TRUE(has(message, "/ledger/out_direct: is missing")) << message;
}

TEST(ReportTrace, WattsStayWatts) {
  const test::TempDir dir;
  std::string project = kProject;
  project.replace(project.find("kind = \"led\""), 12, "kind = \"led\"\nflux_w = 2.5");
  make_trace(dir, project);
  const std::string html = trace_report_html(read_trace_folder(dir.path()));
  EXPECT_TRUE(has(html, "W/sr"));
  EXPECT_FALSE(has(html, "<small>lm</small>"));
}

}  // namespace
}  // namespace lucerna
