// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/core/io/error.h"
#include "lucerna/results/json/run_json.h"
#include "lucerna/source_model.h"

namespace lucerna::cli {

namespace {

struct ReportArguments {
  std::string input, output;
  std::vector<std::string> rays;
};

void report(const ReportArguments& a, Session& session) {
  session.start();
  require_report(a.output);
  if (!a.rays.empty() && !is_source_model(a.input)) {
    throw UsageError(fmt::format("--rays goes with a model, and {} is none", a.input));
  }
  write_report(a.input, a.output, {a.rays.begin(), a.rays.end()}, session.record(), session.progress());
  session.print_line(fmt::format("{} written, {:.2f} MB: opens in any browser, without a network", a.output,
                                 1e-6 * static_cast<double>(std::filesystem::file_size(a.output))));
}

}  // namespace

void add_report(CLI::App& app, Session& session, int&) {
  Command command(app, "report", "Write the report of a trace, a design or a source model as one HTML file");
  auto arguments = std::make_shared<ReportArguments>();
  ReportArguments& a = *arguments;
  command.required("DIR", a.input, "Folder that lucerna trace or design has written, or a model (.nfl)");
  command.required("-o,--output", a.output, "The HTML file");
  command.option("--rays", a.rays, "Ray files that a model is to be compared with");
  session.add_common(command);
  command.on_run([arguments, &session] { report(*arguments, session); });
}

}  // namespace lucerna::cli
