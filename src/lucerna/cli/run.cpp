// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/run.h"

#include <CLI/CLI.hpp>
#include <string>

#include "lucerna/core/version.h"

namespace lucerna::cli {

int run(int argc, char** argv) {
  CLI::App app{"Lucerna: from ray file to reflector", "lucerna"};
  app.set_version_flag("--version", std::string(version()));
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  return 0;
}

}  // namespace lucerna::cli
