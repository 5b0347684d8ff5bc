// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "lucerna/cli/commands/run.h"
#include "lucerna/mpi/compress_command.h"
#include "lucerna/mpi/design_command.h"
#include "lucerna/mpi/mpi_ranks.h"
#include "lucerna/mpi/trace_command.h"
#include "lucerna/version.h"

namespace {

int run(int argc, char** argv) {
  lucerna::MpiRanks ranks(argc, argv);
  CLI::App app("Lucerna on many machines", "lucerna-mpi");
  app.set_version_flag("--version", std::string(lucerna::version()));
  app.require_subcommand(1);
  lucerna::cli::Session session;
  session.set_command("lucerna-mpi", argc, argv);
  int exit_code = 0;
  lucerna::cli::add_mpi_compress(app, session, ranks);
  lucerna::cli::add_mpi_trace(app, session, ranks);
  lucerna::cli::add_mpi_design(app, session, ranks, exit_code);
  return lucerna::cli::parse_and_run(app, argc, argv, exit_code, ranks.is_first());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {  // the options' description, which parse_and_run does not see
    std::fprintf(stderr, "lucerna-mpi: %s\n", e.what());
    return 1;
  }
}
