// SPDX-License-Identifier: Apache-2.0
// `info` of models, as a user meets it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::has;
using test::run_lucerna;
using test::TempDir;
using Json = nlohmann::json;

void make(const TempDir& dir, const std::string& command) {
  const auto run = run_lucerna(dir.path(), command);
  ASSERT_EQ(run.exit_code, 0) << command << '\n' << run.err;
}

Json model_json(const TempDir& dir) {
  const auto run = run_lucerna(dir.path(), "info a.nfl --json");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return Json::parse(run.out)["files"][0];
}

TEST(DescribeModelCli, AnAdaptiveModelSaysWhatWasChosenAndWhy) {
  const TempDir dir;
  make(dir, "make-source disk -n 30000 --surface sphere --surface-mm 3 -o a.tm25ray");
  make(dir, "compress a.tm25ray -o a.nfl --held-out 0");
  const Json file = model_json(dir);
  EXPECT_EQ(file["starting_surface"], "sphere");
  ASSERT_EQ(file["chosen"].size(), file["layers"].get<std::size_t>());
  double share = 0.0;
  std::size_t leaves = 0;
  for (const Json& layer : file["chosen"]) {
    share += layer["share"].get<double>();
    leaves += layer["leaves"].get<std::size_t>();
    EXPECT_FALSE(layer["why"].get<std::string>().empty());
    EXPECT_EQ(layer["axis"].size(), 3u);
  }
  EXPECT_NEAR(share, 1.0, 1e-9);
  EXPECT_EQ(leaves, file["leaves"].get<std::size_t>());
  EXPECT_NEAR(file["etendue_mm2sr"]["p50"].get<double>() / 4.9348, 1.0, 0.1);
  const auto text = run_lucerna(dir.path(), "info a.nfl").out;
  EXPECT_TRUE(has(text, file["chosen"][0]["why"].get<std::string>())) << text;
  EXPECT_TRUE(has(text, file["chosen"][0]["support"].get<std::string>())) << text;
}

TEST(DescribeModelCli, AModelOfClustersSaysItsMesh) {
  const TempDir dir;
  make(dir, "make-source disk -n 20000 --surface sphere --surface-mm 3 -o a.tm25ray");
  make(dir, "compress a.tm25ray -o a.nfl --method clusters --held-out 0");
  const Json file = model_json(dir);
  EXPECT_EQ(file["starting_surface"], "sphere");
  EXPECT_GE(file["clusters"].get<int>(), 32);
  EXPECT_GT(file["triangles"].get<int>(), file["clusters"].get<int>());
  EXPECT_TRUE(has(run_lucerna(dir.path(), "info a.nfl").out, "triangles"));
}

/// Rays in two colours from a small place: 450 nm narrow, 600 nm wide.
std::string rays_of_two_colours() {
  std::string text = "# columns: x y z kx ky kz flux wavelength_nm\n";
  for (int i = 0; i < 4000; ++i) {
    const double u = std::fmod(0.618034 * i, 1.0), angle = i % 2 == 0 ? 0.1 * u : u;
    text += fmt::format("{} {} 0 {} 0 {} 1 {}\n", u, std::fmod(0.7548776 * i, 1.0), std::sin(angle),
                        std::cos(angle), i % 2 == 0 ? 450 : 600);
  }
  return text;
}

TEST(DescribeModelCli, SaysWhatItKnowsOfColour) {
  const TempDir dir;
  make(dir, "make-source disk -n 20000 -o a.tm25ray");
  make(dir, "compress a.tm25ray -o a.nfl --held-out 0");
  EXPECT_FALSE(model_json(dir).contains("wavelengths_nm"));
  EXPECT_TRUE(has(run_lucerna(dir.path(), "info a.nfl").out, "wavelengths         not known"));
  write_file(dir / "b.txt", rays_of_two_colours());
  make(dir, "compress b.txt -o a.nfl --flux 5 --held-out 0");
  const Json file = model_json(dir);
  EXPECT_EQ(file["wavelengths_nm"]["min"], 450.0);
  EXPECT_EQ(file["wavelengths_nm"]["max"], 600.0);
  EXPECT_TRUE(has(run_lucerna(dir.path(), "info a.nfl").out, "450 to 600 nm")) << file;
}

}  // namespace
}  // namespace lucerna
