// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/result_remarks.h"

#include <gtest/gtest.h>

#include <cmath>

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
  result.evaluations = 1;
  EXPECT_FALSE(no_step_remark(result));
}

}  // namespace
}  // namespace lucerna
