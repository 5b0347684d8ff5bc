// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/cavity_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace lucerna {
namespace {

constexpr CavityRange kRange{19.0, 12.0};
constexpr std::size_t kTrials = 24;

/// A smooth valley about a best trial; a flat base costs 1.
CavityCost valley(const CavityTrial& best, std::vector<CavityTrial>& seen) {
  return [best, &seen](const CavityTrial& t) -> std::optional<double> {
    seen.push_back(t);
    if (t.cavity.depth_mm == 0.0) return 1.0;
    const double radius = std::log(t.cavity.radius_mm / best.cavity.radius_mm),
                 depth = std::log(t.cavity.depth_mm / best.cavity.depth_mm),
                 distance = std::log(t.distance / best.distance);
    return 0.2 * radius * radius + depth * depth + 4.0 * distance * distance;
  };
}

TEST(CavitySearch, ComesNearToTheBest) {
  for (const CavityTrial& best :
       {CavityTrial{{5.0, 3.8}, 1.1}, CavityTrial{{17.0, 7.0}, 1.3}, CavityTrial{{3.0, 4.0}, 0.95}}) {
    std::vector<CavityTrial> seen;
    const CavityTrial found = search_cavity(kRange, valley(best, seen), kTrials);
    EXPECT_LE(seen.size(), kTrials);
    EXPECT_NEAR(std::log(found.cavity.depth_mm / best.cavity.depth_mm), 0.0, 0.25) << best.cavity.depth_mm;
    EXPECT_NEAR(std::log(found.distance / best.distance), 0.0, 0.16) << best.distance;
    EXPECT_LT(found.cost, 0.15);
  }
}

TEST(CavitySearch, MakesAsManyTrialsAsItMay) {
  for (const std::size_t max : {std::size_t{1}, std::size_t{5}, std::size_t{12}}) {
    std::vector<CavityTrial> seen;
    static_cast<void>(search_cavity(kRange, valley({{5.0, 3.8}, 1.1}, seen), max));
    EXPECT_EQ(seen.size(), max);
  }
}

TEST(CavitySearch, CountsWhatIsALens) {
  int finite = 0;
  static_cast<void>(search_cavity(
      kRange,
      [&](const CavityTrial& t) -> std::optional<double> {
        if (t.cavity.depth_mm > 0.9 * t.cavity.radius_mm) return std::numeric_limits<double>::infinity();
        return 1.0 / ++finite;
      },
      9));
  EXPECT_EQ(finite, 9);
}

TEST(CavitySearch, LooksAtNothingTwiceAndAtNothingBeyondTheRange) {
  std::vector<CavityTrial> seen;
  static_cast<void>(search_cavity(kRange, valley({{25.0, 14.0}, 1.2}, seen), kTrials));
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_LE(seen[i].cavity.radius_mm, kRange.max_radius_mm);
    EXPECT_LE(seen[i].cavity.depth_mm, kRange.max_depth_mm);
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_FALSE(seen[i].cavity.radius_mm == seen[k].cavity.radius_mm &&
                   seen[i].cavity.depth_mm == seen[k].cavity.depth_mm &&
                   seen[i].distance == seen[k].distance);
    }
  }
}

TEST(CavitySearch, KeepsAFlatBaseThatIsTheBest) {
  const CavityTrial found = search_cavity(
      kRange,
      [](const CavityTrial& t) -> std::optional<double> {
        return 0.1 + t.cavity.depth_mm + std::abs(t.distance - 1.3);
      },
      kTrials);
  EXPECT_EQ(found.cavity.depth_mm, 0.0);
  EXPECT_NEAR(found.distance, 1.3, 0.1);
}

TEST(CavitySearch, EndsWhereNothingIsToFollow) {
  int asked = 0;
  const CavityTrial found = search_cavity(
      kRange,
      [&](const CavityTrial& t) -> std::optional<double> {
        if (++asked > 3) return std::nullopt;
        return asked == 2 ? 0.5 : std::numeric_limits<double>::infinity() - t.distance;
      },
      kTrials);
  EXPECT_EQ(asked, 4);
  EXPECT_EQ(found.cost, 0.5);
}

}  // namespace
}  // namespace lucerna
