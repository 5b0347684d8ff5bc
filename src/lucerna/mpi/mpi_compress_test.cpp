// SPDX-License-Identifier: Apache-2.0
// `compress` under mpirun: the model file of one process, to the byte.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lucerna/core/io/file.h"
#include "tests/support/mpi_runs.h"

namespace lucerna {
namespace {

class MpiCompressTest : public test::MpiTest {
 protected:
  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  /// The exit code of a command with these words.
  int run(std::vector<std::string> words, const std::vector<std::string>& more) const {
    words.insert(words.end(), more.begin(), more.end());
    return test::wait_for(test::start(words, dir_ / "log"));
  }
  int lucerna(const std::vector<std::string>& words) const { return run({test::program().string()}, words); }
  int on_ranks(int ranks, const std::vector<std::string>& words) const {
    return run(test::mpi_command(ranks, "compress"), words);
  }

  void make_rays(const std::string& kind, const std::string& rays, const std::string& file,
                 const std::string& format) const {
    ASSERT_EQ(lucerna({"make-source", kind, "-n", rays, "-o", path(file), "--to", format}), 0) << log();
  }
};

TEST_F(MpiCompressTest, ModelsAreThoseOfOneProcessMpi) {
  make_rays("led", "30011", "a.tm25ray", "tm25");
  make_rays("disk", "2003", "b.txt", "text");
  for (const char* const method : {"adaptive", "clusters"}) {
    const std::vector<std::string> how{
        path("a.tm25ray"), path("b.txt"), "--method", method, "--held-out", "0"};
    std::vector<std::string> alone = how;
    alone.insert(alone.begin(), "compress");
    alone.insert(alone.end(), {"-o", path("alone.nfl")});
    ASSERT_EQ(lucerna(alone), 0) << log();
    for (const int ranks : {1, 2, 3, 5}) {
      std::vector<std::string> words = how;
      words.insert(words.end(), {"-o", path("out.nfl"), "--threads", "1"});
      ASSERT_EQ(on_ranks(ranks, words), 0) << log();
      EXPECT_THAT(log(), testing::HasSubstr("32014 rays to")) << "one rank speaks";
      EXPECT_EQ(read_file(path("out.nfl"), test::kMostBytes), read_file(path("alone.nfl"), test::kMostBytes))
          << method << ", " << ranks << " ranks";
      std::filesystem::remove(path("out.nfl"));
    }
  }
}

// A fault that one rank alone meets ends all of them with one line, and no file.
TEST_F(MpiCompressTest, FaultsOfOneRankAreToldOnceMpi) {
  make_rays("led", "20000", "a.tm25ray", "tm25");
  std::string bytes = read_file(path("a.tm25ray"), test::kMostBytes);
  bytes.replace(bytes.size() - 28, 4, std::string("\x00\x00\xC0\x7F", 4));  // the last ray's x is no number
  write_file(path("a.tm25ray"), bytes);
  EXPECT_EQ(on_ranks(3, {path("a.tm25ray"), "-o", path("out.nfl")}), 1);
  const std::string said = log();
  EXPECT_THAT(said, testing::HasSubstr("a.tm25ray: ray 19999 (byte")) << said;
  EXPECT_EQ(said.find("19999"), said.rfind("19999")) << said;
  EXPECT_FALSE(std::filesystem::exists(path("out.nfl")));
  EXPECT_EQ(on_ranks(2, {path("absent.dat"), "-o", path("out.nfl")}), 1);
  EXPECT_THAT(log(), testing::HasSubstr("absent.dat"));
  EXPECT_EQ(on_ranks(2, {path("a.tm25ray"), "-o", path("out.txt")}), 2) << log();
}

}  // namespace
}  // namespace lucerna
