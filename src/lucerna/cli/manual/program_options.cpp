// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/manual/program_options.h"

#include <CLI/CLI.hpp>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/parse/arguments.h"

namespace lucerna::cli {

namespace {

/// What checks have added to the type of a value: "TEXT:{0,90}" has choices, "INT:INT in [1 - 4096]" a range.
void add_values(const std::string& type, OptionFacts& facts) {
  const auto inside = [&](const char* open, char close) {
    const std::size_t begin = type.find(open);
    if (begin == std::string::npos) return std::string();
    const std::size_t first = begin + std::string_view(open).size();
    return type.substr(first, type.find(close, first) - first);
  };
  facts.choices = parse_words(inside(":{", '}'));
  facts.range = inside("in [", ']');
}

OptionFacts option_facts(const CLI::Option& option) {
  OptionFacts facts;
  facts.positional = option.get_positional();
  if (facts.positional) facts.names.push_back(option.get_name(true));
  for (const std::string& name : option.get_snames()) facts.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) facts.names.push_back("--" + name);
  facts.help = option.get_description();
  facts.default_value = option.get_default_str();
  facts.flag = option.get_items_expected_max() == 0;
  facts.required = option.get_required();
  facts.several = option.get_items_expected_max() > 1;
  add_values(option.get_type_name(), facts);
  return facts;
}

}  // namespace

std::vector<CommandFacts> program_commands() {
  CLI::App app;
  Session session;
  int exit_code = 0;
  for (const AddCommand add : kCommands) add(app, session, exit_code);
  std::vector<CommandFacts> commands;
  for (const CLI::App* command : app.get_subcommands({})) {
    CommandFacts facts{command->get_name(), command->get_description(), {}};
    for (const CLI::Option* option : command->get_options()) facts.options.push_back(option_facts(*option));
    commands.push_back(std::move(facts));
  }
  return commands;
}

}  // namespace lucerna::cli
