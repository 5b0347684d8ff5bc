// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/materials/agf_formulas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lucerna {
namespace {

// By hand, at wavelengths of 1 and 2 um with coefficients that are powers of two: what each formula gives.
TEST(AgfFormulas, GiveWhatTheyGiveByHand) {
  const std::vector<double> c{2.5, 0.25, 0.5, 0.125, 0.0625, 0.5, 0.25, 0.125, 0.0625, 0.5};
  struct Case {
    int formula;
    double at_1, at_2;  // n^2; n for Herzberger and Conrady
  };
  const double l1 = 1.0 / 0.972, l2 = 1.0 / 3.972;
  const std::vector<Case> cases{
      {1, 2.5 + 0.25 + 0.5 + 0.125 + 0.0625 + 0.5,
       2.5 + 1.0 + 0.125 + 0.0078125 + 0.0009765625 + 0.001953125},
      {2, 1.0 + 2.5 / 0.75 + 0.5 / 0.875 + 0.0625 / 0.5, 1.0 + 10.0 / 3.75 + 2.0 / 3.875 + 0.25 / 3.5},
      {3, 2.5 + 0.25 * l1 + 0.5 * l1 * l1 + 0.125 + 0.0625 + 0.5,
       2.5 + 0.25 * l2 + 0.5 * l2 * l2 + 0.5 + 1.0 + 32.0},
      {4, 3.5 + 0.25 / 0.75 + 0.125 / (1.0 - 0.00390625), 3.5 + 1.0 / 3.75 + 0.125 / (4.0 - 0.00390625)},
      {5, 3.25, 2.625 + 0.5 / std::pow(2.0, 3.5)},
      {6, 1.0 + 2.5 / 0.75 + 0.5 / 0.875 + 0.0625 / 0.5 + 0.25 / 0.875,
       1.0 + 10.0 / 3.75 + 2.0 / 3.875 + 0.25 / 3.5 + 1.0 / 3.875},
      {7, 2.5 + 0.25 / 0.5 - 0.125, 2.5 + 0.25 / 3.5 - 0.5},
      {8, 2.5 + 0.25 / 0.5 - 0.125, 2.5 + 1.0 / 3.5 - 0.5},
      {9, 2.5 + 0.25 / 0.5 + 0.125 / 0.9375, 2.5 + 1.0 / 3.5 + 0.5 / 3.9375},
      {10, 2.5 + 0.25 + 0.5 + 0.125 + 0.0625 + 0.5 + 0.25 + 0.125,
       2.5 + 1.0 + 0.125 + 0.0078125 + 0.0009765625 + 0.001953125 + 0.000244140625 + 0.000030517578125},
      {11, 1.0 + 2.5 / 0.75 + 0.5 / 0.875 + 0.0625 / 0.5 + 0.25 / 0.875 + 0.0625 / 0.5,
       1.0 + 10.0 / 3.75 + 2.0 / 3.875 + 0.25 / 3.5 + 1.0 / 3.875 + 0.25 / 3.5},
      {12, 2.5 + 0.25 + 0.5 + 0.125 + 0.0625 + 0.5 + 0.25 + 0.125,
       2.5 + 1.0 + 0.125 + 0.0078125 + 0.0009765625 + 0.001953125 + 4.0 + 8.0},
      {13, 2.5 + 0.25 + 0.5 + 0.125 + 0.0625 + 0.5 + 0.25 + 0.125 + 0.0625,
       2.5 + 1.0 + 8.0 + 0.03125 + 0.00390625 + 0.0078125 + 0.0009765625 + 0.0001220703125 +
           0.0000152587890625},
  };
  ASSERT_EQ(cases.size(), static_cast<std::size_t>(kAgfFormulas));
  for (const Case& k : cases) {
    const bool gives_index = k.formula == 3 || k.formula == 5;
    EXPECT_NEAR(agf_index(k.formula, c, 1.0), gives_index ? k.at_1 : std::sqrt(k.at_1), 1e-12) << k.formula;
    EXPECT_NEAR(agf_index(k.formula, c, 2.0), gives_index ? k.at_2 : std::sqrt(k.at_2), 1e-12) << k.formula;
  }
}

// What a formula has more than its number of coefficients does not count, and each that it has does.
TEST(AgfFormulas, HaveSoManyCoefficients) {
  const std::vector<double> c{2.5, 0.25, 0.5, 0.125, 0.0625, 0.5, 0.25, 0.125, 0.0625, 0.5, 7.0};
  for (int formula = 1; formula <= kAgfFormulas; ++formula) {
    const std::size_t n = agf_coefficients(formula);
    ASSERT_LT(n, c.size());
    const double whole = agf_index(formula, c, 1.5);
    EXPECT_EQ(agf_index(formula, {c.data(), n}, 1.5), whole) << formula;
    for (std::size_t i = 0; i < n; ++i) {
      auto other = c;
      other[i] *= 1.001;
      EXPECT_NE(agf_index(formula, other, 1.5), whole) << formula << ", coefficient " << i;
    }
  }
}

TEST(AgfFormulas, AreNoNumberWhereTheSquareIsNegative) {
  EXPECT_TRUE(std::isnan(agf_index(1, std::vector<double>{-1, 0, 0, 0, 0, 0}, 0.5)));
}

}  // namespace
}  // namespace lucerna
