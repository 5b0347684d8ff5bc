// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/usage_text.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace lucerna::cli {
namespace {

/// What is said of a line to a program of one command, `trace`, with the option --rays.
std::string said_of(std::vector<const char*> words) {
  CLI::App app("", "program");
  app.require_subcommand(1);
  std::string rays;
  app.add_subcommand("trace", "")->add_option("--rays", rays)->required();
  words.insert(words.begin(), "program");
  const int count = static_cast<int>(words.size());
  try {
    app.parse(count, words.data());
  } catch (const CLI::ParseError& e) {
    return usage_text(app, e, count, words.data());
  }
  return {};
}

TEST(UsageText, NamesTheWordAndTheOneThatMayBeMeant) {
  EXPECT_EQ(said_of({"trcae"}), "unknown command \"trcae\"; did you mean trace?; see program --help");
  EXPECT_EQ(said_of({"trace", "--rayz", "5"}),
            "unknown option \"--rayz\"; did you mean --rays?; see program trace --help");
  EXPECT_EQ(said_of({"trace", "--rays", "5", "more"}),
            "unexpected argument \"more\"; see program trace --help");
  EXPECT_EQ(said_of({}), "no command; see program --help");
  EXPECT_NE(said_of({"trace"}).find("--rays"), std::string::npos) << "what is missing";
  EXPECT_EQ(said_of({"trace", "--rays", "5"}), "");
}

}  // namespace
}  // namespace lucerna::cli
