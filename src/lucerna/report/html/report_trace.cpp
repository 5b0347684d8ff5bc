// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_trace.h"

#include <fmt/format.h>

#include <optional>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/project.h"
#include "lucerna/report/html/report_far_field.h"
#include "lucerna/report/html/report_planes.h"
#include "lucerna/report/html/report_sections.h"
#include "lucerna/report/html/report_variants.h"

namespace lucerna {

namespace {

std::string summary(const ResultFigures& result, const TraceFolder& folder) {
  std::string out = "<dl class=\"cards\">\n";
  out += card("Flux of the sources", result.figure("/ledger/emitted"), result.text("/ledger/unit"),
              fmt::format("{} rays, {} reflections a ray", result.figure("/ledger/rays"),
                          result.figure("/ledger/reflections_per_ray")));
  if (!folder.far_fields.empty()) out += far_field_cards(result, first_far_field_key(result));
  return out + "</dl>\n";
}

std::string run_facts(const ResultFigures& result) {
  return fact("Rays",
              fmt::format("{} to {}, {} sequence, seed {}", result.figure("/rays/first"),
                          result.figure("/rays/last"), result.text("/sequence"), result.figure("/seed"))) +
         fact("Computed with", result.text("/isa") + " tracer");
}

}  // namespace

std::string trace_report_html(const TraceFolder& folder, const TraceReportOptions& options) {
  const ResultFigures result(folder.result, (folder.path / "result.json").string());
  HtmlPage page("Light tracing", folder_title(folder.path));
  page.section("summary", "Summary", warnings_html(result) + summary(result, folder));
  page.section("energy", "Energy balance", energy_balance_html(result));
  add_view_section(page, {options.scene,
                          options.no_scene,
                          {.seed = result.count("/seed"),
                           .sequence = sequence_kind(result.text("/sequence")),
                           .first_ray = result.count("/rays/first")}});
  add_far_field_sections(page, result, folder.far_fields);
  add_plane_sections(page, result, folder.planes);
  page.section("provenance", "Where this comes from",
               provenance_html(result, run_facts(result), folder.project));
  page.data("result", folder.result);
  return page.str();
}

void write_trace_report(const std::filesystem::path& folder, const std::filesystem::path& output) {
  const TraceFolder read = read_trace_folder(folder);
  std::optional<Project> project;
  TraceReportOptions options;
  try {
    project = read_project(folder / "project.toml");
    options.scene = &project->scene;
  } catch (const InputError& e) {
    options.no_scene = e.what();
  }
  write_file(output, trace_report_html(read, options));
}

}  // namespace lucerna
