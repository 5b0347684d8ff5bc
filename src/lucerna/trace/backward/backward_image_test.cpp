// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/backward/backward_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <numeric>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/estimate.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace_metrics.h"

namespace lucerna {
namespace {

/// An LED of four dies in a paraboloid that shines down; a black plate covers a part of the opening.
Scene plated_paraboloid(double slope_error_mrad = 0.0) {
  Scene scene;
  EmitterOptions source;
  source.kind = EmitterKind::led;
  scene.sources.push_back({make_emitter(source), {}, {}});
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0, 12.0));
  PlacedReflector placed{mirror, Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 15}),
                         Reflectance(0.9)};
  placed.slope_error_mrad = slope_error_mrad;
  scene.reflectors.push_back(placed);
  auto plate = std::make_shared<Mesh>();
  plate->vertices_mm = {{20.0, -60.0, -40.0}, {60.0, -60.0, -40.0}, {60.0, 60.0, -40.0}, {20.0, 60.0, -40.0}};
  plate->triangles = {{0, 1, 2}, {0, 2, 3}};
  Body body;
  body.mesh = plate;
  scene.bodies.push_back(body);
  return scene;
}

PlaneGrid grid_at(const Vec3& position_mm, double size_mm, std::size_t n) {
  PlaneGrid grid;
  grid.world_from_plane = facing_frame(Direction::from({0.1, 0.0, 1.0}), {0, 1, 0}, position_mm);
  grid.size_x_mm = grid.size_y_mm = size_mm;
  grid.nx = grid.ny = n;
  return grid;
}

/// An observer below the luminaire who looks up at its opening.
LuminanceDetector observer(double distance_mm) {
  LuminanceDetector d;
  d.grid.world_from_plane = facing_frame(Direction::from({0.02, 0.0, -1.0}), {0, 1, 0}, {0, 0, -30});
  d.grid.size_x_mm = d.grid.size_y_mm = 110.0;
  d.grid.nx = d.grid.ny = 22;
  d.half_angle_deg = 3.0;
  d.distance_mm = distance_mm;
  d.pupil_radius_mm = 15.0;
  return d;
}

std::array<std::uint64_t, 16> seeds_of(std::size_t cell) {
  std::array<std::uint64_t, 16> seeds;
  std::iota(seeds.begin(), seeds.end(), std::uint64_t{16 * cell + 1});
  return seeds;
}

TraceOptions forward_options() {
  TraceOptions options;
  options.last_ray = 1 << 23;
  return options;
}

/// How the two differ over their errors, in cells of a twentieth of the brightest or more (in darker ones
/// the errors of so few backward rays are not known well); and the ratio of all light.
struct ImageAgreement {
  double mean_z2 = 0.0, ratio = 0.0;
  int cells = 0;
};

template <class Backward>
ImageAgreement agreement(const PlaneImage& forward, const Backward& backward) {
  std::vector<Estimate> found(forward.value.size());
  parallel_blocks(found.size(), 1, [&](std::size_t k, std::size_t) {
    const auto seeds = seeds_of(k);
    found[k] = mean_estimate(backward(k, seeds));
  });
  ImageAgreement a;
  const double brightest = *std::max_element(forward.value.begin(), forward.value.end());
  double sum_forward = 0.0, sum_backward = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    sum_forward += forward.value[k];
    sum_backward += found[k].mean;
    if (forward.value[k] < 0.05 * brightest || !(found[k].standard_error > 0.0)) continue;
    const double z =
        (found[k].mean - forward.value[k]) / std::hypot(found[k].standard_error, forward.standard_error[k]);
    a.mean_z2 += z * z;
    ++a.cells;
  }
  a.mean_z2 /= a.cells;
  a.ratio = sum_backward / sum_forward;
  return a;
}

// The mean of z^2 over 50 cells and more with 15 degrees of freedom to either side is 1.1 +- 0.2: above 1.9
// with a chance below 1e-4. The ratio of all light is known to half a per cent.
void expect_agreement(const ImageAgreement& a) {
  EXPECT_GE(a.cells, 50);
  EXPECT_LT(a.mean_z2, 1.9);
  std::cout << a.cells << " cells, mean z^2 " << a.mean_z2 << ", ratio " << a.ratio << '\n';
  EXPECT_NEAR(a.ratio, 1.0, 0.02);
}

TEST(BackwardImageStatistical, PlanesHaveTheLightThatATraceCounts) {
  for (const double slope_error_mrad : {0.0, 10.0}) {
    SCOPED_TRACE(slope_error_mrad);
    Scene scene = plated_paraboloid(slope_error_mrad);
    scene.planes.push_back({"plane", grid_at({5.0, 3.0, -250.0}, 110.0, 18)});
    const PlaneImage forward = illuminance(trace(scene, forward_options()), 0);
    const BackwardImage backward(scene, 100);
    ASSERT_TRUE(backward.can_see(forward.grid));
    const ImageAgreement a = agreement(forward, [&](std::size_t cell, auto& seeds) {
      return backward.illuminance(forward.grid, cell, 64, seeds);
    });
    expect_agreement(a);
  }
}

TEST(BackwardImageStatistical, ObserversSeeTheLightThatATraceCounts) {
  for (const double distance_mm : {0.0, 400.0}) {
    SCOPED_TRACE(distance_mm);
    Scene scene = plated_paraboloid();
    scene.luminances.push_back(observer(distance_mm));
    const PlaneImage forward = luminance(trace(scene, forward_options()), 0);
    const BackwardImage backward(scene, 100);
    const ImageAgreement a = agreement(forward, [&](std::size_t cell, auto& seeds) {
      return backward.luminance(scene.luminances[0], cell, 64, seeds);
    });
    expect_agreement(a);
  }
}

// What the tests above would see: 5 % too much light, and bodies that are forgotten.
TEST(BackwardImageStatistical, WrongEstimatorsAreFound) {
  Scene scene = plated_paraboloid();
  scene.planes.push_back({"plane", grid_at({5.0, 3.0, -250.0}, 110.0, 18)});
  const PlaneImage forward = illuminance(trace(scene, forward_options()), 0);
  const BackwardImage backward(scene, 100);
  const ImageAgreement brighter = agreement(forward, [&](std::size_t cell, auto& seeds) {
    auto values = backward.illuminance(forward.grid, cell, 64, seeds);
    for (double& v : values) v *= 1.05;
    return values;
  });
  EXPECT_GT(brighter.ratio, 1.02);
  Scene without = scene;
  without.bodies.clear();
  const BackwardImage blind(without, 100);
  const ImageAgreement a = agreement(forward, [&](std::size_t cell, auto& seeds) {
    return blind.illuminance(forward.grid, cell, 64, seeds);
  });
  EXPECT_GT(a.mean_z2, 1.9);
}

TEST(BackwardImage, APlaneAtASourceOrMirrorCannotBeSeenFromThere) {
  const BackwardImage backward(plated_paraboloid(), 100);
  EXPECT_FALSE(backward.can_see(grid_at({0.0, 0.0, 0.0}, 10.0, 2)));
  EXPECT_FALSE(backward.can_see(grid_at({200.0, 0.0, -20.0}, 500.0, 2)));
  EXPECT_FALSE(backward.can_see(grid_at({49.0, 0.0, -26.0}, 10.0, 2)));
  EXPECT_TRUE(backward.can_see(grid_at({200.0, 0.0, -60.0}, 10.0, 2)));
}

// A plate moves lines aside: detectors behind one have counted light, far fields do not.
TEST(BackwardImage, IsNotForScenesWithACoverGlass) {
  Scene scene = plated_paraboloid();
  EXPECT_EQ(no_backward_image_reason(scene), "");
  scene.glasses.push_back({.aperture = Aperture::circle(60.0),
                           .world_from_glass = Frame::from_axis(Direction(), 0.0, {0, 0, -34})});
  EXPECT_EQ(no_backward_reason(scene), "");
  EXPECT_EQ(no_backward_image_reason(scene), "there is a cover glass");
  EXPECT_THROW(BackwardImage(scene, 100), InputError);
  scene.planes.push_back({"plane", grid_at({5.0, 3.0, -250.0}, 110.0, 4)});
  const TraceResult traced = trace(scene, {.last_ray = 1 << 14});
  const TraceMetrics followed = trace_metrics(traced, scene), counted = trace_metrics(traced);
  EXPECT_EQ(followed.planes[0].extremes.mean.mean, counted.planes[0].extremes.mean.mean);
}

}  // namespace
}  // namespace lucerna
