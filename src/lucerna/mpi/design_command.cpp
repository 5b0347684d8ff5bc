// SPDX-License-Identifier: Apache-2.0
#include "lucerna/mpi/design_command.h"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <thread>
#include <utility>

#include "lucerna/cli/output/design_output.h"
#include "lucerna/cli/parse/design_arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/io/sha256.h"
#include "lucerna/design/lens/lens_problem.h"
#include "lucerna/distributed/distributed_trace.h"
#include "lucerna/distributed/rank_peers.h"
#include "lucerna/mpi/together.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/project/sections/project_content.h"
#include "lucerna/results/folders/design_files.h"
#include "lucerna/trace/run/empty_trace.h"
#include "lucerna/version.h"

namespace lucerna::cli {

namespace {

namespace fs = std::filesystem;

/// Rays that a rank takes at a time of the result's trace: its first round has 2^20.
constexpr std::uint64_t kChunkRays = std::uint64_t{1} << 16;
/// How long another rank leaves it to the first to tell of an error that all of them should have.
constexpr std::chrono::seconds kPatience{2};

/// What all ranks have to have alike: program, instruction set, project and the bytes of its files.
std::string identity(const Project& project) {
  std::ostringstream text;
  text << content_tables(toml_tables(project), project.memory);
  return fmt::format("{} {} {}", version(), best_isa(), sha256_of_text(text.str()));
}

/// The light of the result, traced by all ranks, on the first.
std::optional<NoiseTrace> traced_by_all(Ranks& ranks, const fs::path& folder, const Scene& scene,
                                        const TraceOptions& requested, const NoiseGoal& goal) {
  TraceOptions options = requested;
  options.isa = best_isa();
  const RangeTracer tracer = [&](const RayInterval& rays, Progress& progress) {
    TraceOptions some = options;
    some.first_ray = rays.first;
    some.last_ray = rays.last;
    return trace(scene, some, progress);
  };
  DistributedOptions how;
  how.parts = folder / "no-parts";  // it takes seconds: nothing is written on the way
  how.chunk_rays = kChunkRays;
  how.checkpoint_s = std::numeric_limits<double>::infinity();
  const TraceOrigin origin{"design", std::string(version()), "", 0.0, 0.0};
  DistributedNoise traced =
      trace_until_on_ranks(ranks, scene, empty_trace(scene, options), tracer, origin, how, goal);
  return std::move(traced.result);
}

/// All ranks compute alike, so that bad input is found by each of them: the first one tells of it.
DesignRun designed(const DesignProblem& problem, const DesignOptions& options, const DesignObserver& watch,
                   Session& session, RankPeers& peers, Ranks& ranks) {
  try {
    return run_watched(problem, options, watch, session, peers.progress());
  } catch (const InputError&) {
    if (!ranks.is_first()) std::this_thread::sleep_for(kPatience);
    throw;
  }
}

/// The first rank's checkpoint and history, where a design is to go on; the checkpoint on all ranks.
DesignProgress progress_so_far(const DesignArguments& a, Session& session, Ranks& ranks) {
  DesignProgress start;
  together(ranks, [&] {
    if (!ranks.is_first()) return;
    session.prepare_folder(a.output, session.force || a.resume);
    require_report(a.report);
    if (!a.resume) return;
    start = read_design_progress(a.output);
    if (start.checkpoint.empty()) session.note(fmt::format("{}: no checkpoint yet, starting anew", a.output));
  });
  start.checkpoint = ranks.broadcast(start.checkpoint);
  return start;
}

/// A bad call (UsageError) is the same on all ranks.
DesignOptions agreed_options(const DesignArguments& a, Ranks& ranks) {
  DesignOptions options;
  std::string error;
  try {
    options = design_options(a);
  } catch (const InputError& e) {
    error = e.what();
  }
  agree(ranks, error);
  return options;
}

void run_mpi_design(const DesignArguments& a, Session& session, Ranks& ranks, int& exit_code) {
  session.quiet = session.quiet || !ranks.is_first();
  session.start();
  session.stop_on_signal(SIGUSR1);
  DesignOptions options = agreed_options(a, ranks);
  std::optional<DesignProblem> problem;
  std::string own_identity;
  together(ranks, [&] {
    problem.emplace(session.timed("read", [&] {
      Project project = read_project(a.project, session.progress());
      if (is_lens_design(project))
        throw InputError(fmt::format(
            "{}: found a lens to design, expected a mirror; one process designs lenses", a.project));
      return design_problem(std::move(project), a.project);
    }));
    own_identity = identity(problem->project);
  });
  agree_on_same(ranks, "version, instruction set and project", own_identity);
  if (a.tolerances && !problem->tolerances) problem->tolerances = ToleranceRanges{};
  const DesignProgress start = progress_so_far(a, session, ranks);
  if (ranks.is_first()) {
    for (const std::string& warning : problem->project.warnings) session.note(warning);
    for (const auto& input : problem->project.inputs) session.add_input(input);
  }
  RankPeers peers(ranks, session.progress());
  options.checkpoint = start.checkpoint;
  options.peers = &peers;
  options.final_trace = [&](const Scene& scene, const TraceOptions& how, const NoiseGoal& goal) {
    return traced_by_all(ranks, a.output, scene, how, goal);
  };
  DesignWatch watch(a.output, *problem, start.history, session);
  DesignObserver observer;
  if (ranks.is_first()) {
    observer = [&](const FitRecord& record, const DesignShape& best, const std::string& checkpoint) {
      or_abort(ranks, [&] { watch(record, best, checkpoint); });
    };
  }
  const DesignRun made = designed(*problem, options, observer, session, peers, ranks);
  std::string code = "0";
  together(ranks, [&] {
    if (!ranks.is_first()) return;
    const DesignOutput output{a.output, a.report, options.seed, "cpu", watch.history()};
    code = std::to_string(write_design_output(output, *problem, made, session));
  });
  exit_code = std::stoi(ranks.broadcast(code));
}

}  // namespace

void add_mpi_design(CLI::App& app, Session& session, Ranks& ranks, int& exit_code) {
  Command command(app, "design", "Find the mirror that makes the project's target, on all ranks together");
  auto arguments = std::make_shared<DesignArguments>();
  add_design_options(command, *arguments, session, false);
  command.on_run([arguments, &session, &ranks, &exit_code] {
    or_abort(ranks, [&] { run_mpi_design(*arguments, session, ranks, exit_code); });
  });
}

}  // namespace lucerna::cli
