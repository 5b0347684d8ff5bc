// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/output/trace_output.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "lucerna/report/html/report_trace.h"
#include "lucerna/results/folders/trace_folder.h"
#include "lucerna/results/folders/trace_results.h"

namespace lucerna::cli {

std::vector<std::string> write_trace_output(const std::string& folder, const TraceResult& result,
                                            const TraceOrigin& origin, const TraceMetrics& figures,
                                            std::vector<std::string> warnings, Session& session) {
  Json json = session.json_head(result.seed, result.isa);
  auto names = write_trace_results(folder, result, origin, figures, json, warnings);
  for (const std::string& warning : warnings) session.note(warning);
  session.print_json(json);
  return names;
}

void note_ray_file(std::uint64_t last_ray, const NoiseTrace& traced, Session& session) {
  if (traced.end != NoiseEnd::finite_source) return;
  session.note(fmt::format("rays up to {} of {} asked for: {}", traced.result.last_ray, last_ray,
                           to_string(traced.end)));
}

void note_noise(const std::string& of, const NoiseTrace& traced, double goal, Session& session) {
  if (std::isnan(traced.noise)) return;  // so few rays are warned of
  const std::string_view why = to_string(traced.end);
  if (traced.noise > goal) {
    session.note(fmt::format("{}noise {:.2g} % of the peak, {:.2g} % requested: {}", of, 100.0 * traced.noise,
                             100.0 * goal, why));
  } else {  // what trace_until asks for last
    session.note(fmt::format(
        "{}noise {:.2g} % of the peak, as requested, but the peak itself is not known to {:.2g} % "
        "yet: {}",
        of, 100.0 * traced.noise, 50.0 * goal, why));
  }
}

void note_interrupted_figures(Session& session) {
  session.note("interrupted: all rays were traced; the figures are those that they alone give");
}

void print_trace_summary(const TraceMetrics& figures, const std::vector<std::string>& names,
                         Session& session) {
  for (const std::string& line : trace_summary(figures)) session.print_line(line);
  session.print_line(fmt::format("  written: {}", fmt::join(names, " ")));
}

void write_trace_report(const std::string& html, const std::string& folder, const Scene& scene,
                        Session& session) {
  write_file(html, trace_report_html(read_trace_folder(folder), {.scene = &scene}));
  session.print_line(fmt::format("  report: {}", html));
}

}  // namespace lucerna::cli
