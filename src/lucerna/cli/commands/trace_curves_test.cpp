// SPDX-License-Identifier: Apache-2.0
// Mirrors whose profile is no function of the radius, as a user meets them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "lucerna/core/io/file.h"
#include "tests/support/run_program.h"

namespace lucerna {
namespace {

using test::run_lucerna;

constexpr const char* kEllipse =
    "[[source]]\nkind = 'sphere'\nradius_mm = 0.2\nflux_lm = 100\n"
    "[[reflector]]\nfamily = 'revolution'\npreset = 'ellipse'\nfocal_mm = 10\nfocal2_mm = 90\n"
    "mouth_diameter_mm = 40\nhole_diameter_mm = 3\nposition_mm = [0, 0, 10]\naxis = '-z'\nreflectance = 0.9\n"
    "[[detector]]\nkind = 'plane'\nname = 'focus'\nposition_mm = [0, 0, -80]\nnormal = '+z'\n"
    "size_mm = [12, 12]\ncells = [1, 1]\n";

// The light of one focus comes together at the other; energy closes; the run can be repeated from what it
// left, and drawn.
TEST(TraceCurvesCli, EllipsoidPastItsEquatorGathersAtItsSecondFocus) {
  const test::TempDir dir;
  write_file(dir / "p.toml", kEllipse);
  const auto run = run_lucerna(dir.path(), "trace p.toml -o out --rays 40000 --report r.html --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto json = nlohmann::json::parse(run.out);
  const auto& ledger = json["ledger"];
  const auto value = [](const nlohmann::json& v) {
    return v.is_object() ? v["value"].get<double>() : v.get<double>();
  };
  const double reflected = value(ledger["out_reflected"]), direct = value(ledger["out_direct"]);
  EXPECT_GT(reflected, 60.0) << ledger.dump();
  EXPECT_NEAR(reflected + direct + reflected / 0.9 * 0.1, 100.0, 1.0) << "most light is reflected once";
  EXPECT_GT(test::slurp(dir / "r.html").size(), 100000u);
  const std::string csv = test::slurp(dir / "out" / "focus.csv");
  ASSERT_EQ(run_lucerna(dir.path(), "trace out/project.toml -o again --rays 40000").exit_code, 0);
  EXPECT_EQ(test::slurp(dir / "again" / "focus.csv"), csv) << "the same bits";
}

TEST(TraceCurvesCli, CannotBeDesigned) {
  const test::TempDir dir;
  write_file(dir / "p.toml", std::string(kEllipse) +
                                 "[target]\nkind = 'plane'\nfile = 'e.csv'\nposition_mm = [0, 0, -900]\n"
                                 "normal = '+z'\nsize_mm = [800, 800]\n[design]\ntime_s = 1\n");
  write_file(dir / "e.csv", "1,2\n2,1\n");
  const auto run = run_lucerna(dir.path(), "design p.toml -o out");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  EXPECT_NE(run.err.find("cannot be designed"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace lucerna
