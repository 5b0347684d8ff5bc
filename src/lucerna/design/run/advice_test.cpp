// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/advice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design.h"
#include "lucerna/photometric_file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::TempDir;
using testing::ElementsAre;

/// A beam of 30 by 16 degrees (standard deviations): no mirror of revolution makes it.
void write_oval(const std::filesystem::path& path) {
  PhotometricFile file;
  file.distribution = uniform_distribution(15.0, 1.0);
  IntensityDistribution& d = file.distribution;
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    const double angle = d.c_deg[c] * std::numbers::pi / 180.0;
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      const double u = d.gamma_deg[g] * std::cos(angle) / 30.0, v = d.gamma_deg[g] * std::sin(angle) / 16.0;
      d.at(c, g) = d.gamma_deg[g] < 90.0 ? 1000.0 * std::exp(-(u * u + v * v)) : 0.0;
    }
  }
  write_photometric_file(path, file, PhotometricFormat::ies_2019);
}

DesignProblem lamp_problem(const TempDir& folder, const std::string& shape, const std::string& design) {
  write_oval(folder / "target.ies");
  write_file(folder / "project.toml",
             "[[source]]\nkind = \"disk\"\nradius_mm = 1.0\n[[reflector]]\n" + shape +
                 "diameter_mm = 60.0\nhole_diameter_mm = 6.0\nposition_mm = [0, 0, 8]\naxis = \"-z\"\n"
                 "[target]\nfile = \"target.ies\"\n[design]\nrestarts = 0\n" +
                 design);
  return design_problem(read_project(folder / "project.toml"), folder / "project.toml");
}

DesignOptions few_rays() {
  DesignOptions options;
  options.time_s = 1e6;
  options.max_rays = 1 << 13;
  options.validation_rays = 1 << 17;
  options.advise = true;
  return options;
}

constexpr const char* kRevolution = "family = \"revolution\"\npreset = \"parabola\"\nfocal_mm = 8\n";

std::vector<std::string> texts(const std::vector<AdviceChange>& changes) {
  std::vector<std::string> out;
  for (const AdviceChange& c : changes) out.push_back(c.text);
  return out;
}

TEST(Advice, ChangesOutlineAndFamily) {
  const TempDir folder;
  const auto changes = advice_changes(lamp_problem(folder, kRevolution, "intervals = 3\n"));
  ASSERT_THAT(texts(changes), ElementsAre("a tenth wider, 66 mm", "half the hole, 3 mm", "a free form"));
  EXPECT_DOUBLE_EQ(changes[0].problem.start.aperture().half_x_mm(), 33.0);
  EXPECT_DOUBLE_EQ(changes[0].problem.project.scene.reflectors[0].reflector.aperture.half_x_mm(), 33.0);
  EXPECT_DOUBLE_EQ(changes[1].problem.start.aperture().hole_radius_mm(), 1.5);
  EXPECT_TRUE(changes[1].problem.start.is_revolution());
  EXPECT_FALSE(changes[2].problem.start.is_revolution());
}

TEST(Advice, DoublesTheKnotsThatTheProjectSays) {
  const TempDir folder;
  const std::string free_form = "family = \"bspline\"\nfocal_mm = 8\n";
  const auto fixed = advice_changes(lamp_problem(folder, free_form, "intervals = [4, 6]\n"));
  ASSERT_EQ(fixed.size(), 3u);
  EXPECT_EQ(fixed[2].text, "twice the knots, 8 x 12 intervals");
  EXPECT_EQ(fixed[2].problem.start.intervals_y(), 12);
  EXPECT_EQ(advice_changes(lamp_problem(folder, free_form, "")).size(), 2u);
}

TEST(Advice, HoldsTheLimits) {
  const TempDir folder;
  const auto changes = advice_changes(lamp_problem(folder, kRevolution,
                                                   "intervals = 3\n[design.limits]\nmax_diameter_mm = 62.0\n"
                                                   "min_hole_diameter_mm = 5.0\nmax_height_mm = 40.0\n"));
  EXPECT_THAT(texts(changes), ElementsAre("a tenth higher, 44 mm", "a free form"));
  EXPECT_DOUBLE_EQ(*changes[0].problem.limits.max_height_mm, 44.0);
}

TEST(Advice, SaysWhatHelps) {
  const TempDir folder;
  const DesignResult result =
      design(lamp_problem(folder, kRevolution, "intervals = 3\noptimizer = \"least-squares\"\n"), few_rays());
  ASSERT_EQ(result.advice.size(), 3u);
  const AdviceTrial &hole = result.advice[1], &free_form = result.advice[2];
  EXPECT_GT(result.error.c48.excess, 0.2);
  EXPECT_LT(free_form.error.c48.excess, 0.15);
  EXPECT_TRUE(free_form.helps);
  EXPECT_GT(hole.error.c48.excess, 0.2);
  const double less = result.error.c48.excess - hole.error.c48.excess;
  const double sigma = std::hypot(result.error.c48.standard_error, hole.error.c48.standard_error);
  EXPECT_TRUE(less > 2.9 * sigma || !hole.helps);
}

/// Asks to stop once it is told of a number of updates.
class StopsAfter : public Progress {
 public:
  explicit StopsAfter(int updates) : left_(updates) {}
  void update(std::string_view, std::uint64_t, std::uint64_t) override { --left_; }
  bool stop_requested() const override { return left_ < 0; }

 private:
  int left_;
};

TEST(Advice, EndsWithWhatItHasWhenAskedToStop) {
  const TempDir folder;
  StopsAfter stop(0);
  EXPECT_TRUE(advise(lamp_problem(folder, kRevolution, "optimizer = \"least-squares\"\n"), DesignError{},
                     few_rays(), stop)
                  .empty());
}

}  // namespace
}  // namespace lucerna
