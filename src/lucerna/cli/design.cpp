// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/design.h"

#include <fmt/format.h>

#include "lucerna/cli/arguments.h"
#include "lucerna/cli/commands.h"
#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/reflector/cad_export.h"
#include "lucerna/report/report_design.h"
#include "lucerna/report/trace_files.h"
#include "lucerna/trace/trace.h"

namespace lucerna::cli {

namespace {

namespace fs = std::filesystem;

struct DesignArguments {
  std::string project, output, time, seed = "1", rays, device = "auto", report;
  bool resume = false;
};

/// A checkpoint is rewritten after every step, and takes a millisecond.
constexpr std::uint64_t kMostCheckpointBytes = std::uint64_t{64} << 20;

const char* to_string(DesignEnd end) {
  switch (end) {
    case DesignEnd::converged:
      return "converged";
    case DesignEnd::time:
      return "time";
    case DesignEnd::interrupted:
      return "interrupted";
  }
  return "";
}

DesignOptions design_options(const DesignArguments& a, const fs::path& checkpoint) {
  if (trace_device(a.device) == TraceDevice::cuda) {
    throw InputError("--device cuda: designs are made on the CPU only; lucerna trace can use a device");
  }
  DesignOptions options;
  options.seed = parse_count(a.seed);
  if (!a.time.empty()) options.time_s = parse_number(a.time);
  if (!a.rays.empty()) options.most_rays = parse_count(a.rays);
  if (a.resume) options.checkpoint = read_file(checkpoint, kMostCheckpointBytes);
  return options;
}

/// The lines of an older history, for a design that goes on; nothing if there is none.
std::string older_history(const fs::path& file, bool resume) {
  if (!resume || !fs::exists(file)) return "";
  return read_file(file, kMostCheckpointBytes);
}

std::string joined_history(const std::string& older, const std::vector<FitRecord>& history) {
  const std::string newer = history_csv(history);
  if (older.empty()) return newer;
  return older + newer.substr(newer.find('\n') + 1);
}

Json design_json(const DesignResult& result) {
  Json json;
  json["relative_rms"] = result.error.relative_rms;
  json["floor"] = result.error.floor;
  json["start_relative_rms"] = result.start_error.relative_rms;
  json["scale"] = result.error.scale;
  json["efficiency"] = result.efficiency;
  json["in_window"] = result.in_window;
  json["losses"] = {{"mirror", result.absorbed}, {"mirror_back", result.back}, {"lost", result.lost}};
  json["evaluations"] = result.evaluations;
  json["rays"] = result.rays;
  json["parameters"] = result.shape.parameter_count();
  json["height_mm"] = result.shape.height_mm();
  json["end"] = to_string(result.end);
  json["remarks"] = result.remarks;
  return json;
}

/// Traces the finished project for its photometric files, writes everything, returns the names.
std::vector<std::string> write_results(const DesignArguments& a, const DesignProblem& problem,
                                       const DesignResult& result, const std::string& older, Json json,
                                       const DesignOptions& options, Session& session) {
  const fs::path folder = a.output;
  const Project project = with_shape(problem, result.shape);
  write_file(folder / "reflector.toml", reflector_toml(problem, result.shape));
  const Reflector mirror = result.shape.reflector();
  const Mesh mesh = cad_mesh(mirror);
  write_file(folder / "reflector.stl", stl_bytes(mesh));
  write_file(folder / "reflector.dxf", dxf_profile(cad_profile(mirror)));
  write_file(folder / "history.csv", joined_history(older, result.history));
  write_file(folder / "checkpoint", result.checkpoint);
  TraceOptions trace_options;
  trace_options.seed = options.seed + 1;
  const TraceResult traced =
      session.timed("trace", [&] { return trace(project.scene, trace_options, no_progress()); });
  const TraceFigures figures = trace_figures(traced);
  json.update(trace_json(figures));
  std::vector<std::string> names{"reflector.toml", "reflector.stl", "reflector.dxf", "history.csv",
                                 "checkpoint"};
  for (std::string& name : write_trace_files(folder, trace_origin(project), figures, traced.out_rays, json))
    names.push_back(std::move(name));
  session.print_json(json);
  return names;
}

void run_design(const DesignArguments& a, Session& session, int& exit_code) {
  session.start();
  const fs::path folder = a.output, checkpoint = folder / "checkpoint";
  const DesignOptions options = design_options(a, checkpoint);
  const DesignProblem problem = session.timed(
      "read", [&] { return design_problem(read_project(a.project, session.progress()), a.project); });
  prepare_folder(a.output, session.force || a.resume);
  for (const std::string& warning : problem.project.warnings) session.note(warning);
  for (const auto& input : problem.project.inputs) session.add_input(input);
  const std::string older = older_history(folder / "history.csv", a.resume);
  const DesignObserver observer = [&](const FitRecord&, const DesignShape& best, const std::string& state) {
    write_file(folder / "reflector.toml", reflector_toml(problem, best));
    write_file(checkpoint, state);
  };
  const DesignResult result =
      session.timed("design", [&] { return design(problem, options, session.progress(), observer); });
  Json json = session.json_head(options.seed);
  json.update(design_json(result));
  const auto names = write_results(a, problem, result, older, json, options, session);
  session.say(fmt::format("{}: {} parameters, {} evaluations, {:.3g} M rays in {:.3g} s ({})", a.output,
                          result.shape.parameter_count(), result.evaluations,
                          1e-6 * static_cast<double>(result.rays), session.seconds("design"),
                          to_string(result.end)));
  session.say(
      fmt::format("  difference to the target {:.2f} % (relative RMS; start {:.2f} %, noise {:.2f} %)",
                  100.0 * result.error.relative_rms, 100.0 * result.start_error.relative_rms,
                  100.0 * result.error.floor));
  session.say(fmt::format(
      "  efficiency {:.1f} %, {:.1f} % in the target's window; mirror keeps {:.1f} %, its "
      "back {:.1f} %",
      100.0 * result.efficiency, 100.0 * result.in_window, 100.0 * result.absorbed, 100.0 * result.back));
  for (const std::string& remark : result.remarks) session.say("  " + remark);
  session.say(fmt::format("  written: {}", fmt::join(names, " ")));
  if (!a.report.empty()) {
    write_design_report(folder, a.report);
    session.say(fmt::format("  report: {}", a.report));
  }
  if (result.end == DesignEnd::interrupted) exit_code = 3;
}

}  // namespace

void add_design(CLI::App& app, Session& session, int& exit_code) {
  CLI::App& command = *app.add_subcommand("design", "Find the mirror that makes the project's target");
  auto arguments = std::make_shared<DesignArguments>();
  DesignArguments& a = *arguments;
  command.add_option("PROJECT", a.project, "Project file with [target] and [design]")->required();
  command.add_option("-o,--output", a.output, "Folder for the results")->required();
  command.add_option("--time", a.time, "Seconds after which to stop with the best so far");
  command.add_option("--rays", a.rays, "Rays of the finest evaluations (default 2^20)");
  command.add_option("--seed", a.seed, "Seed of the random numbers")->capture_default_str();
  command.add_option("--report", a.report, "Also write the report as one HTML file");
  command.add_option("--device", a.device, "cpu or auto: designs are made on the CPU")->capture_default_str();
  command.add_flag("--resume", a.resume, "Go on from the folder's checkpoint");
  command.add_flag("--force", session.force, "Write into a folder that is not empty");
  session.add_json(command);
  session.add_common(command);
  command.callback([arguments, &session, &exit_code] { run_design(*arguments, session, exit_code); });
}

}  // namespace lucerna::cli
