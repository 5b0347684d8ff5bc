// SPDX-License-Identifier: Apache-2.0
// The search of free forms where the shape is the last face of a lens.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "lucerna/design/search/free_form_search.h"
#include "lucerna/design/shape/perturbed.h"
#include "lucerna/random.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

constexpr double kLensIndex = 1.49;
const Frame kDown({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {});

/// A square of 1 mm at z = 0 that shines down into a lens with a flat face 1 mm below it.
DesignRays square_in_lens(std::uint64_t seed) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 0.5;
  DesignRays rays({{make_emitter(options), kDown, {}}}, Frame(), seed);
  rays.refract({kLensIndex, 0.0}, [](Ray& ray) {
    const Boundary found = boundary(kLensIndex, -ray.direction.z());
    ray = {ray.at(1.0 / -ray.direction.z()),
           Direction::from(refracted(ray.direction, Direction::from({0, 0, 1}), kLensIndex, found))};
    return 1.0 - found.reflectance();
  });
  return rays;
}

/// The light of a face, by other rays than the search's.
class LightOf {
 public:
  explicit LightOf(DesignShape face) : face_(std::move(face)), rays_(square_in_lens(77)) {
    rays_.grow(kRays);
  }
  Eigen::VectorXd operator()(const TentBins& bins) const {
    EvaluationOptions options;
    options.rays = kRays;
    options.derivatives = options.direct_light = false;
    return evaluate(face_, Reflectance(1.0), rays_, bins, options).flux;
  }

 private:
  static constexpr std::uint64_t kRays = std::uint64_t{1} << 20;
  DesignShape face_;
  DesignRays rays_;
};

TEST(FreeFaceSearch, FindsLightThatAnotherFaceMakes) {
  const Aperture aperture = Aperture::circle(24);
  // From 12 mm below the source a dome of 6 mm.
  const auto dome = DesignShape::bspline(6, aperture, 24, 24).through([](double x, double y) {
    return -12.0 + (x * x + y * y) / 24.0;
  });
  const auto hidden = perturbed(DesignShape::bspline(6, aperture, 6, 6), 0.6, Rng(5, 1));
  const LightOf light(hidden.through([&](double x, double y) { return hidden.at(x, y).z_mm - 12.0; }));
  DesignRays rays = square_in_lens(3);
  rays.grow(std::uint64_t{1} << 14);
  FitProblem problem{&rays, Reflectance(1.0), {}, TentBins::square(kDown, 0.9, 48), TargetMode::shape};
  problem.target = [&](const TentBins& bins) { return light(bins); };
  problem.direct_light = false;
  problem.flux_weight = 0.01;
  problem.flux_reference = 0.955;
  problem.rectangle = {kDown, false, -0.8, 0.8, -0.8, 0.8};
  FreeFormSearch search(problem, dome, 24, std::uint64_t{1} << 19);
  for (int i = 0; i < 40 && !search.done(); ++i) search.step();
  // By other rays, in bins that the search does not use.
  DesignRays fresh = square_in_lens(11);
  constexpr std::uint64_t kFresh = std::uint64_t{1} << 19;
  fresh.grow(kFresh);
  const TentBins bins = graded_bins(problem.rectangle, Frame(), 24, 1.1);
  EvaluationOptions options;
  options.rays = kFresh;
  options.derivatives = options.direct_light = false;
  const auto error_of_face = [&](const DesignShape& face) {
    return bin_error(evaluate(face, problem.reflectance, fresh, bins, options), problem.target(bins), bins,
                     problem.mode)
        .relative_rms;
  };
  EXPECT_GT(error_of_face(dome), 0.1) << "it is far off, or the test says nothing";
  EXPECT_LT(error_of_face(search.best()), 0.01);
}

// A limit costs nothing at the dome and very much where a step of little damping leads: one that does not see
// it is refused.
TEST(FreeFaceSearch, StepsSeeTheLimitsThatTheyWouldBreak) {
  const Aperture aperture = Aperture::circle(24);
  const auto dome_of = [&](double depth_mm) {
    return DesignShape::bspline(6, aperture, 12, 12).through([&](double x, double y) {
      return -12.0 + depth_mm * (x * x + y * y) / 144.0;
    });
  };
  const DesignShape dome = dome_of(6.0);
  std::vector<HeightBounds> bounds;
  for (int i = -24; i <= 24; ++i) {
    for (int k = -24; k <= 24; ++k) {
      const double x = 0.5 * i, y = 0.5 * k;
      const double z = dome.at(x, y).z_mm;
      if (aperture.contains(x, y)) bounds.push_back({x, y, z - 0.05, z + 0.05});
    }
  }
  const auto limits = std::make_shared<const ShapeLimits>(DesignLimits{}, dome, bounds);
  const LightOf light(dome_of(7.0));
  DesignRays rays = square_in_lens(3);
  FitProblem problem{&rays, Reflectance(1.0), {}, TentBins::square(kDown, 0.9, 24), TargetMode::shape};
  problem.target = [&](const TentBins& bins) { return light(bins); };
  problem.direct_light = false;
  problem.rectangle = {kDown, false, -0.8, 0.8, -0.8, 0.8};
  problem.limits = [&](const DesignShape& shape, std::uint64_t, ResidualRows* rows) {
    return limits->cost(shape, rows);
  };
  FreeFormLevel level;
  level.bins = 24;
  level.rays = std::uint64_t{1} << 16;
  const auto is_accepted = [&](const FitProblem& with) {
    const FreeFormFit fit(with, level);
    FreeFormPoint point = fit.at(dome);
    double lambda = 1e-3;  // more damping makes steps too short to break anything
    const bool moved = fit.step(point, lambda);
    EXPECT_LT(limits->cost(point.shape, nullptr), 0.1 * point.equations.cost);
    return moved;
  };
  EXPECT_FALSE(is_accepted(problem));
  problem.form = limits;
  EXPECT_TRUE(is_accepted(problem));
}

}  // namespace
}  // namespace lucerna
