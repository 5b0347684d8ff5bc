// SPDX-License-Identifier: Apache-2.0
#include "lucerna/mpi/trace_command.h"

#include <fmt/format.h>

#include <csignal>
#include <memory>

#include "lucerna/cli/output/stored_trace.h"
#include "lucerna/cli/output/trace_output.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/distributed/distributed_trace.h"
#include "lucerna/mpi/together.h"
#include "lucerna/project.h"
#include "lucerna/results/metrics/trace_warnings.h"
#include "lucerna/trace/run/empty_trace.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna::cli {

namespace {

namespace fs = std::filesystem;

struct MpiTraceArguments {
  std::string project, output, noise = "1%", time = "60", rays, seed, sequence, chunk, checkpoint = "300",
                               report;
  bool resume = false;
};

TraceOptions trace_options(const MpiTraceArguments& a) {
  TraceOptions options;
  if (!a.seed.empty()) options.seed = parse_count(a.seed);
  if (!a.sequence.empty()) options.sequence = sequence_kind(a.sequence);
  if (a.rays.empty()) return options;
  const RayRange range = parse_range(a.rays);
  options.first_ray = range.first;
  options.last_ray = range.last;
  return options;
}

DistributedOptions distributed_options(const MpiTraceArguments& a, Session& session) {
  DistributedOptions how{.parts = fs::path(a.output) / "parts", .note = {}};
  if (!a.chunk.empty()) {
    const std::uint64_t rays = parse_count(a.chunk);
    if (rays == 0) throw UsageError("chunks of 0 rays: expected at least one");
    how.chunk_rays = (rays + kBlockRays - 1) / kBlockRays * kBlockRays;
  }
  how.checkpoint_s = parse_number(a.checkpoint);
  if (!(how.checkpoint_s > 0.0))
    throw UsageError(fmt::format("'{}' seconds between two writings: expected more than 0", a.checkpoint));
  how.note = [&session](const std::string& text) { session.note(text); };
  return how;
}

/// The first rank makes the folder; parts that are not gone on with would be mixed with the new ones.
void prepare(const MpiTraceArguments& a, const fs::path& parts, Session& session) {
  session.prepare_folder(a.output, session.force || a.resume);
  require_report(a.report);
  if (!a.resume) fs::remove_all(parts);
}

/// The trace in the folder, on the first rank; its seed and sequence on all.
std::optional<TraceResult> finished_trace(const MpiTraceArguments& a, const TraceOrigin& origin, Ranks& ranks,
                                          TraceOptions& options) {
  std::optional<TraceResult> from;
  std::string numbers;
  together(ranks, [&] {
    if (!a.resume || !ranks.is_first()) return;
    from = stored_trace(a.output, a.seed, a.sequence, origin);
    if (from) numbers = fmt::format("{} {}", from->seed, to_string(from->sequence));
  });
  numbers = ranks.broadcast(numbers);
  if (numbers.empty()) return from;
  const std::size_t blank = numbers.find(' ');
  options.seed = parse_count(numbers.substr(0, blank));
  options.sequence = sequence_kind(numbers.substr(blank + 1));
  return from;
}

/// By the number of rays, or by their noise.
DistributedNoise trace_all(const MpiTraceArguments& a, const Project& project, const TraceOrigin& origin,
                           const TraceOptions& options, const DistributedOptions& how, Ranks& ranks,
                           Session& session) {
  const RangeTracer tracer = [&](const RayInterval& rays, Progress& progress) {
    TraceOptions some = options;
    some.first_ray = rays.first;
    some.last_ray = rays.last;
    return trace(project.scene, some, progress);
  };
  TraceResult empty = empty_trace(project.scene, options);
  if (a.rays.empty()) {
    const NoiseGoal goal{.noise = parse_share(a.noise), .max_seconds = parse_number(a.time)};
    DistributedNoise traced = trace_until_on_ranks(ranks, project.scene, std::move(empty), tracer, origin,
                                                   how, goal, session.progress());
    if (traced.result &&
        (traced.result->end == NoiseEnd::time || traced.result->end == NoiseEnd::finite_source))
      note_noise("", *traced.result, goal.noise, session);
    return traced;
  }
  DistributedTrace traced = trace_on_ranks(ranks, empty, tracer, origin, how, session.progress());
  if (!traced.result) return {std::nullopt, traced.interrupted};
  const bool file_ends = traced.result->last_ray < *options.last_ray;
  NoiseTrace all{std::move(*traced.result), 0.0, file_ends ? NoiseEnd::finite_source : NoiseEnd::rays};
  note_ray_file(*options.last_ray, all, session);
  return {std::move(all), false};
}

/// What the first rank does once the light is counted. Returns whether it was asked to stop on the way.
bool write_results(const MpiTraceArguments& a, const Project& project, const TraceOrigin& origin,
                   const TraceResult& result, int ranks, Session& session) {
  const TraceMetrics figures =
      session.timed("figures", [&] { return trace_metrics(result, project.scene, {}, session.progress()); });
  const bool stopped = session.progress().stop_requested();
  if (stopped) note_interrupted_figures(session);
  const auto names = write_trace_output(a.output, result, origin, figures,
                                        trace_warnings(figures, project.scene, project.warnings), session);
  const double seconds = session.seconds("trace");
  session.print_line(fmt::format(
      "{}: {} rays in {:.3g} s, {:.3g} M rays/s ({}, {} ranks of {} threads); figures {:.3g} s", a.output,
      figures.ledger.rays, seconds, 1e-6 * static_cast<double>(figures.ledger.rays) / seconds, result.isa,
      ranks, ThreadLimit::current(), session.seconds("figures")));
  print_trace_summary(figures, names, session);
  if (!a.report.empty()) write_trace_report(a.report, a.output, project.scene, session);
  return stopped;
}

void run_mpi_trace(const MpiTraceArguments& a, Session& session, Ranks& ranks) {
  session.quiet = session.quiet || !ranks.is_first();
  session.start();
  session.stop_on_signal(SIGUSR1);
  TraceOptions options = trace_options(a);
  DistributedOptions how = distributed_options(a, session);
  Project project;
  TraceOrigin origin;
  together(ranks, [&] {
    project = session.timed("read", [&] { return read_project(a.project); });
    origin = session.timed("hash", [&] { return trace_origin(project); });
    if (ranks.is_first()) prepare(a, how.parts, session);
  });
  if (ranks.is_first()) {
    for (const std::string& warning : project.warnings) session.note(warning);
    for (const auto& input : project.inputs) session.add_input(input);
  }
  options.isa = common_isa(ranks, best_isa());
  const std::optional<TraceResult> from = finished_trace(a, origin, ranks, options);
  if (from) how.from = &*from;
  const DistributedNoise traced =
      session.timed("trace", [&] { return trace_all(a, project, origin, options, how, ranks, session); });
  if (traced.interrupted) {
    session.note("--resume goes on with the rays that are kept");
    throw Interrupted();
  }
  std::string end;
  together(ranks, [&] {
    if (!traced.result) return;
    if (write_results(a, project, origin, traced.result->result, ranks.size(), session)) end = "stopped";
    fs::remove_all(how.parts);
  });
  if (!ranks.broadcast(end).empty()) throw Interrupted();
}

}  // namespace

void add_mpi_trace(CLI::App& app, Session& session, Ranks& ranks) {
  Command command(app, "trace", "Trace a project's sources through its mirrors, on all ranks together");
  auto arguments = std::make_shared<MpiTraceArguments>();
  MpiTraceArguments& a = *arguments;
  command.required("PROJECT", a.project, "Project file (see: lucerna init)");
  command.required("-o,--output", a.output, "Folder for the results, which all ranks see");
  command.option("--noise", a.noise,
                 "Trace until no angle above 1 % of the peak has a larger error, as a share of the peak");
  command.option("--time", a.time, "Seconds after which to stop with the noise that is left");
  command.option("--rays", a.rays, "Instead: a number of rays, or a range A:B of ray numbers");
  command.flag("--resume", a.resume,
               "Go on with the parts in the folder, of any number of ranks, or with a finished trace");
  command.option("--checkpoint", a.checkpoint, "Seconds between two writings of a rank's part");
  command.option("--chunk", a.chunk,
                 "Rays that a rank takes at a time (default: by their number, 2^24 at most)");
  command.option("--seed", a.seed, "Seed of the random numbers (default 1; with --resume that of the trace)");
  command.option("--sequence", a.sequence,
                 "random or sobol (default sobol; with --resume that of the trace)");
  command.option("--report", a.report, "Also write the report as one HTML file");
  command.flag("--force", session.force, "Write into a folder that is not empty");
  session.add_json(command);
  session.add_common(command);
  command.on_run(
      [arguments, &session, &ranks] { or_abort(ranks, [&] { run_mpi_trace(*arguments, session, ranks); }); });
}

}  // namespace lucerna::cli
