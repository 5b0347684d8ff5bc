// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace.h"

#include <fmt/format.h>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/output/stored_trace.h"
#include "lucerna/cli/output/trace_output.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/cli/parse/traceable_project.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/results/metrics/trace_warnings.h"
#include "lucerna/trace/device/accelerator.h"

namespace lucerna::cli {

namespace {

struct TraceArguments {
  std::string project, output, rays, noise = "1%", time = "60", seed, sequence, device = "auto", report;
  bool resume = false;
};

TraceOptions trace_options(const TraceArguments& a) {
  TraceOptions options;
  options.device = trace_device(a.device);
  if (options.device == TraceDevice::cuda) require_cuda();
  if (!a.seed.empty()) options.seed = parse_count(a.seed);
  if (!a.sequence.empty()) options.sequence = sequence_kind(a.sequence);
  if (!a.rays.empty()) {
    const RayRange range = parse_range(a.rays);
    options.first_ray = range.first;
    options.last_ray = range.last;
  }
  return options;
}

NoiseTrace run_rays(const TraceArguments& a, const Scene& scene, const TraceOptions& options,
                    const TraceOrigin& origin, Session& session) {
  std::optional<TraceResult> from =
      a.resume ? stored_trace(a.output, a.seed, a.sequence, origin) : std::nullopt;
  if (a.resume && !from) session.note(fmt::format("{}: no trace yet, starting anew", a.output));
  if (!a.rays.empty()) {
    NoiseTrace traced = trace_rays(scene, options, std::move(from), session.progress());
    note_ray_file(*options.last_ray, traced, session);
    return traced;
  }
  NoiseGoal goal;
  goal.noise = parse_share(a.noise);
  goal.max_seconds = parse_number(a.time);
  if (!(goal.max_seconds > 0.0)) throw UsageError(fmt::format("--time {} is not > 0", a.time));
  NoiseTrace traced = trace_until(scene, options, goal, std::move(from), session.progress());
  if (traced.end == NoiseEnd::time || traced.end == NoiseEnd::finite_source) {
    note_noise("", traced, goal.noise, session);
  }
  return traced;
}

void run_trace(const TraceArguments& a, Session& session, int& exit_code) {
  session.start();
  const TraceOptions options = trace_options(a);
  const Project project =
      session.timed("read", [&] { return read_traceable_project(a.project, session.progress()); });
  session.prepare_folder(a.output, session.force || a.resume);
  require_report(a.report);
  for (const std::string& warning : project.warnings) session.note(warning);
  for (const auto& input : project.inputs) session.add_input(input);
  const TraceOrigin origin = session.timed("hash", [&] { return trace_origin(project); });
  const NoiseTrace traced =
      session.timed("trace", [&] { return run_rays(a, project.scene, options, origin, session); });
  const TraceResult& result = traced.result;
  const TraceMetrics figures =
      session.timed("figures", [&] { return trace_metrics(result, project.scene, {}, session.progress()); });
  if (session.progress().stop_requested()) {
    if (traced.end == NoiseEnd::interrupted) {
      session.note(
          "interrupted: these are the rays that were traced, with the figures that they alone give; --resume "
          "goes on with them");
    } else {
      note_interrupted_figures(session);
    }
    exit_code = 3;
  }
  const auto names = write_trace_output(a.output, result, origin, figures,
                                        trace_warnings(figures, project.scene, project.warnings), session);
  const double seconds = session.seconds("trace");
  session.print_line(fmt::format(
      "{}: {} rays in {:.3g} s, {:.3g} M rays/s ({}, {} threads); read {:.3g} s, figures {:.3g} s", a.output,
      figures.ledger.rays, seconds, 1e-6 * static_cast<double>(figures.ledger.rays) / seconds, result.isa,
      ThreadLimit::current(), session.seconds("read"), session.seconds("figures")));
  print_trace_summary(figures, names, session);
  if (!a.report.empty()) write_trace_report(a.report, a.output, project.scene, session);
}

}  // namespace

void add_trace(CLI::App& app, Session& session, int& exit_code) {
  Command command(app, "trace", "Trace a project's sources through its mirrors");
  auto arguments = std::make_shared<TraceArguments>();
  TraceArguments& a = *arguments;
  command.required("PROJECT", a.project, "Project file (see: lucerna init)");
  command.required("-o,--output", a.output, "Folder for the results");
  command.option("--noise", a.noise,
                 "Trace until no angle above 1 % of the peak has a larger error, as a share of the peak");
  command.option("--time", a.time,
                 "Seconds after which to stop with the noise that is left. Neither limit acts with a ray "
                 "file as source, "
                 "a rays detector or no far field: a file is traced once, other sources share 2^20 rays");
  command.option("--rays", a.rays, "Instead of both: a number of rays, or a range A:B of ray numbers");
  command.exclusive("--rays", "--noise");
  command.exclusive("--rays", "--time");
  command.flag("--resume", a.resume, "Go on with the trace in the folder");
  command.option("--seed", a.seed, "Seed of the random numbers (default 1; with --resume that of the trace)");
  command.option("--sequence", a.sequence,
                 "random or sobol (default sobol; with --resume that of the trace)");
  command.option("--device", a.device, "cpu, cuda or auto");
  command.option("--report", a.report, "Also write the report as one HTML file");
  command.flag("--force", session.force, "Write into a folder that is not empty");
  session.add_json(command);
  session.add_common(command);
  command.on_run([arguments, &session, &exit_code] { run_trace(*arguments, session, exit_code); });
}

}  // namespace lucerna::cli
