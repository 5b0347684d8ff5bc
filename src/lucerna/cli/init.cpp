// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "lucerna/cli/commands.h"
#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/trace/project.h"

namespace lucerna::cli {

void add_init(CLI::App& app, Session& session, int&) {
  CLI::App& command = *app.add_subcommand("init", "Write a commented project file");
  auto output = std::make_shared<std::string>("project.toml");
  command.add_option("-o,--output", *output, "Where")->capture_default_str();
  command.add_flag("--force", session.force, "Replace the file if it is there");
  session.add_common(command);
  command.callback([output, &session] {
    session.start();
    if (!session.force && std::filesystem::exists(*output)) {
      throw InputError(fmt::format("{}: is there already; give --force to replace it", *output));
    }
    write_file(*output, project_template());
    session.say(fmt::format("{} written; next: lucerna trace {} -o result", *output, *output));
  });
}

}  // namespace lucerna::cli
