// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace lucerna::cli {

/// One option or positional argument of a command, as the parser knows it.
struct OptionFacts {
  /// "-o", "--output"; for a positional argument its name alone, "FILE".
  std::vector<std::string> names;
  std::string help;
  /// Written as help texts do, "1"; empty: none.
  std::string default_value;
  /// What is taken, if it is one of a few words.
  std::vector<std::string> choices;
  /// What numbers are taken, "1 - 4096"; empty: any.
  std::string range;
  bool positional = false, flag = false, required = false, several = false;
};

/// One command of the program.
struct CommandFacts {
  std::string name, help;
  /// In the order of the help text.
  std::vector<OptionFacts> options;
};

/// All commands in the order of `lucerna --help`, from the parser itself: what manual pages and completion
/// are made of.
std::vector<CommandFacts> program_commands();

}  // namespace lucerna::cli
