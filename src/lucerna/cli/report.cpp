// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report.h"

#include <fmt/format.h>

#include <filesystem>

#include "lucerna/cli/commands.h"
#include "lucerna/cli/describe.h"
#include "lucerna/cli/model_report.h"
#include "lucerna/core/error.h"

namespace lucerna::cli {

namespace {

struct ReportArguments {
  std::string input, output;
  std::vector<std::string> rays;
};

void model_report(const ReportArguments& a, Session& session) {
  const auto model = session.timed("read", [&] { return load_source_model(a.input); });
  session.add_input(a.input);
  for (const std::string& path : a.rays) session.add_input(path);
  Json json = session.json_head(std::nullopt);
  json.update(describe_model(a.input).json);
  write_model_report(*model, a.input, a.rays, std::move(json), a.output, session);
}

void report(const ReportArguments& a, Session& session) {
  session.start();
  if (is_source_model(a.input)) return model_report(a, session);
  if (!a.rays.empty()) throw UsageError(fmt::format("--rays goes with a model, and {} is none", a.input));
  if (std::filesystem::exists(a.input) && !std::filesystem::is_directory(a.input)) {
    throw InputError(
        fmt::format("{}: is neither a source model (.nfl) nor the folder of a trace or design", a.input));
  }
  write_report(a.input, a.output);
  session.say(fmt::format("{} written, {:.2f} MB: opens in any browser, without a network",
                          a.output, 1e-6 * static_cast<double>(std::filesystem::file_size(a.output))));
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
