// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>

#include "lucerna/cli/commands.h"
#include "lucerna/report/report_trace.h"

namespace lucerna::cli {

void add_report(CLI::App& app, Session& session, int&) {
  CLI::App& command = *app.add_subcommand("report", "Write the report of a trace as one HTML file");
  auto folder = std::make_shared<std::string>(), output = std::make_shared<std::string>();
  command.add_option("DIR", *folder, "Folder that lucerna trace has written")->required();
  command.add_option("-o,--output", *output, "The HTML file")->required();
  session.add_common(command);
  command.callback([folder, output, &session] {
    session.start();
    write_trace_report(*folder, *output);
    session.say(fmt::format("{} written, {:.2f} MB: opens in any browser, asks nothing of any network",
                            *output, 1e-6 * static_cast<double>(std::filesystem::file_size(*output))));
  });
}

}  // namespace lucerna::cli
