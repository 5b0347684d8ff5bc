// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/run_program.h"

/// What `lucerna COMMAND --help` says, in parts.
namespace lucerna::test {

inline std::vector<std::string> lines_in(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// The first words of the indented lines below a heading of a help text.
inline std::vector<std::string> listed_below(const std::string& help, const std::string& title) {
  std::vector<std::string> words;
  bool inside = false;
  for (const std::string& line : lines_in(help)) {
    if (!line.starts_with(' ')) inside = line == title;
    if (inside && line.starts_with("  ") && line.size() > 2 && line[2] != ' ')
      words.push_back(line.substr(2, line.find_first_of(" ,", 2) - 2));
  }
  return words;
}

/// "--output" and "-o" of the lines "  -o,--output TEXT ...", and the arguments of a help text.
inline std::set<std::string> names_in_help(const std::string& help) {
  std::set<std::string> names;
  for (const std::string& line : lines_in(help)) {
    if (!line.starts_with("  -")) continue;
    std::istringstream in(line.substr(2, line.find(' ', 2) - 2));
    for (std::string name; std::getline(in, name, ',');) names.insert(name);
  }
  for (const std::string& name : listed_below(help, "Positionals:")) names.insert(name);
  return names;
}

inline std::string help_of(const std::string& command) {
  const TempDir dir;
  return run_lucerna(dir.path(), command + " --help").out;
}

inline std::vector<std::string> commands_in_help() { return listed_below(help_of(""), "Subcommands:"); }

}  // namespace lucerna::test
