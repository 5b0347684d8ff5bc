// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_tailoring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/lens/lens_evaluation.h"
#include "lucerna/design/lens/lens_problem.h"

namespace lucerna {
namespace {

/// A collimator whose dome is hollow towards the source, as no collimator's is that sends its light ahead.
constexpr const char* kHollowCollimator = R"([[source]]
kind = "disk"
radius_mm = 0.01
[[body]]
role = "solid"
refractive_index = 1.49
outline_mm = [[0, 6.5], [4, 5.2], [4.4, 0.2], [5.4, 0.2], [9, 5], [13, 11.5], [16, 18], [16.2, 19.5],
  [0, 19.5]]
smooth_below_deg = 30
[[detector]]
kind = "far-field"
[target]
file = "beam.ldt"
[design]
free_sides = [0, 1, 3, 7]
intervals = 6
)";

/// Light towards +z within an angle, the same in all directions.
std::shared_ptr<const IntensityDistribution> even_within(double half_width_deg) {
  IntensityDistribution beam = uniform_distribution(0.5, 1.0);
  beam.c_deg = {0.0};
  beam.cd.assign(beam.gamma_deg.size(), 0.0);
  for (std::size_t g = 0; g < beam.gamma_deg.size(); ++g)
    beam.cd[g] = 180.0 - beam.gamma_deg[g] <= half_width_deg ? 1.0 : 0.0;
  return std::make_shared<const IntensityDistribution>(beam);
}

/// A problem with what tailoring asks of it.
class Tailoring {
 public:
  explicit Tailoring(double half_width_deg, const std::string& text = kHollowCollimator)
      : problem_(problem_of(half_width_deg, text)),
        rays_(problem_.project.scene.sources, problem_.world_from_lens.inverse(), 3) {
    rays_.grow(1 << 15);
  }

  std::vector<LensShape> lenses() const {
    const PrescribedAngle angle(target_flux(problem_.target, problem_.world_from_lens, 1.0));
    return tailored_lenses(problem_.start, problem_.medium, point_source(rays_, 1 << 13), angle,
                           problem_.limits);
  }

  /// Flux in rings of a degree.
  Eigen::VectorXd light(const LensShape& lens) const {
    LensEvaluationOptions plain;
    plain.rays = 1 << 15;
    plain.derivatives = false;
    plain.ghost_every = 0;
    return evaluate_lens(lens, problem_.medium, rays_, TentBins::rings(Frame(), radians(60.0), 60), plain)
        .flux;
  }
  double within(const LensShape& lens, int deg) const { return light(lens).head(deg).sum(); }

  const LensProblem& problem() const { return problem_; }

 private:
  static LensProblem problem_of(double half_width_deg, const std::string& text) {
    ProjectMemory memory;
    memory.targets["beam.ldt"] = even_within(half_width_deg);
    return lens_problem(parse_project(text, "lens.toml", memory), "lens.toml");
  }

  LensProblem problem_;
  DesignRays rays_;
};

TEST(TailoredLenses, CollimateThePointsLight) {
  const Tailoring narrow(3.0);
  const auto lenses = narrow.lenses();
  ASSERT_FALSE(lenses.empty());
  double best = 0.0;
  for (const LensShape& lens : lenses) {
    EXPECT_TRUE(lens.is_valid());
    best = std::max(best, narrow.within(lens, 5));
  }
  // Two faces reflect 8 %. The given lens spreads what comes through its dome.
  EXPECT_LT(narrow.within(narrow.problem().start, 5), 0.65);
  EXPECT_GT(best, 0.87);
}

// Each way is spread over all of the target, so that their sum has its shape: even within 25 degrees.
TEST(TailoredLenses, SpreadThePointsLightAsPrescribed) {
  const Tailoring wide(25.0);
  double best = 1e9;
  const auto off = [&](const LensShape& lens) {
    // The outermost rings are blurred by pieces that are few.
    const Eigen::VectorXd flux = wide.light(lens);
    const double all = flux.head(28).sum();
    double sum = 0.0;
    for (int ring = 2; ring < 22; ++ring) {
      const double solid_angle = std::cos(radians(ring)) - std::cos(radians(ring + 1.0));
      const double share = solid_angle / (1.0 - std::cos(radians(25.0)));
      sum += std::abs(flux[ring] / all - share);
    }
    return sum;
  };
  for (const LensShape& lens : wide.lenses()) best = std::min(best, off(lens));
  EXPECT_GT(off(wide.problem().start), 0.5);
  EXPECT_LT(best, 0.2);
}

TEST(TailoredLenses, AreTheSameForAnyNumberOfThreads) {
  const Tailoring narrow(5.0);
  const auto all = narrow.lenses();
  const ThreadLimit one(1);
  const auto again = narrow.lenses();
  ASSERT_EQ(all.size(), again.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(all[i].parameters(), again[i].parameters()) << i;
}

TEST(TailoredLenses, HoldTheLimitsAsFarAsTheyCan) {
  const std::string text = std::string(kHollowCollimator) + "[design.limits]\nmax_diameter_mm = 33.5\n";
  const Tailoring narrow(5.0, text);
  double widest = 0.0;
  for (const LensShape& lens : narrow.lenses()) widest = std::max(widest, 2.0 * lens.radius_mm());
  EXPECT_LT(widest, 34.0);
}

// Light that meets no lens goes no way that could be tailored.
TEST(TailoredLenses, AreNoneWhereNoLightMeetsTheLens) {
  std::string text = kHollowCollimator;
  text.replace(text.find("radius_mm = 0.01"), 16, "radius_mm = 0.01\nposition_mm = [0, 0, 40]");
  EXPECT_TRUE(Tailoring(5.0, text).lenses().empty());
}

}  // namespace
}  // namespace lucerna
