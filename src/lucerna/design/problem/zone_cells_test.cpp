// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/zone_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr double kPi = std::numbers::pi;

ZoneCells directions(std::vector<TargetZone> zones) {
  return {std::move(zones), Direction::from({1, 0, 0}), std::nullopt};
}

TargetZone gamma_c(ZoneRange gamma, ZoneRange c, double cell = 1.0) {
  return {"g", ZoneCoordinates::gamma_c, gamma, c, cell, {}};
}
TargetZone h_v(ZoneRange h, ZoneRange v, double cell = 1.0) {
  return {"h", ZoneCoordinates::h_v, v, h, cell, {}};
}

double measure(const ZoneCells& cells) {
  double sum = 0.0;
  for (const MeasuringCell& c : cells.cells()) sum += c.measure;
  return sum;
}

TEST(ZoneCells, CellsHaveTheMeasureOfTheirZone) {
  EXPECT_NEAR(measure(directions({gamma_c({0, 90}, {0, 360}, 7.0)})), 2.0 * kPi, 1e-9);
  EXPECT_NEAR(measure(directions({gamma_c({60, 90}, {300, 390})})), 0.5 * kPi * 0.5, 1e-9);
  EXPECT_NEAR(measure(directions({h_v({-180, 180}, {-90, 90}, 5.0)})), 4.0 * kPi, 1e-9);
  const ZoneCells plane({{"p", ZoneCoordinates::plane, {-50, 50}, {0, 30}, 7.0, {}}}, Direction(), Frame());
  EXPECT_NEAR(measure(plane), 3000.0, 1e-9);
}

TEST(ZoneCells, EveryCellIsAboutAsWideAsHigh) {
  const ZoneCells zones = directions({gamma_c({0, 90}, {0, 360}, 2.0), h_v({-60, 60}, {-80, 80}, 3.0)});
  for (const MeasuringCell& c : zones.cells()) {
    const double side = degrees(std::sqrt(c.measure)), asked = c.zone == 0 ? 2.0 : 3.0;
    EXPECT_LE(side, 1.1 * asked) << zones.place_text(c);
    if (c.zone == 1 || c.row.low > 10.0) {
      EXPECT_GE(side, 0.6 * asked) << zones.place_text(c);
    }
  }
}

TEST(ZoneCells, ARayIntoACellIsCountedThere) {
  const Frame plane({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {100, 0, -500});
  const ZoneCells by_angle = directions({gamma_c({0, 40}, {0, 360}, 3.0), gamma_c({50, 50}, {-20, -20}),
                                         gamma_c({30, 60}, {350, 400}), h_v({-30, 20}, {-10, 10}, 2.0),
                                         h_v({0, 0}, {5, 5}), gamma_c({0, 0}, {0, 0})});
  const ZoneCells by_place({{"p", ZoneCoordinates::plane, {-50, 50}, {0, 30}, 7.0, {}}}, Direction(), plane);
  for (const ZoneCells* zones : {&by_angle, &by_place}) {
    for (std::size_t c = 0; c < zones->size(); ++c) {
      std::vector<double> sums(zones->size(), 0.0);
      const Ray ray = zones->ray_into(zones->cells()[c], 0.3, 0.8);
      zones->add(ray.origin_mm, ray.direction.vec(), 2.0, sums);
      EXPECT_EQ(sums[c], 2.0) << zones->place_text(zones->cells()[c]);
      // No other cell of the same zone has it.
      double zone_sum = 0.0;
      const std::size_t z = zones->cells()[c].zone;
      for (std::size_t i = zones->first(z); i < zones->first(z + 1); ++i) zone_sum += sums[i];
      EXPECT_EQ(zone_sum, 2.0);
    }
  }
}

TEST(ZoneCells, EvenLightFillsCellsByTheirMeasure) {
  const ZoneCells zones = directions({gamma_c({0, 180}, {0, 360}, 30.0), h_v({-90, 90}, {-45, 45}, 30.0)});
  std::vector<double> sums(zones.size(), 0.0);
  Rng rng(1, 2);
  constexpr int kRays = 200000;
  for (int i = 0; i < kRays; ++i) {
    const double z = 2.0 * rng.uniform() - 1.0, a = 2.0 * kPi * rng.uniform(), s = std::sqrt(1.0 - z * z);
    zones.add({}, {s * std::cos(a), s * std::sin(a), z}, 1.0, sums);
  }
  // Five standard deviations of a count: one false alarm in 20 000 runs of these 40 cells.
  for (std::size_t c = 0; c < zones.size(); ++c) {
    const double expected = kRays * zones.cells()[c].measure / (4.0 * kPi);
    EXPECT_NEAR(sums[c], expected, 5.0 * std::sqrt(expected)) << zones.place_text(zones.cells()[c]);
  }
}

TEST(ZoneCells, HAndVAreRightAndUpSeenAlongTheAxis) {
  const ZoneCells zones = directions({h_v({20, 20}, {10, 10})});
  const Direction d = zones.ray_into(zones.cells()[0]).direction;
  EXPECT_NEAR(degrees(std::asin(d.z())), 10.0, 1e-9);           // up is +z
  EXPECT_NEAR(degrees(std::atan2(-d.y(), d.x())), 20.0, 1e-9);  // right of +x, z up, is -y
}

TEST(ZoneCells, LightFromBehindThePlaneDoesNotCount) {
  const ZoneCells zones({{"p", ZoneCoordinates::plane, {-50, 50}, {-50, 50}, 100.0, {}}}, Direction(),
                        Frame());
  std::vector<double> sums(1, 0.0);
  zones.add({0, 0, -10}, {0, 0, 1}, 1.0, sums);
  EXPECT_EQ(sums[0], 0.0);
  zones.add({0, 0, 10}, {0, 0, -1}, 1.0, sums);
  EXPECT_EQ(sums[0], 1.0);
}

}  // namespace
}  // namespace lucerna
