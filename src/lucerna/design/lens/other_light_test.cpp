// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/other_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/fit/graded_bins.h"
#include "lucerna/design/lens/free_face.h"
#include "lucerna/design/lens/lens_blocks.h"
#include "lucerna/intensity.h"
#include "lucerna/project.h"

namespace lucerna {
namespace {

constexpr std::uint64_t kOtherRays = std::uint64_t{1} << 18;

LensProblem flat_based_lens() {
  // A dome over a flat base, with a wall of 3 mm that light can leave by; some passes below.
  constexpr const char* kText = R"([[source]]
kind = "disk"
radius_mm = 0.5
[[body]]
role = "solid"
refractive_index = 1.6
absorption_per_mm = 0.005
outline_mm = [[0, 3], [9, 3], [9, 6], [6, 7.6], [3, 8.6], [0, 9]]
[target]
file = "beam.ldt"
[design]
family = "bspline"
free_sides = 2
)";
  ProjectMemory memory;
  IntensityDistribution beam = uniform_distribution(90.0, 1.0);
  for (std::size_t i = 0; i < beam.cd.size(); ++i) {
    const double off = (180.0 - beam.gamma_deg[i % beam.gamma_deg.size()]) / 40.0;
    beam.cd[i] = std::exp(-off * off);
  }
  memory.targets["beam.ldt"] = std::make_shared<const IntensityDistribution>(beam);
  return lens_problem(parse_project(kText, "lens.toml", memory), "lens.toml");
}

/// All light that leaves, in bins of the design's frame.
struct BinTally {
  const Frame& design_from_world;
  const TentBins& bins;
  Eigen::VectorXd flux;
  double all = 0.0;

  void emitted(double share) { all += share; }
  void absorbed(double) {}
  void lost(double) {}
  void left(const Ray& ray, double share, int) {
    const Ray in_design = design_from_world.ray(ray);
    TentDeposit to;
    bins.deposit(in_design.origin_mm, in_design.direction.vec(), to);
    for (std::size_t k = 0; k < static_cast<std::size_t>(to.n); ++k)
      flux[static_cast<Eigen::Index>(to.bin[k])] += share * to.weight[k];
  }
};

// What goes straight by the fit's evaluation and the rest by a trace are all that a trace finds. A bin has
// some 1000 rays of other light and 30 000 of all; without the other light the sums differ by 8 %.
TEST(OtherLight, WithWhatGoesStraightIsAllLight) {
  const LensProblem problem = flat_based_lens();
  const DesignShape face = face_of(problem.start, 24);
  const Frame design_from_world = (problem.world_from_lens * lens_from_design()).inverse();
  const TentBins bins = TentBins::square(Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), 0.99, 4);
  DesignRays rays(problem.project.scene.sources, design_from_world, 3);
  rays.refract(problem.medium, into_lens(problem.start, problem.medium));
  rays.grow(kOtherRays);
  EvaluationOptions options;
  options.rays = kOtherRays;
  options.derivatives = options.direct_light = false;
  double within = 0.0;
  for (std::uint64_t b = 0; b < kOtherRays / kBlockRays; ++b) {
    for (const float w : rays.block(b).weight) within += static_cast<double>(w);
  }
  within /= static_cast<double>(kOtherRays);
  const Eigen::VectorXd straight = within * evaluate(face, Reflectance(1.0), rays, bins, options).flux;
  const Eigen::VectorXd other = other_light(problem, {problem.start, face}, bins, kOtherRays, 5);

  const Project project = with_lens(problem, {problem.start, face});
  const LensBlocks lens(project.scene, LensSurface::exact, 77);
  BinTally traced{design_from_world, bins, Eigen::VectorXd::Zero(straight.size())};
  RayBlock block;
  for (std::uint64_t b = 0; b < kOtherRays / kBlockRays; ++b) lens.follow(b, block, traced);
  traced.flux /= traced.all;

  EXPECT_GT(other.sum(), 0.02);
  EXPECT_NEAR(straight.sum() + other.sum(), traced.flux.sum(), 0.003);
  for (Eigen::Index b = 0; b < straight.size(); ++b)
    EXPECT_NEAR(straight[b] + other[b], traced.flux[b], 0.002 + 0.03 * traced.flux[b]) << b;
}

TEST(OtherLight, OfAFaceThatCutsItsBaseIsNothing) {
  const LensProblem problem = flat_based_lens();
  const DesignShape low = face_of(problem.start, 8).through([](double, double) { return -2.0; });
  const TentBins bins = TentBins::square(Frame(), 0.9, 4);
  EXPECT_EQ(other_light(problem, {problem.start, low}, bins, kBlockRays, 1).sum(), 0.0);
}

}  // namespace
}  // namespace lucerna
