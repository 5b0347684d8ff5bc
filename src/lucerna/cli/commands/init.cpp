// SPDX-License-Identifier: Apache-2.0
#include <filesystem>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/project.h"

namespace lucerna::cli {

void add_init(CLI::App& app, Session& session, int&) {
  Command command(app, "init", "Write a commented project file");
  auto output = std::make_shared<std::string>("project.toml");
  command.option("-o,--output", *output, "Where");
  command.flag("--force", session.force, "Replace the file if it is there");
  session.add_common(command);
  command.on_run([output, &session] {
    session.start();
    if (!session.force && std::filesystem::exists(*output)) {
      throw InputError(fmt::format("{}: is there already; give --force to replace it", *output));
    }
    write_file(*output, project_template());
    session.print_line(fmt::format("{} written; next: lucerna trace {} -o result", *output, *output));
  });
}

}  // namespace lucerna::cli
