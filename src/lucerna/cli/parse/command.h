// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lucerna::cli {

/// One command of the program while its options are told; the parser keeps them. The only face of the parsing
/// library towards the commands: its headers cost seconds in each file that includes them. Names are
/// "-o,--output" or, for what stands without a dash, "FILE". Values are written when the line is parsed.
class Command {
 public:
  Command(CLI::App& program, const std::string& name, const std::string& help);

  /// Must be given; a vector takes one word or more.
  void required(const std::string& names, std::string& value, const std::string& help);
  void required(const std::string& names, std::vector<std::string>& values, const std::string& help);
  /// May be given; what `value` holds is the default. With `choices`, one of them.
  void option(const std::string& names, std::string& value, const std::string& help,
              const std::vector<std::string>& choices = {});
  void option(const std::string& names, std::vector<std::string>& values, const std::string& help);
  /// A whole number from `min` to `max`.
  void option(const std::string& names, int& value, const std::string& help, int min, int max);
  /// Takes one word each time that it is given.
  void repeated(const std::string& names, std::vector<std::string>& values, const std::string& help);
  void flag(const std::string& names, bool& value, const std::string& help);
  /// Of two options that are there already, one at most may be given.
  void exclusive(const std::string& name, const std::string& other);
  /// What the command does, once the line is parsed.
  void on_run(std::function<void()> work);

 private:
  CLI::App& app_;
};

}  // namespace lucerna::cli
