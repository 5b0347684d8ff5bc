// SPDX-License-Identifier: Apache-2.0
#include "lucerna/diagram.h"

#include <gtest/gtest.h>

#include "lucerna/error.h"
#include "lucerna/results/svg/svg_polar.h"

namespace lucerna {
namespace {

TEST(PolarDiagram, IsThatOfTheReports) {
  IntensityDistribution light = uniform_distribution(90.0, 30.0);
  for (double& cd : light.cd) cd = 100.0;
  PolarOptions options;
  options.title = "lamp";
  EXPECT_EQ(polar_diagram(light, {}, "lamp"), polar_svg(light, options));
  const std::vector<double> errors(light.cd.size(), 5.0);
  EXPECT_NE(polar_diagram(light, errors), polar_diagram(light));
  EXPECT_THROW(polar_diagram(light, std::vector<double>(3, 1.0)), InputError);
}

}  // namespace
}  // namespace lucerna
