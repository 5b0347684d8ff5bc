// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/refracting_face.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/shape/perturbed.h"
#include "lucerna/random.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

constexpr double kIndex = 1.5, kSourceMm = 15.0;
constexpr std::uint64_t kFaceRays = std::uint64_t{1} << 15;

/// A disk at z = 15 that shines down.
DesignRays disk_source(double radius_mm) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = radius_mm;
  return {
      {{make_emitter(options), Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, kSourceMm}), {}}}, Frame(), 3};
}

/// Into a medium that begins `gap_mm` below it with a flat face.
DesignRays disk_in_lens(double radius_mm, double absorption_per_mm = 0.0, double gap_mm = 0.5) {
  DesignRays rays = disk_source(radius_mm);
  rays.refract({kIndex, absorption_per_mm}, [gap_mm](Ray& ray) {
    const Direction up = Direction::from({0, 0, 1});
    const Boundary found = boundary(kIndex, -ray.direction.z());
    ray = {ray.at(gap_mm / -ray.direction.z()), Direction::from(refracted(ray.direction, up, kIndex, found))};
    return 1.0 - found.reflectance();
  });
  rays.grow(kFaceRays);
  return rays;
}

/// A dome of 30 mm below it, with waves.
DesignShape wavy_dome() {
  return perturbed(DesignShape::bspline(9, Aperture::circle(30), 8, 8), 0.3, Rng(1, 2));
}

// The ellipsoid that sends the light of a focus along its axis: r (1 - cos / n) is the same everywhere
// (Descartes).
TEST(RefractingFace, AnEllipsoidMakesLightOfItsFocusParallel) {
  const double vertex_mm = 12.0;
  const auto height = [&](double x, double y) {
    // Solved for the depth w below the focus: sqrt(r^2 + w^2) - w / n = vertex (1 - 1 / n).
    const double k = 1.0 / kIndex, b = vertex_mm * (1.0 - k), r2 = x * x + y * y;
    return kSourceMm - (b * k + std::sqrt(b * b - (1.0 - k * k) * r2)) / (1.0 - k * k);
  };
  const DesignShape face = DesignShape::bspline(9, Aperture::circle(6), 40, 40).through(height);
  const auto view = std::get<BsplineShape>(face.family()).view();
  Rng rng(4, 0);
  for (int i = 0; i < 1000; ++i) {
    const double x = 4.0 * rng.uniform() - 2.0, y = 4.0 * rng.uniform() - 2.0;
    const Vec3 from{0, 0, kSourceMm}, way = Vec3{x, y, height(x, y)} - from;
    FaceHit hit;
    ASSERT_TRUE(
        refract_at(view, media_of_last_face({kIndex, 0.0}), from, way / length(way), length(way), hit));
    EXPECT_NEAR(hit.out.z, -1.0, 1e-7);
    EXPECT_NEAR(length(hit.out), 1.0, 1e-12);
  }
}

// At the axis 4 % are reflected; what is absorbed goes with the way.
TEST(RefractingFace, LightIsLostByFresnelAndByAbsorption) {
  const DesignShape face = DesignShape::bspline(1e4, Aperture::circle(60), 4, 4);
  const auto view = std::get<BsplineShape>(face.family()).view();
  FaceHit hit;
  ASSERT_TRUE(
      refract_at(view, media_of_last_face({kIndex, 0.01}), {0, 0, kSourceMm}, {0, 0, -1}, kSourceMm, hit));
  EXPECT_NEAR(hit.share, 0.96 * std::exp(-0.15), 1e-9);
  const double beyond = std::asin(1.0 / kIndex) + 0.01;  // total reflection
  EXPECT_FALSE(refract_at(view, media_of_last_face({kIndex, 0.01}), {0, 0, kSourceMm},
                          {std::sin(beyond), 0, -std::cos(beyond)}, kSourceMm / std::cos(beyond), hit));
}

Evaluation light_through(const DesignShape& face, const DesignRays& rays, const TentBins& bins,
                         bool derivatives) {
  EvaluationOptions options;
  options.rays = kFaceRays;
  options.direct_light = false;
  options.derivatives = derivatives;
  return evaluate(face, Reflectance(1.0), rays, bins, options);
}

/// Of every parameter, of sums over bins with random weights: what leaves, where to, and what is absorbed.
void expect_exact_derivatives(const DesignRays& rays, const DesignShape& face, double tolerance) {
  const Frame down({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {});
  for (const TentBins& bins :
       {TentBins::square(down, 0.9, 24),
        TentBins::plane(Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -80}), 120, 120, 24)}) {
    const Evaluation at = light_through(face, rays, bins, true);
    EXPECT_GT(at.flux.sum(), 0.5);
    Rng rng(9, 0);
    Eigen::VectorXd weights(at.flux.size());
    for (double& w : weights) w = rng.uniform();
    const Eigen::VectorXd slopes = at.jacobian.transpose() * weights;
    const double largest = slopes.cwiseAbs().maxCoeff();
    for (Eigen::Index p = 0; p < slopes.size(); ++p) {
      constexpr double kStep = 1e-4;
      Eigen::VectorXd moved = face.parameters();
      const auto sum = [&](double step) {
        moved[p] = face.parameters()[p] + step;
        return light_through(face.with(moved), rays, bins, false).flux.dot(weights);
      };
      EXPECT_NEAR(slopes[p], (sum(kStep) - sum(-kStep)) / (2 * kStep), tolerance * largest) << p;
    }
  }
}

TEST(RefractingFace, DerivativesAgreeWithCentralDifferences) {
  expect_exact_derivatives(disk_in_lens(0.5, 0.01), wavy_dome(), 2e-3);
}

/// The disk shines down onto a first face, and the dome is the last.
DesignRays disk_before_lens(const DesignShape& last) {
  DesignRays rays = disk_source(0.5);
  rays.refract_in({kIndex, 0.01}, last);
  rays.grow(kFaceRays);
  return rays;
}

/// A hollow face 3 mm below the disk, with waves.
DesignShape wavy_entry() {
  const DesignShape flat = DesignShape::bspline(1e4, Aperture::circle(24), 8, 8);
  return perturbed(flat.through([](double x, double y) { return 12.0 - 0.02 * x * x - 0.015 * y * y; }), 0.2,
                   Rng(5, 2));
}

TEST(RefractingFace, DerivativesOfTheFirstFaceGoThroughTheLast) {
  // A way of two faces crosses more edges of bins.
  expect_exact_derivatives(disk_before_lens(wavy_dome()), wavy_entry(), 4e-3);
}

// A flat first face where rays came into the medium: both tracers see the same lens.
TEST(RefractingFace, AFlatFirstFaceIsWhatRaysComeInBy) {
  const DesignRays before = disk_before_lens(wavy_dome()), within = disk_in_lens(0.5, 0.01);
  const DesignShape flat = DesignShape::bspline(1e4, Aperture::circle(60), 4, 4).through([](double, double) {
    return kSourceMm - 0.5;
  });
  const Frame down({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {});
  const TentBins bins = TentBins::square(down, 0.9, 24);
  const Evaluation two = light_through(flat, before, bins, false),
                   one = light_through(wavy_dome(), within, bins, false);
  // Shares are of the light that is traced: there, of what comes in.
  double entered = 0.0;
  for (std::uint64_t b = 0; b < kFaceRays / kBlockRays; ++b) {
    for (const float w : within.block(b).weight) entered += static_cast<double>(w) / kFaceRays;
  }
  EXPECT_LT((two.flux - entered * one.flux).cwiseAbs().sum(), 1e-4 * two.flux.sum());
  EXPECT_GT(two.flux.sum(), 0.4);
}

}  // namespace
}  // namespace lucerna
