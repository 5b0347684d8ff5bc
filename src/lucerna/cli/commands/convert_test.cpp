// SPDX-License-Identifier: Apache-2.0
// `lucerna convert`: ray files and photometric files, what is changed on the way, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>

#include "lucerna/core/io/file.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/ray_file.h"
#include "tests/support/random_rays.h"
#include "tests/support/run_program.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

using test::has;
using test::run_lucerna;

/// 100 rays with a flux of 1000 lm, as s.tm25ray; and a distribution of 10 cd in all directions, as s.ldt.
class ConvertCli : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_lucerna(dir.path(), "make-source disk -n 100 -o s.tm25ray").exit_code, 0);
    IntensityDistribution even = uniform_distribution(30.0, 10.0);
    std::fill(even.cd.begin(), even.cd.end(), 10.0);
    write_file(dir / "s.ldt", ldt_text({even, {}}));
  }
  test::ProgramResult run(const std::string& arguments) {
    return run_lucerna(dir.path(), "convert " + arguments);
  }
  void refuse(int code, const std::string& arguments, const std::string& part) {
    const auto result = run(arguments);
    EXPECT_EQ(result.exit_code, code) << arguments << '\n' << result.err;
    EXPECT_TRUE(has(result.err, part)) << result.err;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_FALSE(std::filesystem::exists(dir / "out.tm25ray"));
    EXPECT_FALSE(std::filesystem::exists(dir / "out.dat"));
  }
  test::TempDir dir;
};

TEST_F(ConvertCli, EveryFormatBringsTheRaysBack) {
  const RaySet set = read_ray_set(dir / "s.tm25ray");
  for (const std::string_view format : ray_formats()) {
    const std::string name(format);
    const auto there = run("s.tm25ray there --to " + name);
    ASSERT_EQ(there.exit_code, 0) << name << ": " << there.err;
    EXPECT_TRUE(has(there.out, "there: 100 rays")) << there.out;
    EXPECT_TRUE(has(there.out, " as " + name)) << there.out;
    const auto back = run("there back --from " + name + " --to tm25 --flux 1000");
    ASSERT_EQ(back.exit_code, 0) << name << ": " << back.err;
    const RaySet again = read_ray_set(dir / "back");
    ASSERT_EQ(again.rays.size(), 100u) << name;
    for (std::size_t i = 0; i < 100; ++i) {
      ASSERT_NEAR(again.rays.x_mm[i], set.rays.x_mm[i], 1e-5) << name;
      ASSERT_NEAR(again.rays.kz[i], set.rays.kz[i], 1e-5) << name;
    }
    std::filesystem::remove(dir / "there");
    std::filesystem::remove(dir / "back");
  }
}

TEST_F(ConvertCli, TheFluxThatIsGivenIsStated) {
  const auto result = run("s.tm25ray out.tm25ray --flux 5");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FLOAT_EQ(static_cast<float>(*read_ray_set(dir / "out.tm25ray").header.flux_lm), 5.0F);
}

TEST_F(ConvertCli, SalvageTakesTheWholeRaysOfATruncatedFile) {
  const std::string whole = test::slurp(dir / "s.tm25ray");
  write_file(dir / "cut.tm25ray", whole.substr(0, whole.size() - 40));
  refuse(1, "cut.tm25ray out.tm25ray", "cut.tm25ray");
  const auto salvaged = run("cut.tm25ray out.tm25ray --salvage");
  ASSERT_EQ(salvaged.exit_code, 0) << salvaged.err;
  EXPECT_TRUE(has(salvaged.err, "lucerna: cut.tm25ray: byte ")) << salvaged.err;
  EXPECT_TRUE(has(salvaged.err, "100 rays announced, 98 are whole")) << salvaged.err;
  EXPECT_EQ(read_ray_set(dir / "out.tm25ray").rays.size(), 98u) << "40 bytes are of two rays";
}

TEST_F(ConvertCli, PhotometricFilesGoBothWays) {
  const auto there = run("s.ldt out.ies --to ies-2019");
  ASSERT_EQ(there.exit_code, 0) << there.err;
  EXPECT_TRUE(has(there.out, "out.ies: written; IES angles taken as H = C")) << there.out;
  const auto back = run("out.ies back.ldt");
  ASSERT_EQ(back.exit_code, 0) << back.err;
  EXPECT_NEAR(total_flux(read_photometric_file(dir / "back.ldt").distribution), 125.66, 0.1);  // 4 pi 10
}

TEST_F(ConvertCli, RefusesWithTheOptionOrThePlace) {
  refuse(2, "s.tm25ray out.dat", "'.dat'");
  refuse(2, "s.tm25ray out.dat --to floppy", "floppy");
  refuse(2, "s.tm25ray out.tm25ray --flux -5", "--flux -5 is not > 0");
  refuse(2, "s.tm25ray out.tm25ray --move 1,2", "1,2");
  refuse(2, "s.ldt out.dat", "give --to ies-2002, ies-2019 or ldt");
  refuse(2, "s.ldt out.dat --to ldt --rays 5", "are for ray files");
  refuse(1, "missing out.tm25ray", "missing");
  refuse(1, "s.tm25ray out.tm25ray --rays 101", "101");
  refuse(2, "s.tm25ray out.tm25ray --rays 0", "--rays 0: expected at least one");
  refuse(2, "s.tm25ray out.tm25ray --flux 1e308", "not what a ray file can state");
  refuse(2, "s.tm25ray out.tm25ray --move 0,1e300,0", "inf, 0) mm, which no ray file holds; see --move");
  EXPECT_FALSE(std::filesystem::exists(dir / "out.tm25ray"));
}

}  // namespace
}  // namespace lucerna
