// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/initial/zero_etendue.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/evaluation/smooth_path.h"
#include "lucerna/design/solver/least_squares.h"
#include "lucerna/source.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {
namespace {

constexpr std::uint64_t kPointRays = 1 << 16;
constexpr double kFocal_mm = 15.0;

DesignRays rays_of(EmitterKind kind) {
  EmitterOptions options;
  options.kind = kind;
  DesignRays rays({{make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, kFocal_mm}), {}}},
                  Frame(), 3);
  rays.grow(kPointRays);
  return rays;
}

EvaluationOptions reflected_point() {
  EvaluationOptions options;
  options.rays = kPointRays;
  options.derivatives = false;
  options.direct_light = false;
  return options;
}

/// The least error against a target among shapes, whatever the scale.
double min_error(const std::vector<DesignShape>& shapes, const DesignRays& rays, const TentBins& bins,
                 const Eigen::VectorXd& target) {
  double min = 1e9;
  for (const DesignShape& s : shapes) {
    const Evaluation e = evaluate(s, Reflectance(1.0), rays, bins, reflected_point());
    min = std::min(min, bin_error(e, target, bins, TargetMode::shape).relative_rms);
  }
  return min;
}

/// Light of an intensity over direction cosines, as small cells.
std::vector<DirectedFlux> cells(double half_u, double half_v, int count) {
  std::vector<DirectedFlux> light;
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      const double u = half_u * ((2.0 * i + 1.0) / count - 1.0), v = half_v * ((2.0 * j + 1.0) / count - 1.0);
      const double w = std::sqrt(1.0 - u * u - v * v);
      light.push_back({Direction::from_unit({u, v, w}), 1.0 / w});
    }
  }
  return light;
}

TEST(ZeroEtendue, FindsThePointThatRaysComeFrom) {
  for (const EmitterKind kind : {EmitterKind::point, EmitterKind::cylinder, EmitterKind::sphere}) {
    const DesignRays rays = rays_of(kind);
    const PointSource source = point_source(rays, kPointRays);
    EXPECT_LT(length(source.at_mm - Vec3{0, 0, kFocal_mm}), 0.02);
    double flux = 0.0;
    for (const DirectedFlux& l : source.light) flux += l.flux;
    EXPECT_NEAR(flux, 1.0, 1e-9);
  }
}

TEST(ZeroEtendue, APointSourceGivesAnyRotationalBeam) {
  const DesignRays rays = rays_of(EmitterKind::point);
  const DesignShape plain = DesignShape::revolution(kFocal_mm, Aperture::circle(100), 24);
  const TentBins bins = TentBins::rings(Frame(), 0.5, 24);
  // A batwing: brighter towards the edge of its 20 degrees.
  const auto intensity = [](const Direction& d) {
    const double gamma = angle_between(d, Direction());
    return gamma < 0.35 ? 1.0 + 8.0 * gamma : 0.0;
  };
  std::vector<DirectedFlux> target_flux;
  for (int i = 0; i < 700; ++i) {
    const double gamma = (i + 0.5) * 5e-4;
    const Direction d = Direction::from_unit({std::sin(gamma), 0, std::cos(gamma)});
    target_flux.push_back({d, intensity(d) * std::sin(gamma)});
  }
  const std::vector<double> flux = bins.flux_of(intensity);
  const Eigen::VectorXd target = Eigen::Map<const Eigen::VectorXd>(flux.data(), bins.count());
  const std::vector<DesignShape> shapes =
      zero_etendue_shapes(plain, point_source(rays, kPointRays), target_flux, 0.0);
  ASSERT_GE(shapes.size(), 2u);
  EXPECT_LT(min_error(shapes, rays, bins, target), 0.06);
  EXPECT_GT(min_error({plain}, rays, bins, target), 0.9);
  for (const DesignShape& s : shapes) EXPECT_NEAR(s.at(0, 0).z_mm, 0.0, 0.05);
}

TEST(ZeroEtendue, ParaboloidsMakeARectangleOfLight) {
  const DesignRays rays = rays_of(EmitterKind::sphere);  // 1 mm in radius, 4 degrees from the vertex
  const DesignShape plain = DesignShape::bspline(kFocal_mm, Aperture::rectangle(80, 80), 10, 10);
  const std::vector<DirectedFlux> target_flux = cells(0.4, 0.2, 16);
  const TentBins bins = TentBins::square(Frame(), 0.5, 16);
  const std::vector<double> flux = bins.flux_of(
      [](const Direction& d) { return std::abs(d.x()) < 0.4 && std::abs(d.y()) < 0.2 ? 1.0 : 0.0; });
  const Eigen::VectorXd target =
      Eigen::Map<const Eigen::VectorXd>(flux.data(), static_cast<Eigen::Index>(flux.size()));
  const std::vector<DesignShape> shapes =
      zero_etendue_shapes(plain, point_source(rays, kPointRays), target_flux, 0.05);
  ASSERT_GE(shapes.size(), 1u);
  EXPECT_LT(min_error(shapes, rays, bins, target), 0.35);
  EXPECT_GT(min_error({plain}, rays, bins, target), 0.8);
}

TEST(ZeroEtendue, ATroughSpreadsTheLightOfALine) {
  // A thin rod along y; what counts is the light's angle across it.
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  options.radius_mm = 0.05;
  options.length_mm = 60;
  DesignRays rays({{make_emitter(options), Frame({1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, 0, kFocal_mm}), {}}},
                  Frame(), 3);
  rays.grow(kPointRays);
  const DesignShape plain = DesignShape::trough(kFocal_mm, Aperture::rectangle(80, 200), 16);
  const auto across = [](const Direction& d) { return std::atan2(d.x(), d.z()); };
  // Twice as much light to one side as to the other, within 25 degrees.
  std::vector<DirectedFlux> target_flux;
  for (int i = 0; i < 500; ++i) {
    const double gamma = radians(25.0) * ((i + 0.5) / 250.0 - 1.0);
    target_flux.push_back(
        {Direction::from_unit({std::sin(gamma), 0, std::cos(gamma)}), gamma > 0.0 ? 2.0 : 1.0});
  }
  const std::vector<DesignShape> shapes =
      zero_etendue_shapes(plain, point_source(rays, kPointRays), target_flux, 0.0);
  ASSERT_GE(shapes.size(), 1u);
  const auto shares = [&](const DesignShape& s) {  // of the reflected light in bins of the angle across
    const SmoothTracer<BsplineView> tracer(std::get<BsplineShape>(s.family()).view(), s.aperture());
    Path<BsplineView> path;
    Eigen::VectorXd share = Eigen::VectorXd::Zero(12);
    for (std::uint64_t b = 0; b < kPointRays / kBlockRays; ++b) {
      const DesignRays::Block& block = rays.block(b);
      for (std::size_t k = 0; k < kBlockRays; ++k) {
        tracer.trace({block.x_mm[k], block.y_mm[k], block.z_mm[k]}, {block.kx[k], block.ky[k], block.kz[k]},
                     path);
        if (path.end != PathEnd::reflected) continue;
        const double a = degrees(across(Direction::from(path.direction)));
        if (std::abs(a) < 30.0) share[static_cast<Eigen::Index>((a + 30.0) / 5.0)] += 1.0;
      }
    }
    return Eigen::VectorXd(share / share.sum());
  };
  Eigen::VectorXd target = Eigen::VectorXd::Zero(12);
  target.segment(1, 5).setConstant(1.0 / 15.0);
  target.segment(6, 5).setConstant(2.0 / 15.0);
  double min = 1e9;
  for (const DesignShape& s : shapes) min = std::min(min, (shares(s) - target).norm() / target.norm());
  EXPECT_LT(min, 0.12);
  EXPECT_GT((shares(plain) - target).norm() / target.norm(), 0.8);
}

TEST(ZeroEtendue, NoLightAndNoRoomGiveNoShapes) {
  const DesignRays rays = rays_of(EmitterKind::point);
  const DesignShape plain = DesignShape::revolution(kFocal_mm, Aperture::circle(100), 8);
  PointSource source = point_source(rays, kPointRays);
  EXPECT_TRUE(zero_etendue_shapes(plain, source, {}, 0.0).empty());
  source.at_mm.z = -5.0;  // behind the mirror
  EXPECT_TRUE(zero_etendue_shapes(plain, source, cells(0.3, 0.3, 8), 0.0).empty());
  const DesignShape free_form = DesignShape::bspline(kFocal_mm, Aperture::rectangle(80, 80), 4, 4);
  EXPECT_TRUE(zero_etendue_shapes(free_form, source, cells(0.3, 0.3, 8), 0.05).empty());
}

}  // namespace
}  // namespace lucerna
