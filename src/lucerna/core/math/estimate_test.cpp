// SPDX-License-Identifier: Apache-2.0
#include "lucerna/estimate.h"

#include <gtest/gtest.h>

#include <limits>

namespace lucerna {
namespace {

TEST(Estimate, TextHasAsManyDigitsAsTheErrorAllows) {
  EXPECT_EQ(estimate_text({1758.93, 4.2}, "cd"), "1759 +- 4 cd");
  EXPECT_EQ(estimate_text({1758.93, 14.2}, "cd"), "1759 +- 14 cd");
  EXPECT_EQ(estimate_text({1758.93, 42.0}), "1760 +- 40");
  EXPECT_EQ(estimate_text({62.8734, 0.0312}, "deg"), "62.87 +- 0.03 deg");
  EXPECT_EQ(estimate_text({62.8734, 0.0981}), "62.87 +- 0.10");
  EXPECT_EQ(estimate_text({0.5, 0.019}), "0.500 +- 0.019");
  EXPECT_EQ(estimate_text({-3.0, 0.4}), "-3.0 +- 0.4");
}

TEST(Estimate, TextWithoutAnError) {
  EXPECT_EQ(estimate_text({1758.93, std::numeric_limits<double>::quiet_NaN()}, "cd"), "1758.9 cd");
  EXPECT_EQ(estimate_text({1000.0, 0.0}, "lm"), "1000 lm");
  EXPECT_EQ(estimate_text({10.0, 4e-16}, "%"), "10 %") << "rounding is no noise";
  EXPECT_EQ(estimate_text({0.0, 4e-16}), "0 +- 4e-16");
}

TEST(Estimate, SharesAreInPercent) {
  EXPECT_EQ(share_text({0.8341, 0.0012}), "83.41 +- 0.12 %");
  EXPECT_EQ(share_text({0.0, 0.0}), "0 %");
  EXPECT_EQ(share_text({1.0, 0.0}), "100 %");
}

}  // namespace
}  // namespace lucerna
