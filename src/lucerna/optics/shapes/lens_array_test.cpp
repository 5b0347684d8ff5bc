// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/lens_array.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr LensArray kSquares{.pitch_mm = 1.5, .radius_mm = 2.0, .conic = -0.6, .apex_mm = 3.0};
constexpr LensArray kHexagons{.pitch_mm = 1.2, .is_hexagonal = true, .radius_mm = -1.0, .apex_mm = 3.0};

/// The distance to the nearest of all centres about (x, y).
double nearest_mm(const LensArray& a, double x, double y) {
  double least = HUGE_VAL;
  const double row_mm = a.is_hexagonal ? a.pitch_mm * std::sqrt(0.75) : a.pitch_mm;
  for (int j = -20; j <= 20; ++j) {
    const double shift = a.is_hexagonal && j % 2 != 0 ? 0.5 : 0.0;
    for (int i = -20; i <= 20; ++i)
      least = std::min(least, std::hypot(x - (i + shift) * a.pitch_mm, y - j * row_mm));
  }
  return least;
}

TEST(LensArray, CellsAreThoseOfTheNearestCentres) {
  for (const LensArray& a : {kSquares, kHexagons}) {
    const ArrayCells cells(a.pitch_mm, a.is_hexagonal);
    Rng rng(3, 0);
    for (int i = 0; i < 2000; ++i) {
      const double x = 20.0 * rng.uniform() - 10.0, y = 20.0 * rng.uniform() - 10.0;
      const ArrayPoint c = cells.centre(x, y);
      const double r = std::hypot(x - c.x, y - c.y);
      EXPECT_NEAR(r, nearest_mm(a, x, y), 1e-12);
      EXPECT_LE(r, cells.corner_mm() * (1.0 + 1e-12));
      // A neighbour's centre is one, too.
      for (int k = 0; k < cells.sides(); ++k) {
        const ArrayPoint n = cells.neighbours()[static_cast<std::size_t>(k)];
        const ArrayPoint there = cells.centre(c.x + n.x, c.y + n.y);
        EXPECT_NEAR(std::hypot(there.x - c.x - n.x, there.y - c.y - n.y), 0.0, 1e-12);
      }
    }
  }
}

TEST(LensArray, HasNoStepsAndSlopesOfItsHeights) {
  for (const LensArray& a : {kSquares, kHexagons}) {
    const LensArraySurface surface(a);
    Rng rng(4, 0);
    int kinks = 0;
    for (int i = 0; i < 2000; ++i) {
      const double x = 8.0 * rng.uniform() - 4.0, y = 8.0 * rng.uniform() - 4.0, h = 1e-6;
      const SurfacePoint p = surface.at(x, y);
      const double to = surface.at(x + h, y).z_mm, from = surface.at(x - h, y).z_mm;
      EXPECT_NEAR(to, from, 3.0 * h);
      kinks += std::abs((to - from) / (2.0 * h) - p.dzdx) > 1e-4 ? 1 : 0;
      EXPECT_GE(p.z_mm, surface.range({}).low_mm - 1e-12);
      EXPECT_LE(p.z_mm, surface.range({}).high_mm + 1e-12);
    }
    EXPECT_LT(kinks, 5);
  }
  EXPECT_EQ(LensArraySurface(kSquares).at(1.5, -3.0).z_mm, 3.0);
  EXPECT_GT(LensArraySurface(kHexagons).range({}).high_mm, 3.0) << "hollow";
}

std::string array_fault(LensArray a) {
  try {
    static_cast<void>(lens_array(a));
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(LensArray, RefusesLensletsThatEndWithinTheirCells) {
  LensArray a = kSquares;
  a.conic = 0.0;
  a.radius_mm = 1.0;
  EXPECT_THAT(array_fault(a), testing::HasSubstr("end 1 mm from their centres"));
  a.radius_mm = 1.1;
  EXPECT_EQ(array_fault(a), "");
  a.radius_mm = 0.0;
  EXPECT_THAT(array_fault(a), testing::HasSubstr("any finite number but 0"));
  a = kSquares;
  a.pitch_mm = 0.0;
  EXPECT_THAT(array_fault(a), testing::HasSubstr("pitch_mm"));
  a = kSquares;
  a.apex_mm = std::nan("");
  EXPECT_THAT(array_fault(a), testing::HasSubstr("apex_mm"));
}

}  // namespace
}  // namespace lucerna
