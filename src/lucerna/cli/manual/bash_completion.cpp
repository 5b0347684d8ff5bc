// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/manual/bash_completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "lucerna/cli/manual/program_options.h"
#include "lucerna/ray_file.h"

namespace lucerna::cli {

namespace {

/// Words that an option or argument takes, where the parser does not know them.
std::vector<std::string> known_words(const CommandFacts& command, const OptionFacts& option) {
  const std::string& name = option.names.back();
  if (name == "--device") return {"auto", "cpu", "cuda"};
  if (name == "--sequence") return {"random", "sobol"};
  if (name == "--method") return {"adaptive", "clusters"};
  if (name == "--surface") return {"none", "sphere", "cylinder", "box", "plane"};
  if (name == "KIND")
    return {"point", "disk",     "rectangle", "cylinder", "sphere", "filament",
            "led",   "phong500", "phong25",   "radial",   "cosine"};
  if (name != "--to" && name != "--from" && name != "--format") return option.choices;
  std::vector<std::string> formats(ray_formats().begin(), ray_formats().end());
  if (name == "--to" && command.name == "convert")
    formats.insert(formats.end(), {"ies-2002", "ies-2019", "ldt"});
  return formats;
}

bool takes_files(const CommandFacts& command, const OptionFacts& option) {
  const std::string& name = option.names.back();
  return option.positional || name == "--output" || name == "--report" ||
         (name == "--rays" && command.name == "report");
}

/// The shell words that complete a value: a call of one of the functions of kFunctions; nothing for numbers.
std::string completion_call(const CommandFacts& command, const OptionFacts& option) {
  if (const auto words = known_words(command, option); !words.empty())
    return fmt::format("_lucerna_words '{}'", fmt::join(words, " "));
  return takes_files(command, option) ? "_lucerna_files" : ":";
}

std::string value_case(const CommandFacts& command, const OptionFacts& option) {
  std::vector<std::string> patterns;
  for (const std::string& name : option.names) patterns.push_back(command.name + "," + name);
  return fmt::format("    {}) {}; return ;;\n", fmt::join(patterns, " | "), completion_call(command, option));
}

/// What its first argument takes, "<files>" or words, and all its options.
std::string command_case(const CommandFacts& command) {
  std::vector<std::string> names;
  std::string argument;
  for (const OptionFacts& option : command.options) {
    if (!option.positional) {
      names.insert(names.end(), option.names.begin(), option.names.end());
    } else if (argument.empty()) {
      const auto words = known_words(command, option);
      argument = words.empty() ? "<files>" : fmt::format("{}", fmt::join(words, " "));
    }
  }
  return fmt::format("    {}) options='{}' argument='{}' ;;\n", command.name, fmt::join(names, " "),
                     argument);
}

constexpr std::string_view kFunctions = R"(# SPDX-License-Identifier: Apache-2.0
# Completion of lucerna for bash, written by the program's build from its own options.

_lucerna_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$current"); }

_lucerna_files() {
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -f -- "$current")
}

)";

constexpr std::string_view kWordInQuestion = R"(
_lucerna() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
  local options='' argument=''
  COMPREPLY=()
  # --option=value comes as three words.
  if [[ $current == '=' ]]; then
    current=''
  elif [[ $previous == '=' ]] && ((COMP_CWORD > 2)); then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
)";

constexpr std::string_view kRest = R"(
  if [[ $current == -* || -z $argument ]]; then
    _lucerna_words "$options"
  elif [[ $argument == '<files>' ]]; then
    _lucerna_files
  else
    _lucerna_words "$argument"
  fi
}

)";

}  // namespace

std::string bash_completion() {
  const std::vector<CommandFacts> commands = program_commands();
  std::vector<std::string> names;
  std::string values, cases;
  for (const CommandFacts& command : commands) {
    names.push_back(command.name);
    for (const OptionFacts& option : command.options) {
      if (!option.positional && !option.flag) values += value_case(command, option);
    }
    cases += command_case(command);
  }
  return std::string(kFunctions) + std::string(kWordInQuestion).substr(1) +
         fmt::format(
             "  if ((COMP_CWORD == 1)); then\n    _lucerna_words '{} -h --help --version'\n    return\n  "
             "fi\n",
             fmt::join(names, " ")) +
         "  case $command,$previous in\n" + values + "  esac\n" + "  case $command in\n" + cases +
         "    *) return ;;\n  esac\n" + std::string(kRest).substr(1) + "complete -F _lucerna lucerna\n";
}

}  // namespace lucerna::cli
