// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/zone_guide.h"

#include <gtest/gtest.h>

#include "lucerna/design/problem/target_rectangle.h"

namespace lucerna {
namespace {

ZoneCells table() {
  return {{{"left", ZoneCoordinates::h_v, {0, 0}, {-5, -5}, 1.0, {{"min_cd", true, 100.0}}},
           {"right", ZoneCoordinates::h_v, {0, 0}, {5, 5}, 1.0, {{"min_cd", true, 100.0}}},
           {"dark", ZoneCoordinates::h_v, {-10, -2}, {-20, 20}, 1.0, {{"max_cd", false, 20.0}}}},
          Direction::from({1, 0, 0}),
          std::nullopt};
}

TEST(ZoneGuide, BridgesPointsAndKeepsBelowMaxima) {
  const ZoneCells zones = table();
  const IntensityDistribution guide = guide_distribution(zones, FluxUnit::lumen);
  const auto at = [&](double h, double v) {
    const MeasuringCell cell{0, {v, v}, {h, h}, 1.0};
    return intensity_in(guide, zones.ray_into(cell).direction);
  };
  EXPECT_NEAR(at(-5, 0), 115.0, 3.0);
  EXPECT_GT(at(0, 0), 50.0);   // between the two
  EXPECT_LT(at(0, -4), 20.0);  // where the maximum is 20
  EXPECT_LT(at(30, 0), 1.0);   // far off
  EXPECT_EQ(at(0, 80), 0.0);
}

TEST(ZoneGuide, HasARectangleAroundItsZones) {
  const TargetRectangle r = target_rectangle(guide_distribution(table(), FluxUnit::lumen));
  EXPECT_NEAR(r.world_from_rectangle.ez().x, 1.0, 1e-12);
  EXPECT_GT(r.width(), 0.1);
  EXPECT_LT(std::max(r.width(), r.height()), 0.7);
}

TEST(ZoneGuide, MapsHaveTheZonesInTheirPlaces) {
  const ZoneCells zones(
      {{"lane", ZoneCoordinates::plane, {50, 100}, {-200, 0}, 10.0, {{"min_lx", true, 20.0}}}}, Direction(),
      Frame());
  const IlluminanceMap map = guide_map(zones, 800, 400);
  EXPECT_NEAR(map.at(-100.0 / 400.0, 75.0 / 200.0), 23.0, 0.5);
  EXPECT_LT(map.at(300.0 / 400.0, -150.0 / 200.0), 0.1);
}

}  // namespace
}  // namespace lucerna
