// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/manual/program_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "lucerna/cli/commands/commands.h"

namespace lucerna::cli {
namespace {

const OptionFacts& option_of(const CommandFacts& command, const std::string& name) {
  const auto found = std::ranges::find_if(command.options, [&](const OptionFacts& o) {
    return std::ranges::find(o.names, name) != o.names.end();
  });
  if (found == command.options.end()) throw std::out_of_range(name);
  return *found;
}

TEST(ProgramOptions, AreThoseOfTheParser) {
  const auto commands = program_commands();
  EXPECT_EQ(commands.size(), kCommands.size());
  const auto trace = std::ranges::find(commands, "trace", &CommandFacts::name);
  ASSERT_NE(trace, commands.end());
  EXPECT_FALSE(trace->help.empty());
  const OptionFacts& project = option_of(*trace, "PROJECT");
  EXPECT_TRUE(project.positional && project.required && !project.flag);
  EXPECT_THAT(option_of(*trace, "-o").names, testing::ElementsAre("-o", "--output"));
  EXPECT_TRUE(option_of(*trace, "--force").flag);
  const auto info = std::ranges::find(commands, "info", &CommandFacts::name);
  EXPECT_TRUE(option_of(*info, "FILE").several);
  EXPECT_EQ(option_of(*info, "--ies-turn").default_value, "0");
  EXPECT_THAT(option_of(*info, "--ies-turn").choices, testing::ElementsAre("0", "90"));
}

}  // namespace
}  // namespace lucerna::cli
