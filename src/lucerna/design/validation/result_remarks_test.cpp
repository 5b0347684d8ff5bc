// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/result_remarks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace lucerna {
namespace {

TEST(ResultRemarks, AnErrorWithinTwoOfItsOwnIsNoise) {
  DesignError error;
  error.rays = 4'000'000;
  error.c48 = {0.01, 0.0, 0.0019, 0.001};
  EXPECT_EQ(noise_remark(error), "no error is left that 4 M rays can distinguish from noise: 0.19 +- 0.10 %");
  error.c48.excess = 0.0021;
  EXPECT_FALSE(noise_remark(error));
  error.c48.standard_error = std::nan("");  // not known
  EXPECT_FALSE(noise_remark(error));
}

TEST(ResultRemarks, ASearchWithoutAStepHasDesignedNothing) {
  DesignFindings result;
  result.evaluations = 0;
  result.end = DesignTermination::time;
  ASSERT_TRUE(no_step_remark(result));
  EXPECT_NE(no_step_remark(result)->find("nothing was designed"), std::string::npos);
  result.start_error.c48 = {0.7, 0.0, 0.684, 0.001};
  result.error.c48 = {0.1, 0.0, 0.096, 0.001};
  EXPECT_NE(no_step_remark(result)->find("the best of the shapes that it could begin with"),
            std::string::npos)
      << "another shape than the search began with";
  result.evaluations = 1;
  EXPECT_FALSE(no_step_remark(result));
}

// Light of cos^2 C about the axis: its mean is 1/2, the difference cos(2 C) / 2, whose square is a third of
// the target's own.
TEST(ResultRemarks, WhatRingsCannotMakeIsToldWhereItIsMostOfTheError) {
  DesignTarget target;
  target.distribution = uniform_distribution(5.0, 1.0);
  IntensityDistribution& d = target.distribution;
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g)
      d.at(c, g) = d.gamma_deg[g] <= 40.0 ? std::pow(std::cos(radians(d.c_deg[c])), 2) : 0.0;
  }
  DesignError error;
  error.c48.excess = 0.6;
  const auto remark = rings_remark(target, error);
  ASSERT_TRUE(remark);
  EXPECT_NEAR(std::stod(remark->substr(remark->find(" is ") + 4)), 100.0 / std::sqrt(3.0), 3.0) << *remark;
  error.c48.excess = 1.3;
  EXPECT_FALSE(rings_remark(target, error));
  for (double& cd : d.cd) cd = 1.0;
  error.c48.excess = 0.01;
  EXPECT_FALSE(rings_remark(target, error)) << "even light is its own mean";
}

}  // namespace
}  // namespace lucerna
