// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/metrics/figure_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

TEST(FigureText, FiguresHaveTheDigitsThatTheirErrorSupports) {
  EXPECT_EQ(figure_text(823.14159, 0.2718), "823.14 ± 0.27");
  EXPECT_EQ(figure_text(106770.4, 523.0), "106770 ± 523");
  EXPECT_EQ(figure_text(0.0001234567, 3.2e-6), "0.0001235 ± 0.0000032");
  EXPECT_EQ(figure_text(920.0, 0.0), "920");
  EXPECT_EQ(figure_text(920.0, std::nan("")), "920");
  EXPECT_EQ(figure_text(std::nan("")), "–");
  EXPECT_EQ(figure_text(132313.4), "132313");
  EXPECT_EQ(figure_text(0.0123456), "0.012346");
  EXPECT_EQ(figure_text(0.0), "0");
  EXPECT_EQ(figure_text(1e-7), "1.0000e-07");
  EXPECT_EQ(figure_text(500.0, 1e-11), "500") << "rounding is no error";
  EXPECT_EQ(figure_text(-0.0), "0");
}

}  // namespace
}  // namespace lucerna
