// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/commands/run.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <new>
#include <string>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/core/io/error.h"
#include "lucerna/version.h"

namespace lucerna::cli {

namespace {

enum ExitCode { kDone = 0, kBadInput = 1, kUsage = 2, kInterrupted = 3 };

int report_error(const char* text, ExitCode code) {
  fmt::print(stderr, "lucerna: {}\n", text);
  return code;
}

/// The command's option that the error says would help, as a hint; empty if the command has none. Formats are
/// chosen where a file is written (a bad call) and where one is read (bad input).
std::string hint(const Error& error, const CLI::App& app, ExitCode code) {
  if (error.option().empty() || app.get_subcommands().empty()) return "";
  const std::string format = code == kUsage ? "to" : "from";
  const std::string name = "--" + (error.option() == "format" ? format : std::string(error.option()));
  const bool known = app.get_subcommands().front()->get_option_no_throw(name) != nullptr;
  return known ? "; see " + name : "";
}

int report_error(const Error& error, const CLI::App& app, ExitCode code) {
  return report_error((error.what() + hint(error, app, code)).c_str(), code);
}

}  // namespace

void set_up(CLI::App& app, Session& session, int& exit_code) {
  app.name("lucerna");
  app.description("Lucerna: from ray file to reflector");
  app.set_version_flag("--version", std::string(version()));
  app.require_subcommand(1);
  for (const AddCommand add : kCommands) add(app, session, exit_code);
}

int run(int argc, char** argv) {
  CLI::App app;
  Session session;
  session.set_command(argc, argv);
  int exit_code = kDone;
  set_up(app, session, exit_code);
  try {
    app.parse(argc, argv);
    return exit_code;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kUsage;
  } catch (const UsageError& e) {
    return report_error(e, app, kUsage);
  } catch (const Interrupted&) {
    return report_error("interrupted", kInterrupted);
  } catch (const Error& e) {
    return report_error(e, app, kBadInput);
  } catch (const std::bad_alloc&) {
    return report_error("out of memory", kBadInput);
  } catch (const std::exception& e) {
    return report_error(e.what(), kBadInput);
  }
}

}  // namespace lucerna::cli
