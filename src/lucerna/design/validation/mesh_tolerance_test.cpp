// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/mesh_tolerance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

TargetRectangle directions(double width, double height) {
  TargetRectangle r;
  r.u_min = -0.5 * width;
  r.u_max = 0.5 * width;
  r.v_min = -0.5 * height;
  r.v_max = 0.5 * height;
  return r;
}

/// Flux per cell of a density that goes as exp(-(u^2 + v^2) / (2 s^2)).
std::vector<double> gaussian(const ErrorBoxes& boxes, double s) {
  std::vector<double> flux = boxes.measure();
  const TargetRectangle& r = boxes.rectangle();
  for (std::size_t k = 0; k < flux.size(); ++k) {
    if (k >= ErrorBoxes::kInside) {
      flux[k] = 0.0;
      continue;
    }
    const double u = r.u_min + r.width() * (static_cast<double>(k % kErrorBoxes) + 0.5) / kErrorBoxes;
    const double v = r.v_min + r.height() * (static_cast<double>(k / kErrorBoxes) + 0.5) / kErrorBoxes;
    flux[k] *= std::exp(-(u * u + v * v) / (2.0 * s * s));
  }
  return flux;
}

double slope_deg(const TargetRectangle& rectangle, double s) {
  const ErrorBoxes boxes(rectangle);
  return mesh_tolerance(boxes, gaussian(boxes, s), {}).slope_deg;
}

TEST(MeshTolerance, ABlurOfAGaussianIsAsCalculated) {
  // The Laplacian over two of exp(-x / 2), x = r^2 / s^2, is (x - 2) / (2 s^2); under the square of the
  // Gaussian x is exponential with mean 1, so that the mean of (x - 2)^2 is 2.
  const ErrorBoxes boxes(directions(0.6, 0.45));
  const double s = 0.05, box_u = degrees(0.6 / 48.0), box_v = degrees(0.45 / 48.0);
  const double s_deg = degrees(s);
  EXPECT_NEAR(detail::change_per_deg2(boxes, gaussian(boxes, s), {box_u, box_v}),
              std::sqrt(2.0) / (2.0 * s_deg * s_deg), 0.03 / (s_deg * s_deg));
}

TEST(MeshTolerance, NarrowBeamsInWideRectanglesNeedFineMeshes) {
  // 4 degrees between half values, in rectangles that would not ask for it.
  const double s = radians(4.0) / 2.355;
  const double narrow = slope_deg(directions(1.3, 1.3), s), wide = slope_deg(directions(1.3, 1.3), 4.0 * s);
  EXPECT_GT(narrow, 0.15);
  EXPECT_LT(narrow, 0.22);
  EXPECT_EQ(wide, kOpticalTolerance.slope_deg);
}

TEST(MeshTolerance, IsAtMostAFifthOfTheShorterSideOfABox) {
  EXPECT_NEAR(slope_deg(directions(0.9, 0.75), 0.2), 0.2 * degrees(0.75 / 48.0), 1e-12);
  const ErrorBoxes boxes(directions(0.9, 0.75));
  EXPECT_EQ(mesh_tolerance(boxes, gaussian(boxes, 0.2), {}).chord_mm, kOpticalTolerance.chord_mm);
}

TEST(MeshTolerance, StaysWithinItsLimits) {
  EXPECT_EQ(slope_deg(directions(1.6, 1.6), 0.5), kOpticalTolerance.slope_deg);
  EXPECT_NEAR(slope_deg(directions(0.1, 0.1), 0.02), 0.15, 1e-12);
}

TEST(MeshTolerance, OfAPlaneGoesByItsDistance) {
  TargetRectangle wall = directions(2400.0, 2400.0);
  wall.is_plane = true;
  wall.world_from_rectangle = Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 3000.0});
  const ErrorBoxes boxes(wall);
  const auto target = gaussian(boxes, 800.0);
  const auto slope = [&](double z_mm) { return mesh_tolerance(boxes, target, {0, 0, z_mm}).slope_deg; };
  EXPECT_NEAR(slope(0.0), 0.2 * degrees(std::atan(50.0 / 3000.0)), 1e-12);
  EXPECT_GT(slope(1000.0), slope(0.0));
  EXPECT_EQ(slope(3000.0), kOpticalTolerance.slope_deg) << "on the plane";
}

}  // namespace
}  // namespace lucerna
