// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/command.h"

#include <CLI/CLI.hpp>

namespace lucerna::cli {

Command::Command(CLI::App& program, const std::string& name, const std::string& help)
    : app_(*program.add_subcommand(name, help)) {}

void Command::required(const std::string& names, std::string& value, const std::string& help) {
  app_.add_option(names, value, help)->required();
}

void Command::required(const std::string& names, std::vector<std::string>& values, const std::string& help) {
  app_.add_option(names, values, help)->required();
}

void Command::option(const std::string& names, std::string& value, const std::string& help,
                     const std::vector<std::string>& choices) {
  CLI::Option* option = app_.add_option(names, value, help);
  if (!choices.empty()) option->check(CLI::IsMember(choices));
  if (!value.empty()) option->capture_default_str();
}

void Command::option(const std::string& names, std::vector<std::string>& values, const std::string& help) {
  app_.add_option(names, values, help);
}

void Command::option(const std::string& names, int& value, const std::string& help, int min, int max) {
  app_.add_option(names, value, help)->check(CLI::Range(min, max));
}

void Command::repeated(const std::string& names, std::vector<std::string>& values, const std::string& help) {
  app_.add_option(names, values, help)->allow_extra_args(false);
}

void Command::flag(const std::string& names, bool& value, const std::string& help) {
  app_.add_flag(names, value, help);
}

void Command::exclusive(const std::string& name, const std::string& other) {
  app_.get_option(name)->excludes(app_.get_option(other));
}

void Command::on_run(std::function<void()> work) { app_.callback(std::move(work)); }

}  // namespace lucerna::cli
