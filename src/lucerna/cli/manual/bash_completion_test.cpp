// SPDX-License-Identifier: Apache-2.0
// What bash offers against what the program itself says: `lucerna COMMAND --help`.
#include "lucerna/cli/manual/bash_completion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lucerna/bounding_surface.h"
#include "lucerna/core/io/file.h"
#include "lucerna/random.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "lucerna/source_model.h"
#include "lucerna/trace.h"
#include "tests/support/help_text.h"

namespace lucerna::cli {
namespace {

using test::commands_in_help, test::help_of, test::lines_in, test::names_in_help;
using testing::Contains;
using testing::UnorderedElementsAre;

/// What bash would offer for the last of `words`, one a line.
std::vector<std::string> completions(const std::string& words, const std::string& files = "") {
  const test::TempDir dir;
  write_file(dir / "lucerna.bash", bash_completion());
  write_file(dir / "ask.bash",
             ". ./lucerna.bash\nCOMP_WORDS=(lucerna " + words +
                 ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_lucerna\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
  const std::string command = "cd '" + dir.path().string() + "' && mkdir place && " +
                              (files.empty() ? "" : "touch " + files + " && ") +
                              "bash ask.bash >out 2>err </dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0) << test::slurp(dir / "err");
  EXPECT_EQ(test::slurp(dir / "err"), "");
  return lines_in(test::slurp(dir / "out"));
}

bool has_bash() {
  return std::system("bash -c 'complete -p >/dev/null; mapfile </dev/null' 2>/dev/null") == 0;
}

TEST(CompletionCli, OffersEveryCommandAndItsOptions) {
  if (!has_bash()) GTEST_SKIP() << "no bash";
  const auto offered = completions("''");
  for (const std::string& command : commands_in_help()) {
    EXPECT_THAT(offered, Contains(command));
    const auto options = completions(command + " -");
    for (const std::string& name : names_in_help(help_of(command))) {
      if (!name.starts_with('-')) continue;
      EXPECT_THAT(options, Contains(name)) << command;
    }
  }
}

TEST(CompletionCli, FollowsWhatIsTyped) {
  if (!has_bash()) GTEST_SKIP() << "no bash";
  EXPECT_THAT(completions("tr"), UnorderedElementsAre("trace"));
  EXPECT_THAT(completions("compress --method a"), UnorderedElementsAre("adaptive"));
  EXPECT_THAT(completions("compress --method = cl"), UnorderedElementsAre("clusters"));
  EXPECT_THAT(completions("convert --ies-turn ''"), UnorderedElementsAre("0", "90"));
  EXPECT_THAT(completions("make-source phong"), UnorderedElementsAre("phong500", "phong25"));
  EXPECT_THAT(completions("trace --seed ''"), UnorderedElementsAre(""));
  EXPECT_THAT(completions("trace lamp", "lamp.toml 'lamp two.toml' other"),
              UnorderedElementsAre("lamp.toml", "lamp two.toml"));
  EXPECT_THAT(completions("trace lamp.toml -o pl", "lamp.toml"), UnorderedElementsAre("place"));
}

// Words that the parser does not know, but the library does.
TEST(CompletionCli, OffersWordsThatAreTaken) {
  if (!has_bash()) GTEST_SKIP() << "no bash";
  for (const auto& word : completions("make-source ''")) EXPECT_NO_THROW((void)emitter_kind(word));
  for (const auto& word : completions("trace --sequence ''")) EXPECT_NO_THROW((void)sequence_kind(word));
  for (const auto& word : completions("trace --device ''")) EXPECT_NO_THROW((void)trace_device(word));
  for (const auto& word : completions("compress --method ''")) EXPECT_NO_THROW((void)compress_method(word));
  for (const auto& word : completions("make-source --surface ''")) EXPECT_NO_THROW((void)surface_kind(word));
  const auto formats = completions("info --format ''");
  EXPECT_EQ(formats.size(), ray_formats().size());
  for (const auto& word : formats) EXPECT_NO_THROW((void)ray_file_ending(word));
}

}  // namespace
}  // namespace lucerna::cli
