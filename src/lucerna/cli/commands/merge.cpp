// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/output/trace_output.h"
#include "lucerna/results/folders/trace_file.h"
#include "lucerna/results/metrics/trace_warnings.h"

namespace lucerna::cli {

namespace {

struct MergeArguments {
  std::vector<std::string> folders;
  std::string output;
};

void run_merge(const MergeArguments& a, Session& session) {
  session.start();
  const StoredTrace sum = session.timed("merge", [&] {
    return merge_trace_folders({a.folders.begin(), a.folders.end()}, session.progress());
  });
  for (const std::string& folder : a.folders)
    session.add_input(std::filesystem::path(folder) / kTraceFileName);
  session.prepare_folder(a.output, session.force);
  const TraceMetrics figures = session.timed("figures", [&] { return trace_metrics(sum.result); });
  const auto names =
      write_trace_output(a.output, sum.result, sum.origin, figures, trace_warnings(figures), session);
  session.print_line(fmt::format("{}: {} traces of one scene, rays {}:{} ({})", a.output, a.folders.size(),
                                 sum.result.first_ray, sum.result.last_ray, sum.result.isa));
  print_trace_summary(figures, names, session);
  if (sum.result.first_ray > 0) session.note(fmt::format("rays 0:{} are not in it", sum.result.first_ray));
}

}  // namespace

void add_merge(CLI::App& app, Session& session, int&) {
  Command command(app, "merge", "Add traces of ranges of rays (trace --rays A:B)");
  auto arguments = std::make_shared<MergeArguments>();
  command.required("DIR", arguments->folders, "Folders that lucerna trace has written");
  command.required("-o,--output", arguments->output, "Folder for the sum");
  command.flag("--force", session.force, "Write into a folder that is not empty");
  session.add_json(command);
  session.add_common(command);
  command.on_run([arguments, &session] { run_merge(*arguments, session); });
}

}  // namespace lucerna::cli
