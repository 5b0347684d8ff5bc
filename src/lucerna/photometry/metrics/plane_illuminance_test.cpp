// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/plane_illuminance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {
namespace {

IntensityDistribution filled_by_angle(const std::function<double(double c_rad, double g_rad)>& cd) {
  IntensityDistribution d = uniform_distribution(5.0, 1.0);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g)
      d.at(c, g) = cd(radians(d.c_deg[c]), radians(d.gamma_deg[g]));
  }
  return d;
}

IntensityDistribution lambertian() {
  return filled_by_angle([](double, double g) { return 800.0 * std::max(0.0, std::cos(g)); });
}

PlaneIlluminance below(const IntensityDistribution& d, double distance_mm, double size_mm) {
  return plane_illuminance(d, {.luminaire_from_plane = plane_frame({.distance_mm = distance_mm}),
                               .size_x_mm = size_mm,
                               .size_y_mm = size_mm});
}

// I0 cos(gamma) on a plane at h: E = I0 h^2 / (h^2 + rho^2)^2. The grid is linear between 1 degree steps,
// which is 4e-5 below the cosine at most.
TEST(PlaneIlluminance, LambertianEmitterOverAPlane) {
  const PlaneIlluminance e = below(lambertian(), 2000.0, 12000.0);
  EXPECT_DOUBLE_EQ(e.centre_lx, 200.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < e.lx.size(); ++i) {
    const double x = e.plane.x_mm(i % e.plane.nx) / 1000.0, y = e.plane.y_mm(i / e.plane.nx) / 1000.0;
    const double analytic = 800.0 * 4.0 / std::pow(4.0 + x * x + y * y, 2.0);
    ASSERT_NEAR(e.lx[i], analytic, 1e-4 * analytic) << x << " " << y;
    sum += e.lx[i];
  }
  EXPECT_DOUBLE_EQ(e.max_lx, 200.0);
  EXPECT_NEAR(e.max_x_mm, 0.0, 1e-9);
  EXPECT_NEAR(e.mean_lx, sum / static_cast<double>(e.lx.size()), 1e-9);
  EXPECT_DOUBLE_EQ(e.min_lx, e.lx.front());
  EXPECT_DOUBLE_EQ(e.uniformity, e.min_lx / e.mean_lx);
  // E falls to a share f at rho = h sqrt(1 / sqrt(f) - 1).
  EXPECT_NEAR(e.half.diameter_mm, 4000.0 * std::sqrt(std::sqrt(2.0) - 1.0), 5.0);
  EXPECT_NEAR(e.half.width_x_mm, e.half.diameter_mm, 10.0);
  EXPECT_NEAR(e.half.width_y_mm, e.half.width_x_mm, 1e-6);
  EXPECT_NEAR(e.tenth.diameter_mm, 4000.0 * std::sqrt(std::sqrt(10.0) - 1.0), 5.0);
  EXPECT_FALSE(e.half.cut);
  EXPECT_FALSE(e.tenth.cut);
}

TEST(PlaneIlluminance, InverseSquareOfTheDistance) {
  const PlaneIlluminance near = below(lambertian(), 1500.0, 3000.0),
                         far = below(lambertian(), 4500.0, 9000.0);
  for (std::size_t i = 0; i < near.lx.size(); ++i) ASSERT_NEAR(far.lx[i], near.lx[i] / 9.0, 1e-9);
  EXPECT_NEAR(far.flux(), near.flux(), 1e-6);
  EXPECT_TRUE(near.tenth.cut);
}

TEST(PlaneIlluminance, CosineOfTheTilt) {
  const auto isotropic = filled_by_angle([](double, double) { return 90.0; });
  for (const double tilt : {-60.0, 0.0, 25.0, 80.0, 90.0, 120.0}) {
    for (const Direction& aim :
         {Direction::from({0.0, 0.0, -1.0}), Direction::from({0.3, -0.7, 0.2}), Direction::from({0, 0, 1})}) {
      const Frame about_x = plane_frame({.distance_mm = 3000.0, .aim = aim, .tilt_x_deg = tilt});
      const Frame about_y = plane_frame({.distance_mm = 3000.0, .aim = aim, .tilt_y_deg = tilt});
      const double expected = 10.0 * std::max(0.0, std::cos(radians(tilt)));
      EXPECT_NEAR(plane_illuminance(isotropic, {.luminaire_from_plane = about_x}).centre_lx, expected, 1e-9);
      EXPECT_NEAR(plane_illuminance(isotropic, {.luminaire_from_plane = about_y}).centre_lx, expected, 1e-9);
    }
  }
  // Turned about +x, +y comes up to the luminaire and is brighter than -y.
  const PlaneIlluminance e = plane_illuminance(
      isotropic, {.luminaire_from_plane = plane_frame({.distance_mm = 1000.0, .tilt_x_deg = 30.0})});
  EXPECT_GT(e.lx[100 * 101 + 50], 1.2 * e.lx[50]);
  EXPECT_GT(e.max_y_mm, 100.0);
}

TEST(PlaneIlluminance, AxesOfThePlaneAreC0AndC90) {
  const auto toward_c90 = filled_by_angle([](double c, double g) {
    return g < 1.5 ? 100.0 * std::pow(std::max(0.0, std::cos(c - 0.5 * std::numbers::pi)), 8.0) : 0.0;
  });
  const PlaneIlluminance e = below(toward_c90, 1000.0, 2000.0);
  EXPECT_NEAR(e.max_x_mm, 0.0, 30.0);
  EXPECT_GT(e.max_y_mm, 0.0);
  EXPECT_EQ(e.lx[50], 0.0);  // towards C270
}

// Six faces of a cube catch all light. The trade's quadrature and bilinear interpolation part by less than
// 1e-4 on a 1 degree grid, midpoints on 101 x 101 cells by less still.
TEST(PlaneIlluminance, CubeCatchesAllFlux) {
  const auto d = filled_by_angle([](double c, double g) {
    return 300.0 * std::exp(-3.0 * (1.0 - std::cos(g))) * (2.0 + std::sin(g) * std::cos(c - 1.0)) + 20.0;
  });
  double flux = 0.0;
  for (const Vec3& aim :
       {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
    flux += plane_illuminance(d, {.luminaire_from_plane =
                                      plane_frame({.distance_mm = 700.0, .aim = Direction::from_unit(aim)}),
                                  .size_x_mm = 1400.0,
                                  .size_y_mm = 1400.0})
                .flux();
  }
  EXPECT_NEAR(flux / total_flux(d), 1.0, 3e-4);
}

TEST(PlaneIlluminance, SameBitsOnOneThread) {
  const PlaneIlluminance many = below(lambertian(), 2000.0, 3000.0);
  const ThreadLimit one(1);
  EXPECT_EQ(below(lambertian(), 2000.0, 3000.0).lx, many.lx);
}

TEST(PlaneIlluminance, DarknessAndNonsense) {
  const PlaneIlluminance dark = below(uniform_distribution(90.0, 10.0), 1000.0, 1000.0);
  EXPECT_EQ(dark.uniformity, 0.0);
  EXPECT_EQ(dark.half.area_mm2, 0.0);
  const Frame frame = plane_frame({});
  EXPECT_THROW(plane_frame({.distance_mm = 0.0}), InputError);
  EXPECT_THROW(plane_frame({.distance_mm = std::numeric_limits<double>::infinity()}), InputError);
  EXPECT_THROW(plane_illuminance(lambertian(), {.luminaire_from_plane = frame, .size_x_mm = -1.0}),
               InputError);
  EXPECT_THROW(plane_illuminance(lambertian(), {.luminaire_from_plane = frame, .nx = 1}), InputError);
  EXPECT_THROW(
      plane_illuminance(lambertian(), {.luminaire_from_plane = frame, .nx = 1u << 20, .ny = 1u << 20}),
      InputError);
  EXPECT_THROW(plane_illuminance(lambertian(), {}), InputError);  // through the luminaire
  EXPECT_THROW(plane_illuminance(IntensityDistribution{}, {.luminaire_from_plane = frame}), InputError);
}

}  // namespace
}  // namespace lucerna
