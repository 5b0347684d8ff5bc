// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/manual/cli_reference.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <string_view>

#include "lucerna/cli/commands/run.h"
#include "lucerna/cli/parse/session.h"

namespace lucerna::cli {

namespace {

constexpr std::string_view kHead = R"(# Command line

`lucerna COMMAND ...` does one thing. `lucerna COMMAND --help` prints what is below.
Counts may be written as `1e6`. Results go to standard output, warnings and errors to standard
error; `info` and `check` list what they find in files with their results. An error is one line: the
file, the place, what was found and what was expected.

This page is written by `make reference` from the program's parser.

## Exit codes

| code | meaning |
|---|---|
| 0 | done |
| 1 | bad input, no memory, no device, or a check failed: a limit that is not held, a zone that is missed or not determined, a file with faults |
| 2 | the command line itself is wrong |
| 3 | interrupted by Ctrl-C or SIGTERM; what was whole has been written. A second Ctrl-C ends at once |
)";

/// A cell of a table: no bar, no end of line.
std::string cell(std::string text) {
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  for (std::size_t i = text.find('|'); i != std::string::npos; i = text.find('|', i + 2))
    text.insert(i, 1, '\\');
  return text;
}

std::string names_of(const CLI::Option& option) {
  if (!option.nonpositional())
    return option.get_name(true) + (option.get_items_expected_max() > 1 ? "..." : "");
  std::string names;
  for (const std::string& s : option.get_snames()) names += (names.empty() ? "-" : ", -") + s;
  for (const std::string& l : option.get_lnames()) names += (names.empty() ? "--" : ", --") + l;
  return names;
}

std::string default_of(const CLI::Option& option) {
  if (option.get_required()) return "required";
  const std::string text = option.get_default_str();
  return text.empty() ? "" : fmt::format("`{}`", text);
}

std::string sentence(const std::string& text) { return text.ends_with('.') ? text : text + "."; }

/// "TEXT:{json,html}" or "INT:INT in [1 - 4096]": what stands behind the colon says which values are taken.
std::string values_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':');
  return colon == std::string::npos ? "" : fmt::format(" Values: {}.", type.substr(colon + 1));
}

std::string section(const CLI::App& command) {
  std::string text = fmt::format("\n## {}\n\n{}.\n\n| option | default | meaning |\n|---|---|---|\n",
                                 command.get_name(), command.get_description());
  for (const CLI::Option* option : command.get_options()) {
    text += fmt::format("| `{}` | {} | {} |\n", names_of(*option), default_of(*option),
                        cell(sentence(option->get_description()) + values_of(*option)));
  }
  return text;
}

}  // namespace

std::string cli_reference() {
  CLI::App app;
  Session session;
  int exit_code = 0;
  set_up(app, session, exit_code);
  std::string text(kHead);
  for (const CLI::App* command : app.get_subcommands({})) text += section(*command);
  return text;
}

}  // namespace lucerna::cli
