// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/compress_arguments.h"

#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/temp_dir.h"

namespace lucerna::cli {
namespace {

CompressArguments model_arguments() {
  CompressArguments a;
  a.inputs = {"rays.txt"};
  a.output = "model.nfl";
  return a;
}

TEST(CompressArguments, AreReadFromTheirWords) {
  CompressArguments a = model_arguments();
  a.method = "clusters";
  a.max_bytes = "64k";
  a.flux = "1.5e3";
  a.seed = "7";
  const CompressOptions options = compress_options(a);
  EXPECT_EQ(options.method, CompressMethod::clusters);
  EXPECT_EQ(options.max_bytes, 64'000U);
  EXPECT_EQ(options.flux, 1500.0);
  EXPECT_EQ(options.seed, 7U);
  EXPECT_FALSE(compress_options(model_arguments()).flux || compress_options(model_arguments()).max_bytes);
}

TEST(CompressArguments, WhatCannotBeIsRefusedByTheWordsAlone) {
  const auto refused = [](auto&& change) {
    CompressArguments a = model_arguments();
    change(a);
    EXPECT_THROW(static_cast<void>(compress_options(a)), UsageError);
  };
  refused([](auto& a) { a.output = "model.bin"; });
  refused([](auto& a) { a.flux = "0"; });
  refused([](auto& a) { a.method = "trees"; });
  refused([](auto& a) { a.held_out = "some"; });
  refused([](auto& a) { a.max_bytes = "64q"; });
}

TEST(CompressArguments, InputsAndResultsAreCheckedBeforeTheWork) {
  const test::TempDir dir;
  write_file(dir / "rays.txt", "0 0 0 0 0 1 1\n");
  write_file(dir / "project.toml", "");
  CompressArguments a = model_arguments();
  a.inputs = {(dir / "rays.txt").string()};
  a.output = (dir / "model.nfl").string();
  EXPECT_NO_THROW(check_compress(a));
  a.output = (dir / "absent" / "model.nfl").string();
  EXPECT_THROW(check_compress(a), InputError);
  a.output = (dir / "model.nfl").string();
  a.inputs.push_back((dir / "project.toml").string());
  EXPECT_THROW(check_compress(a), InputError);
}

}  // namespace
}  // namespace lucerna::cli
