// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/height_field/height_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lucerna/random.h"

namespace lucerna {
namespace {

/// A paraboloid with pillows: far from one quadric, smooth.
class Pillows final : public HeightSurface {
 public:
  SurfacePoint at(double x, double y) const override {
    const double k = 2.0 * std::numbers::pi / 8.0, f = 60.0;
    return {(x * x + y * y) / f + 0.4 * std::cos(k * x) * std::cos(k * y),
            2.0 * x / f - 0.4 * k * std::sin(k * x) * std::cos(k * y),
            2.0 * y / f - 0.4 * k * std::cos(k * x) * std::sin(k * y)};
  }
  HeightRange range(const Rectangle&) const override { return {-0.4, 90.0}; }
};

Reflector pillows() { return {std::make_shared<Pillows>(), Aperture::rectangle(80.0, 60.0, 10.0)}; }

/// Greatest error of height and gradient over the aperture.
std::pair<double, double> worst(const HeightField& field, const HeightSurface& surface) {
  Rng rng(1, 0);
  double z = 0.0, g = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double x = 80.0 * rng.uniform() - 40.0, y = 60.0 * rng.uniform() - 30.0;
    const SurfacePoint a = field.at(x, y), b = surface.at(x, y);
    z = std::max(z, std::abs(a.z_mm - b.z_mm));
    g = std::max(g, std::hypot(a.dzdx - b.dzdx, a.dzdy - b.dzdy));
  }
  return {z, g};
}

TEST(HeightField, ErrorsFallWithTheFourthAndThirdPowerOfTheCell) {
  const Reflector r = pillows();
  const auto [z64, g64] = worst(HeightField(r, 64), *r.surface);
  const auto [z128, g128] = worst(HeightField(r, 128), *r.surface);
  EXPECT_LT(z64, 5e-3);
  EXPECT_GT(z64 / z128, 12.0);
  EXPECT_GT(g64 / g128, 6.0);
}

TEST(HeightField, AQuadricIsExactToRounding) {
  const Reflector r = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::rectangle(80.0, 60.0));
  const auto [z, g] = worst(HeightField(r, 64), *r.surface);
  EXPECT_LT(z, 1e-7);
  EXPECT_LT(g, 1e-8);
}

/// The longest gradient over the quadric at random places within the rim.
double max_slope(const HeightField& field) {
  Rng rng(3, 0);
  double max = 0.0;
  for (int i = 0; i < 50000; ++i) {
    const double x = 80.0 * rng.uniform() - 40.0, y = 80.0 * rng.uniform() - 40.0;
    if (std::hypot(x, y) > field.rim_mm()) continue;
    const SurfacePoint a = field.at(x, y), q = field.quadric().at(x, y);
    max = std::max(max, std::hypot(a.dzdx - q.dzdx, a.dzdy - q.dzdy));
  }
  return max;
}

// Of a smooth mirror with a hole, and of one whose heights and slopes have nothing to do with each other.
TEST(HeightField, SteepnessBoundsEveryGradient) {
  HeightField field({std::make_shared<Pillows>(), Aperture::circle(80.0, 20.0)}, 1024);
  const double smooth = max_slope(field);
  EXPECT_GE(static_cast<double>(field.gradient_bound()), smooth);
  EXPECT_LT(static_cast<double>(field.gradient_bound()), 1.3 * smooth);
  Rng rng(4, 0);
  for (FieldVertex& v : field.vertices()) {
    v = {static_cast<float>(rng.uniform()), static_cast<float>(4.0 * rng.uniform() - 2.0),
         static_cast<float>(4.0 * rng.uniform() - 2.0)};
  }
  field.rebuild();
  const double rough = max_slope(field);
  EXPECT_GT(rough, 2.0);
  EXPECT_GE(static_cast<double>(field.gradient_bound()), rough);
}

// Every slab of every level holds the cubic pieces that the tracers hit.
TEST(HeightField, SlabsHoldTheSurface) {
  const HeightField field(pillows(), 128);
  Rng rng(2, 0);
  for (int i = 0; i < 50000; ++i) {
    const double x = 80.0 * rng.uniform() - 40.0, y = 60.0 * rng.uniform() - 30.0;
    if (!field.aperture().contains(x, y)) continue;
    const double z = field.at(x, y).z_mm - field.quadric().at(x, y).z_mm;
    EXPECT_LE(field.band().low_mm, z);
    EXPECT_GE(field.band().high_mm, z);
    for (std::size_t level = 0; level < field.level_offsets().size(); ++level) {
      const std::size_t n = static_cast<std::size_t>(field.cells() / HeightField::kBlock) >> level;
      const double wx = 80.0 / static_cast<double>(n), wy = 60.0 / static_cast<double>(n);
      const auto ix = static_cast<std::size_t>((x + 40.0) / wx),
                 iy = static_cast<std::size_t>((y + 30.0) / wy);
      const FieldNode& node =
          field.nodes()[static_cast<std::size_t>(field.level_offsets()[level]) + iy * n + ix];
      const double px = x + 40.0 - wx * (static_cast<double>(ix) + 0.5);
      const double py = y + 30.0 - wy * (static_cast<double>(iy) + 0.5);
      const double plane =
          static_cast<double>(node.a) + static_cast<double>(node.b) * px + static_cast<double>(node.c) * py;
      EXPECT_LE(std::abs(z - plane), static_cast<double>(node.e) + 1e-6) << level;
    }
  }
}

TEST(HeightField, RebuildSeesChangedHeights) {
  HeightField field(pillows(), 64);
  const double before = field.band().high_mm;
  field.vertices()[33 * 65 + 20].z_mm += 5.0F;
  field.rebuild();
  EXPECT_GT(field.band().high_mm, before + 4.0);
  EXPECT_GT(field.nodes().back().e, 2.0F);
}

}  // namespace
}  // namespace lucerna
