// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/design_arguments.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "lucerna/core/io/error.h"

namespace lucerna::cli {
namespace {

TEST(DesignArguments, AreReadFromTheirWords) {
  DesignArguments a;
  a.seed = "7", a.time = "2.5", a.rays = "1e6";
  a.pareto = true;
  const DesignOptions options = design_options(a);
  EXPECT_EQ(options.seed, 7U);
  EXPECT_EQ(options.time_s, 2.5);
  EXPECT_EQ(options.max_rays, 1'000'000U);
  EXPECT_EQ(options.validation_rays, 4'000'000U);
  EXPECT_TRUE(options.pareto);
  EXPECT_FALSE(options.advise);
}

TEST(DesignArguments, WithoutWordsTheDefaultsStay) {
  const DesignOptions options = design_options({}), defaults;
  EXPECT_EQ(options.max_rays, defaults.max_rays);
  EXPECT_EQ(options.validation_rays, defaults.validation_rays);
  EXPECT_FALSE(options.time_s);
}

TEST(DesignArguments, WhatCannotBeIsRefused) {
  const auto refused = [](auto&& change) {
    DesignArguments a;
    change(a);
    EXPECT_THROW(static_cast<void>(design_options(a)), UsageError);
  };
  refused([](auto& a) { a.time = "0"; });
  refused([](auto& a) { a.time = "-1"; });
  refused([](auto& a) { a.time = "soon"; });
  refused([](auto& a) { a.rays = "many"; });
  refused([](auto& a) { a.seed = "one"; });
  DesignArguments few;
  few.rays = "100";
  EXPECT_THROW(static_cast<void>(design_options(few)), InputError);
}

TEST(DesignArguments, TheDeviceIsAskedForWhereThereIsAChoice) {
  for (const bool device : {true, false}) {
    CLI::App app;
    Session session;
    DesignArguments a;
    Command command(app, "design", "Find it");
    add_design_options(command, a, session, device);
    const std::string line = "design p.toml -o out --device cpu";
    if (device) {
      EXPECT_NO_THROW(app.parse(line));
      EXPECT_EQ(a.device, "cpu");
      EXPECT_EQ(a.project, "p.toml");
    } else {
      EXPECT_THROW(app.parse(line), CLI::ParseError);
    }
  }
}

}  // namespace
}  // namespace lucerna::cli
