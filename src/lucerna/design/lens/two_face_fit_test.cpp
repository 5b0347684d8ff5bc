// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/two_face_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/lens/free_face_fit.h"
#include "lucerna/design/lens/lens_design.h"
#include "lucerna/design/lens/lens_validation.h"
#include "lucerna/project.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

/// A lens a few times as wide as the disk before it, and even light on a rectangle of 2 x 1 m at 1 m.
const std::string kWideText = R"([[source]]
kind = "disk"
radius_mm = 2
[[body]]
role = "solid"
refractive_index = 1.49
outline_mm = [[0, 0.05], [9, 0.05], [9, 1.5], [6, 4.5], [3, 6], [0, 6.5]]
[target]
kind = "plane"
file = "even.csv"
position_mm = [0, 0, 1000]
normal = "-z"
size_mm = [2400, 1200]
[design]
family = "bspline"
free_sides = [0, 2]
entry = "bspline"
[design.limits]
max_height_mm = 10
min_thickness_mm = 0.5
min_draft_deg = 10
)";

/// The rectangle lit within a dark rim of a tenth to each side.
std::string even_csv() {
  constexpr int kCells = 60;
  std::string out;
  const auto is_lit = [](int i) { return i >= kCells / 12 && i < kCells - kCells / 12; };
  for (int row = 0; row < kCells; ++row) {
    for (int column = 0; column < kCells; ++column)
      out += fmt::format("{}{}", column > 0 ? "," : "", is_lit(row) && is_lit(column) ? 100 : 0);
    out += '\n';
  }
  return out;
}

/// A problem of a project whose files are there while its target is read.
LensProblem wide_problem(const std::string& text = kWideText) {
  const test::TempDir folder;
  write_file(folder / "even.csv", even_csv());
  write_file(folder / "lens.toml", text);
  return lens_problem(read_project(folder / "lens.toml"), folder / "lens.toml");
}

std::string changed_text(const std::string& part, const std::string& by) {
  std::string text = kWideText;
  return text.replace(text.find(part), part.size(), by);
}

LensOptions few_lens_rays() {
  LensOptions options;
  options.time_s = 1e6;
  options.max_rays = 1 << 14;
  options.validation_rays = 1 << 17;
  return options;
}

// A source so wide blurs what one face makes, and the first face shares the work. The limits hold on a grid
// that the fit has not seen, and all light is accounted for.
TEST(TwoFaceFitSlow, IsNearerToAWideLightThanACavity) {
  LensOptions options = few_lens_rays();
  const LensResult two = design_lens(wide_problem(), options),
                   one = design_lens(wide_problem(changed_text("entry = \"bspline\"\n", "")), options);
  ASSERT_TRUE(two.lens.entry);
  EXPECT_FALSE(one.lens.entry);
  EXPECT_EQ(two.lens.parameter_count(), two.lens.face->parameter_count() + two.lens.entry->parameter_count());
  EXPECT_LT(error_with_light(two.error, 0.1), 0.9 * error_with_light(one.error, 0.1))
      << two.error.c48.excess << " with " << two.error.in_rectangle.mean << " beside " << one.error.c48.excess
      << " with " << one.error.in_rectangle.mean;
  ASSERT_EQ(two.limits.size(), 3u);
  for (const LimitCheck& c : two.limits) EXPECT_TRUE(c.held) << c.limit << ' ' << c.found.mean;
  EXPECT_NEAR(two.efficiency.mean + two.bodies.mean + two.lost.mean, 1.0, 1e-9);
}

/// A few steps of both faces, from the better of two bases.
ShapedLens first_steps(const LensProblem& problem) {
  LensFitOptions options{1, 1 << 13, 1};
  int steps = 0;
  return fit_free_face(problem, options,
                       [&steps](const FitRecord&, const ShapedLens&) { return ++steps < 30; })
      .lens;
}

TEST(TwoFaceFit, GivesTheSameBitsOnAnyNumberOfThreads) {
  const auto made = [](int threads) {
    const ThreadLimit limit(threads);
    return first_steps(wide_problem());
  };
  const ShapedLens a = made(1), b = made(3);
  ASSERT_TRUE(a.entry && b.entry);
  EXPECT_EQ(a.entry->parameters(), b.entry->parameters());
  EXPECT_EQ(a.face->parameters(), b.face->parameters());
}

TEST(TwoFaceFit, AProjectSaysWhatTheEntryBecomes) {
  EXPECT_EQ(wide_problem().free_face->entry, EntryKind::bspline);
  EXPECT_EQ(wide_problem(changed_text("entry = \"bspline\"\n", "")).free_face->entry, EntryKind::cavity);
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(wide_problem(text));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(refusal(changed_text("free_sides = [0, 2]", "free_sides = 2")).find("no side from the axis"),
            std::string::npos);
  EXPECT_NE(refusal(changed_text("free_sides = [0, 2]", "free_sides = [0, 2, 0]")).find("side 0 twice"),
            std::string::npos);
  EXPECT_NE(refusal(changed_text("family = \"bspline\"\n", "")).find("entry"), std::string::npos);
  EXPECT_NE(refusal(changed_text("entry = \"bspline\"", "entry = \"dome\"")).find("dome"), std::string::npos);
}

// A quarter of the numbers say all of both faces.
TEST(TwoFaceFit, HoldsTheSymmetryThatIsAskedFor) {
  const LensProblem problem = wide_problem(kWideText + "symmetry = \"both\"\n");
  const ShapedLens lens = first_steps(problem);
  ASSERT_TRUE(lens.face && lens.entry);
  for (const DesignShape& face : {*lens.face, *lens.entry}) {
    const double half = static_cast<double>(face.intervals_x() + 3) / 2.0;
    EXPECT_EQ(static_cast<double>(face.parameter_count()), std::pow(std::ceil(half), 2));
    const double r = 0.6 * face.aperture().half_x_mm();
    for (const double x : {-r, r}) {
      for (const double y : {-0.7 * r, 0.7 * r})
        EXPECT_NEAR(face.at(x, y).z_mm, face.at(r, 0.7 * r).z_mm, 1e-12);
    }
    EXPECT_GT(std::abs(face.at(r, 0.0).z_mm - face.at(0.0, r).z_mm), 1e-3) << "the rectangle is not a square";
  }
}

// What a design writes is what it validated, from both sides of the file.
TEST(TwoFaceFit, TheProjectHoldsBothFaces) {
  const LensProblem problem = wide_problem();
  const ShapedLens lens = first_steps(problem);
  const Solid solid = shaped_solid(problem, lens);
  ASSERT_NE(solid.bottom_face, nullptr);
  const test::TempDir folder;
  write_file(folder / "even.csv", even_csv());
  const Project again =
      parse_project(project_text(with_lens(problem, lens)), folder / "lens.toml", ProjectMemory());
  const Solid& read = again.scene.solids.at(0);
  ASSERT_NE(read.bottom_face, nullptr);
  for (const double x : {-3.1, 0.0, 2.5}) {
    // The design looks at the lens turned about x.
    EXPECT_NEAR(read.bottom_face->at(x, 1.7).z_mm, -lens.entry->at(x, -1.7).z_mm, 1e-9);
    EXPECT_NEAR(read.face->at(x, 1.7).z_mm, -lens.face->at(x, -1.7).z_mm, 1e-9);
  }
  EXPECT_TRUE(is_finished_lens(again));
}

}  // namespace
}  // namespace lucerna
