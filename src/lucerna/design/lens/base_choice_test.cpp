// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/base_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "lucerna/core/io/file.h"
#include "lucerna/project.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

/// A small square before a lens ten times as wide, and light to 60 degrees from the axis, evenly on a plane.
LensProblem bent_problem(const std::string& entry) {
  const test::TempDir folder;
  write_file(folder / "even.csv", "1,1\n1,1\n");
  write_file(folder / "lens.toml", R"([[source]]
kind = "rectangle"
size_mm = [2, 2]
[[body]]
role = "solid"
refractive_index = 1.49
outline_mm = [[0, 0.05], [10, 0.05], [10, 1.5], [6, 3], [0, 4]]
[target]
kind = "plane"
file = "even.csv"
position_mm = [0, 0, 100]
normal = "-z"
size_mm = [350, 140]
[design]
family = "bspline"
free_sides = [0, 2]
entry = ")" + entry + R"("
[design.limits]
max_height_mm = 8
)");
  return lens_problem(read_project(folder / "lens.toml"), folder / "lens.toml");
}

TEST(BaseChoice, BringsTheBestFirstAndOthersThatDiffer) {
  const LensProblem problem = bent_problem("bspline");
  const LensFitOptions options{1, 1 << 15, 8};
  int seen = 0;
  const LensFitWatcher watch = [&](const FitRecord&, const ShapedLens&) {
    ++seen;
    return true;
  };
  BaseChoice choice(problem, options, watch);
  choice.run();
  EXPECT_EQ(seen, 9) << "the given base, and eight others";
  EXPECT_GT(choice.evaluations(), seen);
  ASSERT_TRUE(choice.best().cavity) << "a flat base cannot bend light so far";
  const std::vector<LensBase> found = choice.distinct(3);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found.front().cost, choice.best().cost);
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_TRUE(found[i].face);
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_LE(found[k].cost, found[i].cost);
      const Cavity a = found[i].cavity.value_or(Cavity{}), b = found[k].cavity.value_or(Cavity{});
      EXPECT_GT(std::hypot(a.radius_mm - b.radius_mm, a.depth_mm - b.depth_mm), 0.5);
    }
  }
}

TEST(BaseChoice, EndsWhereTheWatcherSaysSo) {
  const LensProblem problem = bent_problem("cavity");
  const LensFitOptions options{1, 1 << 15, 8};
  const LensFitWatcher never = [](const FitRecord&, const ShapedLens&) { return false; };
  BaseChoice choice(problem, options, never);
  choice.run();
  EXPECT_TRUE(choice.has_ended());
  EXPECT_FALSE(choice.best().cavity);
  EXPECT_EQ(choice.distinct(3).size(), 1u);
}

}  // namespace
}  // namespace lucerna
