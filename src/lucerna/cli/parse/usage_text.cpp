// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/usage_text.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "lucerna/core/io/spelling.h"

namespace lucerna::cli {

namespace {

std::string question(const std::string& meant) {
  return meant.empty() ? "" : fmt::format("; did you mean {}?", meant);
}

WordSet command_names(const CLI::App& app) {
  WordSet names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.insert(command->get_name());
  return names;
}

WordSet option_names(const CLI::App& command) {
  WordSet names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.insert("--" + name);
  }
  return names;
}

/// The first word of the line that `command` did not take; empty if it took all. The parser has them in no
/// order of its own.
std::string first_unknown(const CLI::App& command, const std::vector<std::string>& words) {
  const std::vector<std::string> unknown = command.remaining();
  const auto is_unknown = [&](const std::string& word) { return std::ranges::count(unknown, word) > 0; };
  const auto is_option = [&](const std::string& word) { return word.starts_with('-') && is_unknown(word); };
  auto found = std::ranges::find_if(words, is_option);  // its value is left over, too
  if (found == words.end()) found = std::ranges::find_if(words, is_unknown);
  return found == words.end() ? "" : *found;
}

std::string unknown_word(const CLI::App& command, const std::string& word) {
  if (!word.starts_with('-')) return fmt::format("unexpected argument \"{}\"", word);
  const std::string name = word.substr(0, word.find('='));
  return fmt::format("unknown option \"{}\"{}", name, question(meant_word(name, option_names(command))));
}

}  // namespace

std::string usage_text(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv) {
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  const std::vector<CLI::App*> given = app.get_subcommands();
  if (given.empty()) {
    const std::string help = fmt::format("; see {} --help", app.get_name());
    if (words.empty()) return "no command" + help;
    const bool option = words.front().starts_with('-');
    const std::string meant = meant_word(words.front(), option ? option_names(app) : command_names(app));
    return fmt::format("unknown {} \"{}\"{}{}", option ? "option" : "command", words.front(), question(meant),
                       help);
  }
  const CLI::App& command = *given.front();
  const std::string unknown = first_unknown(command, words);
  const std::string what = unknown.empty() ? std::string(error.what()) : unknown_word(command, unknown);
  return fmt::format("{}; see {} {} --help", what, app.get_name(), command.get_name());
}

}  // namespace lucerna::cli
