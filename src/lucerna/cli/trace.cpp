// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/trace.h"

#include <fmt/format.h>

#include "lucerna/cli/arguments.h"
#include "lucerna/cli/commands.h"
#include "lucerna/cli/trace_output.h"
#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/report/report_trace.h"
#include "lucerna/report/trace_folder.h"
#include "lucerna/trace/accelerator.h"
#include "lucerna/trace/project.h"

namespace lucerna::cli {

namespace {

struct TraceArguments {
  std::string project, output, rays, seed = "1", sequence = "sobol", device = "auto", report;
};

TraceOptions trace_options(const TraceArguments& a) {
  TraceOptions options;
  options.device = trace_device(a.device);
  if (options.device == TraceDevice::cuda && !why_no_cuda().empty()) {
    throw InputError(fmt::format("--device cuda: {}", why_no_cuda()));
  }
  options.seed = parse_count(a.seed);
  options.sequence = sequence_kind(a.sequence);
  if (!a.rays.empty()) {
    const RayRange range = parse_range(a.rays);
    options.first_ray = range.first;
    options.last_ray = range.last;
  }
  return options;
}

void run_trace(const TraceArguments& a, Session& session) {
  session.start();
  const TraceOptions options = trace_options(a);
  const Project project = session.timed("read", [&] { return read_project(a.project, session.progress()); });
  prepare_folder(a.output, session.force);
  for (const std::string& warning : project.warnings) session.note(warning);
  for (const auto& input : project.inputs) session.add_input(input);
  const TraceResult result =
      session.timed("trace", [&] { return trace(project.scene, options, session.progress()); });
  const TraceFigures figures = session.timed("figures", [&] { return trace_figures(result); });
  const TraceOrigin origin = session.timed("hash", [&] { return trace_origin(project); });
  const auto names = write_trace_output(a.output, result, origin, figures, session);
  const double seconds = session.seconds("trace");
  session.say(fmt::format(
      "{}: {} rays in {:.3g} s, {:.3g} M rays/s ({}, {} threads); read {:.3g} s, figures {:.3g} s", a.output,
      figures.ledger.rays, seconds, 1e-6 * static_cast<double>(figures.ledger.rays) / seconds, result.isa,
      ThreadLimit::current(), session.seconds("read"), session.seconds("figures")));
  say_trace_summary(figures, names, session);
  if (!a.report.empty()) {
    write_file(a.report, trace_report_html(read_trace_folder(a.output), {.scene = &project.scene}));
    session.say(fmt::format("  report: {}", a.report));
  }
}

}  // namespace

void add_trace(CLI::App& app, Session& session, int&) {
  Command command(app, "trace", "Trace a project's sources through its mirrors");
  auto arguments = std::make_shared<TraceArguments>();
  TraceArguments& a = *arguments;
  command.required("PROJECT", a.project, "Project file (see: lucerna init)");
  command.required("-o,--output", a.output, "Folder for the results");
  command.option("--rays", a.rays, "Number of rays, or a range A:B of ray numbers");
  command.option("--seed", a.seed, "Seed of the random numbers");
  command.option("--sequence", a.sequence, "random or sobol");
  command.option("--device", a.device, "cpu, cuda or auto");
  command.option("--report", a.report, "Also write the report as one HTML file");
  command.flag("--force", session.force, "Write into a folder that is not empty");
  session.add_json(command);
  session.add_common(command);
  command.on_run([arguments, &session] { run_trace(*arguments, session); });
}

}  // namespace lucerna::cli
