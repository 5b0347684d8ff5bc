// SPDX-License-Identifier: Apache-2.0
// `lucerna compress`: the model file, what is printed of it, and what it refuses.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "lucerna/source_model.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::has;
using test::run_lucerna;
using Json = nlohmann::json;

class CompressCli : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 20000 --flux-lm 300 -o s.tm25ray").exit_code, 0);
  }
  test::ProgramResult run(const std::string& arguments) {
    return run_lucerna(dir.path(), "compress " + arguments);
  }
  Json json_of(const std::string& arguments) {
    const auto result = run(arguments + " --json");
    EXPECT_EQ(result.exit_code, 0) << arguments << ": " << result.err;
    return result.exit_code == 0 ? Json::parse(result.out) : Json();
  }
  void refuse(int code, const std::string& arguments, const std::string& part) {
    const auto result = run(arguments + " -o m.nfl");
    EXPECT_EQ(result.exit_code, code) << arguments << '\n' << result.err;
    EXPECT_TRUE(has(result.err, part)) << result.err;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_FALSE(std::filesystem::exists(dir / "m.nfl")) << arguments;
  }
  test::TempDir dir;
};

TEST_F(CompressCli, TheFileIsTheModelThatIsPrinted) {
  const Json json = json_of("s.tm25ray -o m.nfl");
  const auto model = load_source_model(dir / "m.nfl");
  EXPECT_EQ(json["method"], "adaptive");
  EXPECT_EQ(model->method(), "adaptive");
  EXPECT_EQ(json["rays"], 20000);
  EXPECT_EQ(json["layers"], model->layers());
  EXPECT_EQ(json["leaves"], model->leaves());
  EXPECT_NEAR(model->flux(), 300.0, 1e-4);
  EXPECT_EQ(json["flux_lm"], model->flux());
  EXPECT_EQ(json["bytes"], std::filesystem::file_size(dir / "m.nfl"));
  EXPECT_EQ(json["inputs"].size(), 1u);
}

TEST_F(CompressCli, FluxesOfSeveralFilesAdd) {
  ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 5000 --seed 2 --flux-lm 100 -o t.tm25ray").exit_code,
            0);
  const Json both = json_of("s.tm25ray t.tm25ray -o m.nfl");
  EXPECT_EQ(both["rays"], 25000);
  EXPECT_NEAR(both["flux_lm"].get<double>(), 400.0, 1e-3);
  EXPECT_EQ(both["inputs"].size(), 2u);
  EXPECT_NEAR(json_of("s.tm25ray -o m.nfl --flux 7")["flux_lm"].get<double>(), 7.0, 1e-6);
}

TEST_F(CompressCli, WarningsNameTheirFile) {
  for (const char* name : {"a.tm25ray", "b.tm25ray"})
    write_file(dir / name, test::slurp(dir / "s.tm25ray") + std::string(40, '\0'));
  for (const char* inputs : {"a.tm25ray", "a.tm25ray b.tm25ray"}) {
    const auto result = run(std::string(inputs) + " -o m.nfl");
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(has(result.err, "lucerna: a.tm25ray: byte ")) << result.err;
    EXPECT_EQ(has(result.err, "lucerna: b.tm25ray: byte "), has(inputs, "b.tm25ray")) << result.err;
  }
  const auto compared = run_lucerna(dir.path(), "compare a.tm25ray b.tm25ray --cells-um 300");
  EXPECT_TRUE(has(compared.err, "lucerna: a.tm25ray: ")) << compared.err;
  EXPECT_TRUE(has(compared.err, "lucerna: b.tm25ray: ")) << compared.err;
  write_file(dir / "p.toml", "[[source]]\nfile = \"a.tm25ray\"\n");
  const auto traced = run_lucerna(dir.path(), "trace p.toml -o out --rays 100");
  EXPECT_TRUE(has(traced.err, "a.tm25ray: byte ")) << traced.err;
}

TEST_F(CompressCli, ALargestSizeHolds) {
  const Json free = json_of("s.tm25ray -o free.nfl");
  const auto bytes = free["bytes"].get<std::uint64_t>() / 2;
  const Json held = json_of("s.tm25ray -o m.nfl --max-bytes " + std::to_string(bytes));
  EXPECT_LE(held["bytes"].get<std::uint64_t>(), bytes);
  EXPECT_LE(std::filesystem::file_size(dir / "m.nfl"), bytes);
  EXPECT_LT(held["leaves"].get<std::uint64_t>(), free["leaves"].get<std::uint64_t>());
}

TEST_F(CompressCli, WritesAReportWhereAskedTo) {
  ASSERT_EQ(run("s.tm25ray -o m.nfl --report m.html").exit_code, 0);
  const std::string page = test::slurp(dir / "m.html");
  EXPECT_TRUE(has(page, "</html>"));
  EXPECT_TRUE(has(page, "others, which it has not seen"));
  ASSERT_EQ(run("s.tm25ray -o m.nfl --held-out 0 --report m.html").exit_code, 0);
  EXPECT_FALSE(has(test::slurp(dir / "m.html"), "others, which it has not seen"));
}

TEST_F(CompressCli, SaysHowFarAModelIsFromRaysThatItHasNotSeen) {
  const Json json = json_of("s.tm25ray -o m.nfl");
  const Json& held_out = json["held_out"];
  EXPECT_EQ(held_out["rays"].get<int>() + held_out["training_rays"].get<int>(), 20000);
  EXPECT_EQ(held_out["views"].size(), 5u);
  EXPECT_LT(held_out["views"]["far"]["excess"].get<double>(), held_out["views"]["far"]["raw"].get<double>());
  EXPECT_EQ(held_out["scales"].size(), 5u);
  const std::string printed = run("s.tm25ray -o m.nfl --held-out 1e4").out;
  EXPECT_TRUE(has(printed, "  held out: a model of ")) << printed;
  EXPECT_TRUE(has(printed, "  four_d ")) << printed;
  EXPECT_FALSE(has(run("s.tm25ray -o m.nfl --held-out 0").out, "held out"));
  EXPECT_FALSE(json_of("s.tm25ray -o m.nfl --held-out 100").contains("held_out"));
}

TEST_F(CompressCli, RefusesInOneLineAndWritesNoModel) {
  refuse(2, "s.tm25ray --method zip", "unknown method 'zip'; expected adaptive or clusters");
  refuse(2, "s.tm25ray --held-out some", "'some' is not a whole number");
  refuse(2, "s.tm25ray --flux 0", "--flux 0 is not > 0");
  refuse(1, "s.tm25ray --max-bytes 10", "does not fit in 10 bytes");
  refuse(1, "missing.tm25ray", "missing.tm25ray");
  ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 0 -o zero.tm25ray").exit_code, 0);
  refuse(1, "zero.tm25ray", "no rays to compress");
  ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 100 --flux-w 3 -o w.tm25ray").exit_code, 0);
  refuse(1, "s.tm25ray w.tm25ray", "w.tm25ray");
}

}  // namespace
}  // namespace lucerna
