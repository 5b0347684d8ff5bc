// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/constraints/zone_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lucerna/design/fit/graded_bins.h"
#include "lucerna/design/problem/zone_guide.h"
#include "lucerna/design/search/free_form_search.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

constexpr std::uint64_t kCostRays = std::uint64_t{1} << 15;
constexpr double kCostFlux = 100.0;

/// A disk of 1 mm that shines down into a mirror of 60 mm; light leaves along +z. The mirror's frame is the
/// world's.
DesignRays cost_rays(std::uint64_t seed = 3) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 0.5;
  options.flux = kCostFlux;
  PlacedSource source{make_emitter(options), Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 15}), {}};
  return DesignRays({source}, Frame(), seed);
}

/// About +z: v towards +y, h towards -x.
ZoneBands bands(std::vector<TargetZone> zones, bool only = false) {
  return {std::make_shared<const ZoneCells>(std::move(zones), Direction(), std::nullopt), kCostFlux, Frame(),
          only};
}
TargetZone zone(ZoneRange h, ZoneRange v, std::vector<ZoneBound> bounds, double cell = 2.0) {
  return {"z", ZoneCoordinates::h_v, v, h, cell, std::move(bounds)};
}

TargetRectangle rectangle() { return {Frame(), false, -0.5, 0.5, -0.3, 0.3}; }
TentBins fine_bins() { return graded_bins(rectangle(), Frame(), 48, 1.25); }

/// A mirror that is wavy enough to throw light everywhere in the zones.
DesignShape wavy() {
  const DesignShape plain = DesignShape::bspline(15, Aperture::circle(60, 4), 8, 8);
  Eigen::VectorXd p = plain.parameters();
  for (Eigen::Index i = 0; i < p.size(); ++i) p[i] += 0.4 * std::sin(1.7 * static_cast<double>(i));
  return plain.with(p);
}

Evaluation light(const DesignShape& shape, const DesignRays& rays, const TentBins& bins, bool derivatives) {
  EvaluationOptions options;
  options.rays = kCostRays;
  options.derivatives = derivatives;
  options.sparse = derivatives;
  return evaluate(shape, Reflectance(0.9), rays, bins, options);
}

TEST(ZoneCost, ValuesAreTheIntensityOfEvenLight) {
  const TentBins bins = fine_bins();
  const std::vector<double> flux = bins.flux_of([](const Direction&) { return 0.25; });  // shares per sr
  Evaluation e;
  e.flux = Eigen::Map<const Eigen::VectorXd>(flux.data(), static_cast<Eigen::Index>(flux.size()));
  const ZoneCost cost(bands({zone({-20, 20}, {-10, 10}, {{"min_cd", true, 20.0}}),
                             zone({0, 0}, {0, 0}, {{"min_cd", true, 20.0}}),
                             zone({120, 170}, {0, 0}, {{"max_cd", false, 20.0}})}),
                      bins, kCostRays, 1.0);
  const Eigen::VectorXd x = cost.values(e);
  const auto seen = static_cast<Eigen::Index>(x.size()) - 25;
  for (Eigen::Index c = 0; c < seen; ++c) EXPECT_NEAR(x[c], 0.25 * kCostFlux, 0.02 * kCostFlux * 0.25) << c;
  EXPECT_TRUE(std::isnan(x[seen]));  // behind: no bin sees it
  EXPECT_EQ(cost.cost(e), 0.0);      // 25 cd where 20 are asked for
  e.flux *= 0.8;                     // exactly the bound: a margin short
  EXPECT_GT(cost.cost(e), 0.5);
}

/// The gradient of the cost against central differences along directions in which all parameters move.
void expect_gradient(const ZoneBands& zones) {
  DesignRays rays = cost_rays();
  rays.grow(kCostRays);
  const TentBins bins = fine_bins();
  const ZoneCost cost(zones, bins, kCostRays, 1.0);
  const DesignShape shape = wavy();
  const Evaluation e = light(shape, rays, bins, true);
  SparseEquations equations;
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  equations.gradient = Eigen::VectorXd::Zero(n);
  equations.hessian.resize(n, n);
  cost.add_to(e, equations);
  EXPECT_NEAR(equations.cost, cost.cost(e), 1e-9 * equations.cost);
  ASSERT_GT(equations.cost, 0.1);
  for (const double phase : {0.0, 1.0, 2.0}) {
    Eigen::VectorXd along(n);
    for (Eigen::Index i = 0; i < n; ++i) along[i] = std::sin(phase + 0.37 * static_cast<double>(i));
    constexpr double kStep = 1e-5;
    const double up = cost.cost(light(shape.with(shape.parameters() + kStep * along), rays, bins, false));
    const double down = cost.cost(light(shape.with(shape.parameters() - kStep * along), rays, bins, false));
    const double differences = (up - down) / (2.0 * kStep), exact = 2.0 * equations.gradient.dot(along);
    EXPECT_NEAR(exact, differences, 0.01 * std::abs(differences) + 1e-3 * equations.cost) << phase;
  }
}

TEST(ZoneCost, GradientOfAbsoluteBounds) {
  expect_gradient(
      bands({zone({-20, 20}, {-10, 10}, {{"min_cd", true, 150.0}, {"max_cd", false, 160.0}}, 4.0)}));
}

TEST(ZoneCost, GradientOfUniformity) {
  expect_gradient(
      bands({zone({-20, 20}, {-10, 10}, {{"min_of_mean", true, 0.9, ZoneReference::mean, 0}}, 4.0)}));
}

/// The Hessian is that of Gauss-Newton: positive, and along a direction the squares of the rows' slopes.
TEST(ZoneCost, ProductsMakeTheGaussNewtonHessianOfARatio) {
  DesignRays rays = cost_rays();
  rays.grow(kCostRays);
  const TentBins bins = fine_bins();
  const ZoneCost cost(
      bands({zone({-20, 20}, {-10, 10}, {{"min_of_mean", true, 0.9, ZoneReference::mean, 0}}, 4.0)}), bins,
      kCostRays, 1.0);
  const DesignShape shape = wavy();
  Evaluation e = light(shape, rays, bins, true);
  SparseEquations equations;
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  equations.gradient = Eigen::VectorXd::Zero(n);
  equations.hessian.resize(n, n);
  cost.add_to(e, equations);
  // All light brighter by the same factor changes no ratio: along d flux = flux there is no slope. One more
  // parameter that does just that:
  SparseJacobian wide(e.rows.rows(), 1);
  for (Eigen::Index b = 0; b < e.flux.size(); ++b) {
    if (e.flux[b] != 0.0) wide.insert(b, 0) = e.flux[b];
  }
  e.rows = wide;
  SparseEquations scaled;
  scaled.gradient = Eigen::VectorXd::Zero(1);
  scaled.hessian.resize(1, 1);
  cost.add_to(e, scaled);
  double curved = scaled.hessian.coeff(0, 0);
  for (const SparseEquations::Product& p : scaled.products) curved += p.weight * p.v[0] * p.v[0];
  EXPECT_NEAR(scaled.gradient[0], 0.0, 1e-9 * equations.cost);
  EXPECT_NEAR(curved, 0.0, 1e-9 * scaled.hessian.coeff(0, 0));
  EXPECT_GT(scaled.hessian.coeff(0, 0), 1.0);
}

/// A table of zones alone: the search raises the field above its minimum and holds the glare down.
TEST(ZoneCost, ASearchEndsWithTheBandsHeld) {
  DesignRays rays = cost_rays();
  rays.grow(std::uint64_t{1} << 14);
  FitProblem p{&rays, Reflectance(0.9), {}, TentBins::square(Frame(), 0.6, 48), TargetMode::shape};
  p.zones = bands({zone({-16, 16}, {-8, 8}, {{"min_cd", true, 250.0}}),
                   zone({-40, 40}, {-40, 40}, {{"max_cd", false, 700.0}}, 4.0)},
                  true);
  const IntensityDistribution guide = guide_distribution(*p.zones.cells, FluxUnit::lumen);
  p.target = [&guide](const TentBins& bins) {
    const std::vector<double> flux = bins.flux_of([&](const Direction& d) { return intensity_in(guide, d); });
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(flux.data(), static_cast<Eigen::Index>(flux.size())));
  };
  p.flux_weight = 0.03;
  p.flux_reference = 0.9;
  p.rectangle = target_rectangle(guide);
  const DesignShape given = DesignShape::bspline(15, Aperture::circle(60, 4), 8, 8);
  FreeFormSearch search(p, given, 16, std::uint64_t{1} << 16);
  // All candidates, the best of them finely and to the end.
  for (int i = 0; i < 400 && !search.done(); ++i) {
    search.step();
    const auto& done = search.state().done;
    if (std::any_of(done.begin(), done.end(), [](const FreeFormSnapshot& m) { return m.level == 2; })) break;
  }
  DesignRays fresh = cost_rays(99);
  fresh.grow(std::uint64_t{1} << 19);
  const TentBins bins = graded_bins(p.rectangle, Frame(), 64, 1.25, 24);
  EvaluationOptions options;
  options.rays = std::uint64_t{1} << 19;
  options.derivatives = false;
  const ZoneCost cost(p.zones, bins, options.rays, 1.0);
  const auto range = [&](const DesignShape& shape) {
    const Eigen::VectorXd x = cost.values(evaluate(shape, p.reflectance, fresh, bins, options));
    const auto field = static_cast<Eigen::Index>(p.zones.cells->first(1));
    return std::pair(x.head(field).minCoeff(), x.tail(x.size() - field).maxCoeff());
  };
  const auto [min, max] = range(search.best());
  const auto [min_given, max_given] = range(given);
  // What coarse knots and few rays leave is some per cent; the given mirror has a spot.
  EXPECT_GT(min, 0.93 * 250.0);
  EXPECT_LT(max, 1.07 * 700.0);
  EXPECT_LT(min_given, 50.0);
  EXPECT_GT(max_given, 2000.0);
}

}  // namespace
}  // namespace lucerna
