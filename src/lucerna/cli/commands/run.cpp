// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/commands/run.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <new>
#include <string>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/parse/usage_text.h"
#include "lucerna/core/io/error.h"
#include "lucerna/version.h"

namespace lucerna::cli {

namespace {

enum ExitCode { kDone = 0, kBadInput = 1, kUsage = 2, kInterrupted = 3 };

int report_error(const char* text, ExitCode code) {
  fmt::print(stderr, "lucerna: {}\n", text);
  return code;
}

/// The command's option that the error says would help, as a hint; empty if the command has none, but for
/// damaged files, which `convert` makes whole. Formats are chosen where a file is written (a bad call) and
/// where one is read (bad input).
std::string hint(const Error& error, const CLI::App& app, ExitCode code) {
  if (error.option().empty() || app.get_subcommands().empty()) return "";
  const std::string format = code == kUsage ? "to" : "from";
  const std::string name = "--" + (error.option() == "format" ? format : std::string(error.option()));
  const bool known = app.get_subcommands().front()->get_option_no_throw(name) != nullptr;
  if (known) return "; see " + name;
  return error.option() == "salvage" ? "; see lucerna convert --salvage" : "";
}

/// "--rays: " where the text begins with a quoted word that this option was given; else nothing.
std::string given_to(const std::string& text, const CLI::App& app) {
  if (!text.starts_with('\'') || app.get_subcommands().empty()) return "";
  const std::string word = text.substr(1, text.find('\'', 1) - 1);
  for (const CLI::Option* option : app.get_subcommands().front()->get_options()) {
    for (const std::string& given : option->results()) {
      if (word.empty() ? given.empty() : given.find(word) != std::string::npos)
        return option->get_name() + ": ";
    }
  }
  return "";
}

}  // namespace

void set_up(CLI::App& app, Session& session, int& exit_code) {
  app.name("lucerna");
  app.description("Lucerna: from ray file to reflector");
  app.set_version_flag("--version", std::string(version()));
  app.require_subcommand(1);
  for (const AddCommand add : kCommands) add(app, session, exit_code);
}

int parse_and_run(CLI::App& app, int argc, char** argv, const int& exit_code, bool tell) {
  const auto failed = [tell](const std::string& text, ExitCode code) {
    return tell ? report_error(text.c_str(), code) : code;
  };
  try {
    app.parse(argc, argv);
    return exit_code;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) return failed(usage_text(app, e, argc, argv), kUsage);
    if (tell) app.exit(e);  // --help, --version
    return kDone;
  } catch (const UsageError& e) {
    return failed(given_to(e.what(), app) + e.what() + hint(e, app, kUsage), kUsage);
  } catch (const Interrupted&) {
    return failed("interrupted", kInterrupted);
  } catch (const Error& e) {
    return failed(e.what() + hint(e, app, kBadInput), kBadInput);
  } catch (const std::bad_alloc&) {
    return failed("out of memory", kBadInput);
  } catch (const std::exception& e) {
    return failed(e.what(), kBadInput);
  }
}

int run(int argc, char** argv) {
  CLI::App app;
  Session session;
  session.set_command("lucerna", argc, argv);
  int exit_code = kDone;
  set_up(app, session, exit_code);
  return parse_and_run(app, argc, argv, exit_code);
}

}  // namespace lucerna::cli
