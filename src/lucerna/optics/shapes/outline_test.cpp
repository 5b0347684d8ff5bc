// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "tests/support/random_rays.h"

namespace lucerna {
namespace {

using Corners = std::vector<OutlinePoint>;

/// Part of a circle about (r, 0), from one angle to another above the r axis.
Corners arc(double r_mm, double radius_mm, double from_deg, double to_deg, int steps) {
  Corners out;
  for (int i = 0; i <= steps; ++i) {
    const double a = (from_deg + (to_deg - from_deg) * i / steps) * std::numbers::pi / 180.0;
    out.push_back({r_mm + radius_mm * std::cos(a), radius_mm * std::sin(a)});
  }
  return out;
}

Corners half_circle(int steps) {
  Corners out = arc(0.0, 10.0, -90.0, 90.0, steps);
  out.front()[0] = out.back()[0] = 0.0;
  return out;
}

/// How far the ends of the pieces are from the circle of 10 mm about (r, 0), and how far their normals lean.
struct Deviation {
  double place_mm = 0.0, normal = 0.0;
};
Deviation from_circle(const std::vector<OutlineSide>& sides, double r_mm) {
  Deviation out;
  for (const OutlineSide& s : sides) {
    const double x = s.from[0] - r_mm, y = s.from[1], r = std::hypot(x, y);
    out.place_mm = std::max(out.place_mm, std::abs(r - 10.0));
    out.normal = std::max(out.normal, std::hypot(s.from_normal[0] - x / r, s.from_normal[1] - y / r));
  }
  return out;
}

TEST(Outline, StraightSidesKeepTheirCornersAndLookOutward) {
  Corners plate{{0, 0}, {5, 0}, {5, 2}, {0, 2}};
  for (int turned = 0; turned < 2; ++turned) {
    const std::vector<OutlineSide> sides = outline_sides(plate, 20.0, 1e-6);
    ASSERT_EQ(sides.size(), 3U) << "none along the axis";
    for (const OutlineSide& s : sides) {
      const double r = 0.5 * (s.from[0] + s.to[0]), z = 0.5 * (s.from[1] + s.to[1]);
      EXPECT_GT(s.from_normal[0] * (r - 2.0) + s.from_normal[1] * (z - 1.0), 0.0);
      EXPECT_EQ(s.from_normal, s.to_normal);
    }
    std::reverse(plate.begin(), plate.end());
  }
}

// A cubic spline's error falls as h^4, that of its slope as h^3.
TEST(Outline, AreCurvesOfFourthOrderWhereTheyTurnLittle) {
  const Deviation coarse = from_circle(outline_sides(half_circle(30), 20.0, 1e-6), 0.0);
  const Deviation fine = from_circle(outline_sides(half_circle(60), 20.0, 1e-6), 0.0);
  EXPECT_LT(coarse.place_mm, 2e-5);
  EXPECT_LT(16.0 * 0.8 * fine.place_mm, coarse.place_mm);
  EXPECT_LT(8.0 * 0.8 * fine.normal, coarse.normal);
}

TEST(Outline, PiecesKeepWithinTheTolerance) {
  for (const double tolerance_mm : {1e-2, 1e-4, 1e-6}) {
    double worst = 0.0;
    const std::vector<OutlineSide> sides = outline_sides(half_circle(90), 20.0, tolerance_mm);
    for (const OutlineSide& s : sides)
      worst = std::max(worst, 10.0 - std::hypot(s.from[0] + s.to[0], s.from[1] + s.to[1]) / 2.0);
    EXPECT_LT(worst, 1.01 * tolerance_mm);
    EXPECT_EQ(sides.front().from[0], 0.0);
    EXPECT_EQ(sides.back().to[0], 0.0);
  }
}

TEST(Outline, ARingIsSmoothAllAbout) {
  Corners ring = arc(30.0, 10.0, 0.0, 360.0, 60);
  ring.pop_back();
  const std::vector<OutlineSide> sides = outline_sides(ring, 20.0, 1e-6);
  EXPECT_LT(from_circle(sides, 30.0).place_mm, 2e-5);
  EXPECT_LT(from_circle(sides, 30.0).normal, 2e-4);
  EXPECT_EQ(sides.back().to, sides.front().from);
}

TEST(Outline, EdgesStaySharp) {
  // A dome on a wider plate, which is flat.
  Corners lens = arc(0.0, 10.0, 0.0, 90.0, 40);
  lens.back()[0] = 0.0;
  lens.push_back({0.0, -2.0});
  lens.push_back({12.0, -2.0});
  lens.push_back({12.0, 0.0});
  int dome = 0;
  for (const OutlineSide& s : outline_sides(lens, 20.0, 1e-5)) {
    if (std::max(s.from[1], s.to[1]) > 1e-9) {
      EXPECT_NEAR(std::hypot(s.from[0], s.from[1]), 10.0, 1e-4);
      ++dome;
    } else {
      EXPECT_EQ(std::abs(s.from_normal[0]) + std::abs(s.from_normal[1]), 1.0) << "level or upright";
    }
  }
  EXPECT_GT(dome, 100);
}

TEST(Outline, ACurveThatCrossesItselfIsRefused) {
  // The upper side bends where it rises, and dips through the lower one.
  const Corners thin{{0, 0.4}, {12, 0.4}, {12, 1.3}, {11, 1.1}, {10.5, 0.7}, {10, 0.5}, {0, 0.5}};
  EXPECT_NO_THROW((void)outline_sides(thin, 0.0, 1e-4));
  EXPECT_NE(test::message_of<InputError>([&] {
              (void)outline_sides(thin, 40.0, 1e-4);
            }).find("curve through the outline's corners crosses itself at"),
            std::string::npos);
}

// A plate with a rim, a curved top of three sides, and its axis, numbered either way round.
TEST(SidesOfFaces, AreWholeFacesInTheGivenOrder) {
  const std::vector<OutlinePoint> plate{{0, 0}, {10, 0}, {10, 2}, {7, 3}, {4, 3.5}, {0, 3.7}};
  std::vector<OutlinePoint> reversed(plate.rbegin(), plate.rend());
  using Flags = std::vector<bool>;
  const auto of = [](const std::vector<OutlinePoint>& corners, std::size_t side) {
    return sides_of_faces(corners, 30.0, std::vector{side});
  };
  EXPECT_EQ(of(plate, 0), (Flags{true, false, false, false, false, false}));
  for (const std::size_t side : {2u, 3u, 4u})
    EXPECT_EQ(of(plate, side), (Flags{false, false, true, true, true, false})) << side;
  // Reversed, its sides are: 0 to 2 the top, 3 the rim, 4 below.
  EXPECT_EQ(of(reversed, 4), of(plate, 0));
  EXPECT_EQ(of(reversed, 3), of(plate, 1));
  EXPECT_EQ(of(reversed, 0), of(plate, 2));
  EXPECT_THROW((void)of(plate, 5), InputError) << "along the axis";
  EXPECT_THROW((void)of(plate, 6), InputError);
}

TEST(OutlineSides, KnowTheirCorner) {
  const std::vector<OutlinePoint> plate{{0, 0}, {10, 0}, {10, 2}, {7, 3}, {4, 3.5}, {0, 3.7}};
  std::vector<bool> seen(plate.size(), false);
  for (const OutlineSide& s : outline_sides(plate, 30.0, 1e-6)) {
    seen[s.corner] = true;
    if (s.from == plate[s.corner]) continue;
    EXPECT_GT(s.corner, 1u) << "straight sides are one piece";
  }
  EXPECT_EQ(seen, (std::vector<bool>{true, true, true, true, true, false}));
  std::vector<OutlinePoint> ring;  // smooth all about
  for (int i = 0; i < 12; ++i)
    ring.push_back({5.0 + std::cos(i * std::numbers::pi / 6.0), std::sin(i * std::numbers::pi / 6.0)});
  std::size_t corner = 0;
  for (const OutlineSide& s : outline_sides(ring, 40.0, 1e-4)) {
    if (s.corner != corner) ++corner;
    EXPECT_EQ(s.corner, corner);
  }
  EXPECT_EQ(corner, 11u);
}

}  // namespace
}  // namespace lucerna
