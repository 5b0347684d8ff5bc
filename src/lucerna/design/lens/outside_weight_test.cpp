// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/outside_weight.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/intensity.h"

namespace lucerna {
namespace {

DesignTarget of_directions(double (*cd)(double off_deg)) {
  DesignTarget target;
  target.distribution = uniform_distribution(360.0, 0.5);
  for (std::size_t g = 0; g < target.distribution.gamma_deg.size(); ++g)
    target.distribution.at(0, g) = cd(target.distribution.gamma_deg[g]);
  return target;
}

// A round beam in a square: its edges touch the square's in four places.
TEST(OutsideWeight, IsOneForLightThatFadesOut) {
  const DesignTarget soft = of_directions([](double off) { return std::exp(-off * off / 50.0); });
  EXPECT_EQ(outside_weight(soft), 1.0);
  const DesignTarget hard = of_directions([](double off) { return off < 20.0 ? 1.0 : 0.0; });
  EXPECT_LT(outside_weight(hard), 0.8);
  EXPECT_GT(outside_weight(hard), 0.04);
}

TEST(OutsideWeight, IsLeastForEvenLightUpToItsEdges) {
  DesignTarget target;
  target.distribution = uniform_distribution(360.0, 1.0);
  PlaneTarget plane;
  plane.world_from_plane = Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 1000});
  plane.size_x_mm = 800.0;
  plane.size_y_mm = 400.0;
  plane.map = {8, 4, std::vector<double>(32, 5.0)};
  target.plane = plane;
  EXPECT_NEAR(outside_weight(target), 0.04, 1e-3);
}

}  // namespace
}  // namespace lucerna
