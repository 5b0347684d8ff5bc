// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/face_search.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "lucerna/design/lens/entry_face.h"
#include "lucerna/intensity.h"
#include "lucerna/project.h"

namespace lucerna {
namespace {

/// A lens with a flat base and a dome over it, for a round beam to 40 degrees.
LensProblem domed_problem() {
  constexpr const char* kText = R"([[source]]
kind = "disk"
radius_mm = 0.5
[[body]]
role = "solid"
refractive_index = 1.5
outline_mm = [[0, 1], [9, 1], [9, 3], [6, 5.6], [3, 6.8], [0, 7.2]]
[target]
file = "beam.ldt"
[design]
family = "bspline"
free_sides = [0, 2]
intervals = 16
)";
  IntensityDistribution beam = uniform_distribution(90.0, 1.0);
  for (std::size_t i = 0; i < beam.cd.size(); ++i)
    beam.cd[i] = beam.gamma_deg[i % beam.gamma_deg.size()] > 140.0 ? 1.0 : 0.0;
  ProjectMemory memory;
  memory.targets["beam.ldt"] = std::make_shared<const IntensityDistribution>(beam);
  return lens_problem(parse_project(kText, "lens.toml", memory), "lens.toml");
}

constexpr LensFitOptions kFewFaceRays{1, std::uint64_t{1} << 15};

TEST(FaceSearch, ARoughFaceIsNearTheTarget) {
  FaceSearch search(domed_problem(), kFewFaceRays);
  const auto rough = search.rough(1.0);
  ASSERT_TRUE(rough);
  EXPECT_LT(rough->record.error, 0.25);
  EXPECT_GT(rough->record.in_rectangle, 0.8) << "of the light within";
  EXPECT_GT(rough->cost, 0.0);
  EXPECT_EQ(rough->face.intervals_x(), 16);
  const auto far = search.rough(2.5);
  EXPECT_TRUE(!far || far->cost > rough->cost) << "beyond the wall's rim";
}

// Light in the rectangle is compared with the same share of the sources' light over any base, though less
// comes into the medium by one than by another.
TEST(FaceSearch, BasesHaveOneScale) {
  const LensProblem flat = domed_problem();
  FaceSearch first(flat, kFewFaceRays);
  LensProblem cavity = flat;
  cavity.start = with_cavity(flat.start, {3.0, 3.0});
  FaceSearch second(cavity, kFewFaceRays, first.flux_reference(), std::nullopt);
  EXPECT_DOUBLE_EQ(second.flux_reference(), first.flux_reference());
  EXPECT_GT(first.flux_reference(), 0.5);
  EXPECT_LT(first.flux_reference(), 1.0);
}

TEST(FaceSearch, BeginsWithTheFaceThatWasChosen) {
  const LensProblem problem = domed_problem();
  FaceSearch plain(problem, kFewFaceRays);
  const DesignShape given = *plain.best().face;
  const DesignShape other = given.through([&](double x, double y) { return given.at(x, y).z_mm - 1.0; });
  FaceSearch search(problem, kFewFaceRays, plain.flux_reference(), other);
  EXPECT_NEAR(search.best().face->at(2.0, 1.0).z_mm, given.at(2.0, 1.0).z_mm - 1.0, 1e-9);
  EXPECT_NEAR(search.held().face->at(2.0, 1.0).z_mm, given.at(2.0, 1.0).z_mm - 1.0, 1e-9);
}

}  // namespace
}  // namespace lucerna
