// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/trace_files.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lucerna/core/file.h"
#include "lucerna/trace/trace.h"
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
  const TraceFigures figures = trace_figures(trace(project.scene, options));
  const std::string csv = far_field_csv(figures.far_fields[0]);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 72 * 181);
  const auto names = write_trace_files(dir.path(), project, figures, trace_json(figures));
  for (const std::string& name : names) EXPECT_GT(std::filesystem::file_size(dir / name), 50u) << name;
  return names;
}

TEST(TraceFiles, AllAreThereAndTheResultComesLast) {
  const auto names = files_of("flux_lm = 20");
  EXPECT_EQ(names, (std::vector<std::string>{"far.ldt", "far.ies", "far.csv", "far.svg", "project.toml",
                                             "result.json"}));
}

TEST(TraceFiles, WattsHaveNoEulumdat) {
  const auto names = files_of("flux_w = 20");
  EXPECT_EQ(std::count(names.begin(), names.end(), "far.ldt"), 0);
  EXPECT_EQ(std::count(names.begin(), names.end(), "far.ies"), 1);
}

}  // namespace
}  // namespace lucerna
