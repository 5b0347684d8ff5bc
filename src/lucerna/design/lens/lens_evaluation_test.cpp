// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_evaluation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/lens/lens_path.h"
#include "lucerna/random.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

using Corners = std::vector<OutlinePoint>;

DesignRays disk_rays(std::uint64_t n, double radius_mm) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = radius_mm;
  DesignRays rays({{make_emitter(options), Frame(), {}}}, Frame(), 7);
  rays.grow(n);
  return rays;
}

Eigen::VectorXd random_moves(std::size_t n, double size_mm, std::uint64_t seed) {
  Eigen::VectorXd p(static_cast<Eigen::Index>(n));
  Rng rng(seed, 0);
  for (double& x : p) x = size_mm * (2.0 * rng.uniform() - 1.0);
  return p;
}

/// A plane below, a dome above.
const Corners kPlanoConvex{{0, 3}, {9, 3}, {9, 5}, {8, 7}, {6, 9}, {3, 10.5}, {0, 11}};
/// A cavity about the source, and a dome about it.
const Corners kDome{{0, 4}, {1.5, 3.7}, {3, 2.7}, {4, 0}, {12, 0}, {11, 5}, {8, 9}, {4, 11}, {0, 12}};
/// Pocket lens, pocket wall, bottom, total reflection, rim, exit.
const Corners kCollimator{{0, 4}, {2, 4}, {2, 0.1}, {3, 0.1}, {6, 4}, {9, 9}, {11, 14}, {11, 15}, {0, 15}};

struct LensCase {
  std::string name;
  LensShape shape;
  TentBins bins;
  double absorption_per_mm = 0.0;
  /// Light that one boundary reflected goes to and fro within a collimator: no step is small enough for it.
  bool ghosts = true;
};

LensCase lens_case(const std::string& name, const Corners& corners, const std::vector<std::size_t>& free,
                   int intervals, double size_mm, std::uint64_t seed, const TentBins& bins) {
  const LensShape plain(corners, 40.0, free, intervals);
  const LensShape shape = plain.with(random_moves(plain.parameter_count(), size_mm, seed));
  EXPECT_TRUE(shape.is_valid()) << name;
  return {name, shape, bins, 0.003 * static_cast<double>(seed % 3), seed < 5};
}

std::vector<LensCase> lens_cases() {
  const Frame up;
  const TentBins rings = TentBins::rings(up, 1.0, 32), square = TentBins::square(up, 0.8, 24);
  const TentBins plane = TentBins::plane(Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {3, 1, 90}), 70, 50, 16);
  return {lens_case("outer face", kPlanoConvex, {3}, 8, 0.05, 1, rings),
          lens_case("inner face", kDome, {1}, 6, 0.05, 2, rings),
          lens_case("both faces", kDome, {0, 6}, 7, 0.05, 3, square),
          lens_case("both faces, on a plane", kDome, {0, 6}, 5, 0.05, 4, plane),
          lens_case("collimator", kCollimator, {0, 1, 3, 7}, 5, 0.03, 5, rings),
          lens_case("collimator, square", kCollimator, {0, 1, 3, 7}, 4, 0.03, 6, square)};
}

/// How far a column of the Jacobian is from the best of central differences over three steps; a few rays
/// cross the ridge of a tent or an edge.
double lens_disagreement(const LensCase& c, const DesignRays& rays, LensEvaluationOptions options,
                         const BinJacobian& jacobian, Eigen::Index p) {
  options.derivatives = false;
  double best = 1e9;
  const MediumView medium{1.49, c.absorption_per_mm};
  for (const double step : {1e-5, 1e-6, 1e-7}) {
    Eigen::VectorXd x = c.shape.parameters();
    x[p] += step;
    const Eigen::VectorXd plus = evaluate_lens(c.shape.with(x), medium, rays, c.bins, options).flux;
    x[p] -= 2.0 * step;
    const Eigen::VectorXd minus = evaluate_lens(c.shape.with(x), medium, rays, c.bins, options).flux;
    const Eigen::VectorXd difference = (plus - minus) / (2.0 * step);
    const double scale = difference.norm() + 1e-3 * jacobian.colwise().norm().maxCoeff();
    best = std::min(best, (difference - jacobian.col(p)).norm() / scale);
  }
  return best;
}

TEST(LensEvaluation, DerivativesAgreeWithCentralDifferences) {
  DesignRays rays = disk_rays(1 << 13, 0.5);
  LensEvaluationOptions options;
  options.rays = 1 << 13;
  int checked = 0;
  for (const LensCase& c : lens_cases()) {
    options.ghost_every = c.ghosts ? 4 : 0;
    options.smooth_hits = kMaxLensHits;
    const Evaluation e = evaluate_lens(c.shape, {1.49, c.absorption_per_mm}, rays, c.bins, options);
    EXPECT_GT(e.flux.sum(), 0.2) << c.name;
    for (Eigen::Index p = 0; p < e.jacobian.cols(); ++p) {
      if (e.jacobian.col(p).norm() == 0.0) continue;
      ++checked;
      EXPECT_LT(lens_disagreement(c, rays, options, e.jacobian, p), 2e-3) << c.name << ", parameter " << p;
    }
  }
  EXPECT_GT(checked, 60);
}

// All light is accounted for but what three boundaries and more reflect. Without ghosts an eighth of it is
// not, and by those of one reflection some thousandths are not.
TEST(LensEvaluation, LightOfTwoPartialReflectionsIsFollowed) {
  DesignRays rays = disk_rays(1 << 18, 0.5);
  const LensShape shape(kPlanoConvex, 40.0, std::vector<std::size_t>{3}, 8);
  LensEvaluationOptions options;
  options.rays = 1 << 18;
  options.derivatives = false;
  const auto missing = [&] {
    const TentBins bins = TentBins::rings(Frame(), 1.0, 32);
    const Evaluation e = evaluate_lens(shape, {1.49, 0.0}, rays, bins, options);
    return 1.0 - (e.reflected + e.direct + e.absorbed + e.lost);
  };
  for (const int every : {1, 2, 4}) {
    options.ghost_every = every;
    EXPECT_NEAR(missing(), 0.0, 1e-3) << every;
  }
  options.ghost_every = 0;
  EXPECT_GT(missing(), 0.05);
}

}  // namespace
}  // namespace lucerna
