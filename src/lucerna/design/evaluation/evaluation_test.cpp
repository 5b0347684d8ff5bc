// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/evaluation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/evaluation/smooth_path.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace/engines/reference_tracer.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {
namespace {

DesignRays cylinder_rays(std::uint64_t n, double focal_mm) {
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  PlacedSource source{make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, focal_mm}), {}};
  DesignRays rays({source}, Frame(), 7);
  rays.grow(n);
  return rays;
}

Eigen::VectorXd random_parameters(std::size_t n, double size_mm, std::uint64_t seed) {
  Eigen::VectorXd p(static_cast<Eigen::Index>(n));
  Rng rng(seed, 0);
  for (double& x : p) x = size_mm * (2.0 * rng.uniform() - 1.0);
  return p;
}

/// A family with a name for messages.
struct Case {
  const char* name;
  DesignShape shape;
  TentBins bins;
};

/// 400 mm above the mirror and not square to its axis.
Frame tilted_plane() {
  return {Vec3{1, 0, 0}, Vec3{0, -std::cos(0.3), std::sin(0.3)}, Vec3{0, -std::sin(0.3), -std::cos(0.3)},
          Vec3{10, 20, 400}};
}

std::vector<Case> cases() {
  const Frame up;  // mirror frames open along +z, where the light goes
  const auto wild = [](const DesignShape& s, double mm, std::uint64_t seed) {
    return s.with(random_parameters(s.parameter_count(), mm, seed));
  };
  const Aperture square = Aperture::rectangle(100, 100, 8), round = Aperture::circle(100);
  return {
      {"revolution", wild(DesignShape::revolution(15, round, 8), 0.5, 1), TentBins::rings(up, 0.5, 48)},
      {"revolution, two bounces", wild(DesignShape::revolution(4, round, 8), 0.3, 2),
       TentBins::rings(up, 0.5, 48)},
      {"bspline", wild(DesignShape::bspline(15, square, 4, 4), 0.6, 3), TentBins::square(up, 0.4, 48)},
      {"bspline, fine", wild(DesignShape::bspline(15, round, 11, 7), 0.3, 4), TentBins::square(up, 0.4, 32)},
      {"bspline, two bounces", wild(DesignShape::bspline(4, square, 4, 4), 0.4, 5),
       TentBins::square(up, 0.5, 32)},
      {"bspline, symmetric", wild(DesignShape::bspline(15, square, 5, 6, ShapeSymmetry::both), 0.5, 6),
       TentBins::square(up, 0.4, 48)},
      {"bspline, on a plane", wild(DesignShape::bspline(15, square, 4, 4), 0.6, 7),
       TentBins::plane(tilted_plane(), 150.0, 100.0, 32)},
      {"revolution, on a plane", wild(DesignShape::revolution(15, round, 8), 0.5, 8),
       TentBins::plane(tilted_plane(), 150.0, 100.0, 32)},
      {"bspline, glare zone", wild(DesignShape::bspline(4, square, 4, 4), 0.6, 9),
       TentBins::zone(up, 0.15, 16, 12)},
  };
}

// A mirror far below its base paraboloid at the rim: light that passes over the rim is on its way to where
// the spline would be if it went on. (It was lost: 0.8 % of a lamp's light.)
TEST(SmoothPath, LightOverALowRimPassesTheMirror) {
  const DesignShape plain = DesignShape::revolution(12.0, Aperture::circle(80.0), 16);
  Eigen::VectorXd p = plain.parameters();
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    const double r = 2.5 * static_cast<double>(i);
    p[i] = -4.0 - r * r / 80.0 - 0.3 * std::cos(0.4 * r);  // the rim 20 to 25 mm below the paraboloid's
  }
  const DesignShape low = plain.with(p);
  const auto& shape = std::get<RevolutionShape>(low.family());
  const SmoothTracer<RevolutionView> tracer(shape.view(), low.aperture());
  const double rim_mm = smooth_point(shape.view(), 40.0, 0.0).z_mm;
  Path<RevolutionView> path;
  int over = 0;
  for (std::uint64_t i = 0; i < 20000; ++i) {
    Rng rng(3, i);
    const double phi = 2.0 * std::numbers::pi * rng.uniform(), fall = 0.8 * rng.uniform();
    const Vec3 o{3.0 * (2.0 * rng.uniform() - 1.0), 3.0 * (2.0 * rng.uniform() - 1.0), 20.0};
    const Vec3 d = Direction::from({std::cos(phi), std::sin(phi), -fall}).vec();
    tracer.trace(o, d, path);
    ASSERT_NE(path.end, PathEnd::lost) << i;
    // Where it is over the rim's circle.
    const double across = d.x * d.x + d.y * d.y, b = o.x * d.x + o.y * d.y;
    const double t = (-b + std::sqrt(b * b - across * (o.x * o.x + o.y * o.y - 1600.0))) / across;
    if (o.z + t * d.z > rim_mm + 1.0) {  // the profile rises to the rim
      EXPECT_EQ(path.end, PathEnd::direct) << i;
      ++over;
    }
  }
  EXPECT_GT(over, 2000);
}

TEST(SmoothPath, FindsTheHitsOfTheReferenceTracer) {
  DesignRays rays = cylinder_rays(1 << 13, 4.0);
  for (const Case& c : cases()) {
    const ReferenceTracer reference(c.shape.reflector(), 8);
    int differing = 0, hits = 0;
    std::visit(
        [&](const auto& s) {
          using Shape = decltype(s.view());
          const SmoothTracer<Shape> tracer(s.view(), c.shape.aperture());
          Path<Shape> path;
          for (std::size_t i = 0; i < 4096; ++i) {
            const DesignRays::Block& b = rays.block(i / kBlockRays);
            const std::size_t k = i % kBlockRays;
            Ray ray{{b.x_mm[k], b.y_mm[k], b.z_mm[k]}, Direction::from({b.kx[k], b.ky[k], b.kz[k]})};
            tracer.trace(ray.origin_mm, ray.direction.vec(), path);
            int bounces = 0;
            PathEnd end = PathEnd::lost;
            for (;;) {
              const auto hit = reference.first_hit(ray);
              if (!hit) {
                end = bounces == 0 ? PathEnd::direct : PathEnd::reflected;
                break;
              }
              if (!hit->front) {
                end = PathEnd::back;
                break;
              }
              ++bounces;
              ray = {hit->point_mm, Direction::from(reflect(ray.direction, hit->normal))};
            }
            hits += bounces;
            const bool same = end == path.end && (end == PathEnd::back || bounces == path.hits) &&
                              (end == PathEnd::back || length(path.direction - ray.direction.vec()) < 1e-6);
            if (!same) ++differing;
          }
        },
        c.shape.family());
    EXPECT_GT(hits, 2000) << c.name;
    // The reference misses what grazes the surface twice within one of its cells.
    EXPECT_LE(differing, 2) << c.name;
  }
}

/// How far one column of the Jacobian is from the best of central differences over three steps: small enough
/// that almost no ray crosses the ridge of a tent or a rim; a few do. A coefficient at the edge of the light
/// moves a ray or two; it counts against the others.
double disagreement(const DesignShape& shape, const DesignRays& rays, const TentBins& bins,
                    EvaluationOptions options, const BinJacobian& jacobian, Eigen::Index p) {
  options.derivatives = false;
  double best = 1e9;
  for (const double step : {1e-5, 1e-6, 1e-7}) {
    Eigen::VectorXd x = shape.parameters();
    x[p] += step;
    const Eigen::VectorXd plus = evaluate(shape.with(x), Reflectance(0.9), rays, bins, options).flux;
    x[p] -= 2.0 * step;
    const Eigen::VectorXd minus = evaluate(shape.with(x), Reflectance(0.9), rays, bins, options).flux;
    const Eigen::VectorXd difference = (plus - minus) / (2.0 * step);
    const double scale = difference.norm() + 1e-3 * jacobian.colwise().norm().maxCoeff();
    best = std::min(best, (difference - jacobian.col(p)).norm() / scale);
  }
  return best;
}

TEST(Evaluation, DerivativesAgreeWithCentralDifferences) {
  DesignRays rays = cylinder_rays(1 << 13, 15.0);
  EvaluationOptions options;
  options.rays = 1 << 13;
  int checked = 0;
  for (const Case& c : cases()) {
    const Evaluation e = evaluate(c.shape, Reflectance(0.9), rays, c.bins, options);
    for (Eigen::Index p = 0; p < e.jacobian.cols(); ++p) {
      if (e.jacobian.col(p).norm() == 0.0) continue;
      ++checked;
      EXPECT_LT(disagreement(c.shape, rays, c.bins, options, e.jacobian, p), 1e-3)
          << c.name << ", parameter " << p;
    }
  }
  EXPECT_GT(checked, 200);
}

/// Random shapes of all families and sizes, in bins of all kinds, 1000 random parameters.
TEST(EvaluationSlow, DerivativesOfAThousandParameters) {
  DesignRays rays = cylinder_rays(1 << 13, 15.0);
  EvaluationOptions options;
  options.rays = 1 << 13;
  int checked = 0;
  for (std::uint64_t seed = 0; checked < 1000; ++seed) {
    Rng rng(seed, 99);
    const auto between = [&](int low, int high) {
      return low + static_cast<int>(rng.uniform() * (high - low + 1));
    };
    const double focal = 4.0 + 16.0 * rng.uniform(), hole = rng.uniform() < 0.5 ? 0.0 : 6.0;
    const Aperture round = Aperture::circle(90, hole), square = Aperture::rectangle(100, 70, hole);
    const bool revolution = seed % 3 == 0;
    const auto symmetry = static_cast<ShapeSymmetry>(between(0, 3));
    const DesignShape plain = revolution ? DesignShape::revolution(focal, round, between(2, 24))
                              : seed % 7 == 1
                                  ? DesignShape::trough(focal, square, between(2, 16), rng.uniform() < 0.5)
                                  : DesignShape::bspline(focal, seed % 2 == 0 ? square : round,
                                                         between(2, 12), between(2, 12), symmetry);
    const DesignShape shape =
        plain.with(random_parameters(plain.parameter_count(), 0.1 + 0.5 * rng.uniform(), seed));
    const TentBins plane =
        TentBins::plane(Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {30, 10, 900}), 500, 400, between(8, 32));
    const TentBins bins = seed % 5 == 4 ? plane
                          : revolution
                              ? TentBins::rings(Frame(), 0.3 + 0.6 * rng.uniform(), between(12, 48))
                              : TentBins::square(Frame(), 0.2 + 0.5 * rng.uniform(), between(12, 48));
    const Evaluation e = evaluate(shape, Reflectance(0.9), rays, bins, options);
    ASSERT_GT(e.flux.sum(), 0.05) << seed;
    for (int k = 0; k < 12; ++k) {
      const Eigen::Index p = between(0, static_cast<int>(e.jacobian.cols()) - 1);
      if (e.jacobian.col(p).norm() < 1e-3 * e.jacobian.colwise().norm().maxCoeff()) continue;
      ++checked;
      EXPECT_LT(disagreement(shape, rays, bins, options, e.jacobian, p), 1e-3)
          << "seed " << seed << ", parameter " << p;
    }
  }
}

TEST(Evaluation, IsTheSameForAnyNumberOfThreads) {
  DesignRays rays = cylinder_rays(1 << 15, 15.0);
  const Case c = cases()[2];
  EvaluationOptions options;
  options.rays = 1 << 15;
  const Evaluation many = evaluate(c.shape, Reflectance(0.9), rays, c.bins, options);
  const ThreadLimit limit(1);
  const Evaluation one = evaluate(c.shape, Reflectance(0.9), rays, c.bins, options);
  EXPECT_EQ(many.flux, one.flux);
  EXPECT_EQ(many.jacobian, one.jacobian);
  EXPECT_EQ(many.variance, one.variance);
}

TEST(Evaluation, ClosesTheEnergy) {
  DesignRays rays = cylinder_rays(1 << 14, 4.0);
  for (const Case& c : cases()) {
    EvaluationOptions options;
    options.rays = 1 << 14;
    const Evaluation e = evaluate(c.shape, Reflectance(0.8), rays, c.bins, options);
    EXPECT_NEAR(e.reflected + e.direct + e.absorbed + e.back + e.lost, 1.0, 1e-12) << c.name;
    EXPECT_EQ(e.lost, 0.0) << c.name;
    EXPECT_GT(e.reflected, 0.3) << c.name;
  }
}

}  // namespace
}  // namespace lucerna
