// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace lucerna::cli {
namespace {

using testing::ElementsAre;

/// A command with one of each, and a line that is parsed.
struct Parsed {
  explicit Parsed(const std::string& line) {
    Command command(app, "do", "Does it");
    command.required("FILE", files, "Files");
    command.option("--kind", kind, "Kind", {"good", "better"});
    command.option("--names", names, "Names");
    command.option("--count", count, "Count", 1, 9);
    command.repeated("--add", added, "More");
    command.flag("--force", force, "Force");
    command.exclusive("--count", "--kind");
    command.on_run([this] { ++runs; });
    app.parse(line);
  }
  CLI::App app;
  std::vector<std::string> files, names, added;
  std::string kind = "good";
  int count = 3, runs = 0;
  bool force = false;
};

TEST(Command, ValuesAreWrittenWhereTheyBelong) {
  const Parsed p("do a b --kind better --add x --add y --force");
  EXPECT_THAT(p.files, ElementsAre("a", "b"));
  EXPECT_EQ(p.kind, "better");
  EXPECT_THAT(p.added, ElementsAre("x", "y"));
  EXPECT_TRUE(p.force);
  EXPECT_EQ(p.count, 3) << "the default stays";
  EXPECT_EQ(p.runs, 1);
}

TEST(Command, ARepeatedOptionTakesOneWordAtATime) {
  const Parsed p("do a --add x b");
  EXPECT_THAT(p.added, ElementsAre("x"));
  EXPECT_THAT(p.files, ElementsAre("a", "b"));
  EXPECT_THAT(Parsed("do a --names x y").names, ElementsAre("x", "y"));
}

TEST(Command, WhatCannotBeIsRefused) {
  for (const char* line : {"do", "do a --kind best", "do a --count 10", "do a --count 0", "do a --count two",
                           "do a --count 3 --kind good", "do a --unknown"})
    EXPECT_THROW(Parsed{line}, CLI::ParseError) << line;
}

}  // namespace
}  // namespace lucerna::cli
