// SPDX-License-Identifier: Apache-2.0
#include "road.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "random.h"
#include "support.h"

namespace bench::test {
namespace {

constexpr double kHeight = 8.0, kSpacing = 28.0, kLane = 3.5;
constexpr int kSteps = 10, kLanes = 2;

/// Bilinear in both, so that the table is the function: shiny towards the observer.
double reduced(double tan_gamma, double beta_deg) {
  return 1e-4 * (400.0 - 30.0 * tan_gamma) * (1.0 - 0.8 * beta_deg / 180.0);
}

Json road_json() {
  Json rows = Json::array();
  for (const double t : {0.0, 4.0, 12.0})
    rows.push_back({1e4 * reduced(t, 0), 1e4 * reduced(t, 90), 1e4 * reduced(t, 180)});
  return {{"kind", "road"},
          {"place", place(8000.0, -1.0)},
          {"lanes", kLanes},
          {"lane_width_mm", 1000.0 * kLane},
          {"spacing_mm", 1000.0 * kSpacing},
          {"min_overall_uniformity", 0.4},
          {"min_lengthwise_uniformity", 0.6},
          {"max_threshold_increment", 0.15},
          {"reflection", {{"tan_gamma", {0, 4, 12}}, {"beta_deg", {0, 90, 180}}, {"r_1e4", rows}}}};
}

/// Intensity of a lamp of about 1 lm, with more along the road, forwards and to y > 0; cd by x, y, z down.
double lamp(double x, double y, double z) {
  return z / std::numbers::pi * (0.6 + 0.4 * x * x + 0.3 * x + 0.2 * y);
}

using Weight = std::function<double(double, double, double)>;

RoadScore traced(const Road& road, std::uint64_t rays, const Weight& weight) {
  constexpr std::size_t kParts = 16;
  std::vector<std::vector<double>> shares(kParts, std::vector<double>(road.sums(), 0.0));
  for (std::uint64_t k = 0; k < rays; ++k) {
    RayRandom random(5, k);
    const double radius = std::sqrt(random.uniform()), turn = 2.0 * std::numbers::pi * random.uniform();
    const Vec3 d{radius * std::cos(turn), radius * std::sin(turn), -std::sqrt(1.0 - radius * radius)};
    Deposits deposits;
    road.land({0, 0, 1000.0 * kHeight}, d, deposits);
    for (const Deposit& deposit : deposits) {
      if (deposit.sum < 0) continue;
      EXPECT_LE(deposit.per_weight, 1.0);
      shares[k % kParts][static_cast<std::size_t>(deposit.sum)] +=
          weight(d.x, d.y, -d.z) * deposit.per_weight * kParts / static_cast<double>(rays);
    }
  }
  return road.score(shares);
}

/// EN 13201-3 by its formulas, lamp by lamp, each cell by 9 x 9 of its points.
struct Standard {
  double lm_per_cd_m2, overall, lengthwise, increment;
};

double luminance(double x, double y, double observer_y, bool reversed) {
  double sum = 0.0;
  for (int k = -8; k <= 8; ++k) {
    const double to_x = x - kSpacing * k, d = std::sqrt(to_x * to_x + y * y + kHeight * kHeight);
    const double across = std::hypot(to_x, y), view_x = 60.0 + x, view_y = y - observer_y;
    const double cosine = (to_x * view_x + y * view_y) / (across * std::hypot(view_x, view_y));
    double beta = 180.0 - std::acos(std::max(-1.0, std::min(1.0, cosine))) * 180.0 / std::numbers::pi;
    if (reversed) beta = 180.0 - beta;
    if (across / kHeight > 12.0) continue;
    sum += lamp(to_x / d, y / d, kHeight / d) * reduced(across / kHeight, beta) / (kHeight * kHeight);
  }
  return sum;
}

Standard by_formula(bool reversed) {
  constexpr int kRows = 3 * kLanes, kFine = 9;
  Standard out{0.0, 1.0, 1.0, 0.0};
  double darkest = 1e9, veil = 0.0;
  for (int lane = 0; lane < kLanes; ++lane) {
    const double eye_y = (lane + 0.5) * kLane;
    double least = 1e9, sum = 0.0, low = 1e9, high = 0.0;
    for (int j = 0; j < kRows; ++j) {
      for (int i = 0; i < kSteps; ++i) {
        double cell = 0.0;
        for (int a = 0; a < kFine * kFine; ++a) {
          const double x = (i + (a % kFine + 0.5) / kFine) * kSpacing / kSteps;
          const double y = (j + (a / kFine + 0.5) / kFine) * kLane / 3.0;
          cell += luminance(x, y, eye_y, reversed) / (kFine * kFine);
        }
        sum += cell;
        least = std::min(least, cell);
        if (j == 3 * lane + 1) {
          low = std::min(low, cell);
          high = std::max(high, cell);
        }
      }
    }
    const double mean = sum / (kRows * kSteps);
    out.overall = std::min(out.overall, least / mean);
    out.lengthwise = std::min(out.lengthwise, low / high);
    darkest = std::min(darkest, mean);
    for (int place = 0; place < kSteps; ++place) {
      double sum_of_lamps = 0.0;
      for (int k = 0; k < 18; ++k) {
        const double ahead = 2.75 * 6.5 + kSpacing * k - place * kSpacing / kSteps;
        if (ahead < 2.75 * 6.5 - 1e-9 || ahead > 500.0) continue;
        const double d = std::sqrt(ahead * ahead + eye_y * eye_y + 6.5 * 6.5);
        const double sight = std::numbers::pi / 180.0;
        const double cosine = (ahead * std::cos(sight) - 6.5 * std::sin(sight)) / d;
        const double theta = std::acos(cosine) * 180.0 / std::numbers::pi;
        sum_of_lamps += 10.0 * lamp(-ahead / d, eye_y / d, 6.5 / d) / (d * d) * cosine / (theta * theta);
      }
      veil = std::max(veil, sum_of_lamps);
    }
  }
  out.lm_per_cd_m2 = 1.0 / darkest;
  out.increment = 0.65 * veil / darkest;
  return out;
}

// False alarms: five standard errors for each of four figures, 2e-6. A road that shines away from the
// observer, as by angles counted the other way round, is rejected.
TEST(RoadStatistical, FiguresAreThoseOfTheStandardsFormulas) {
  const Road road(JsonNode("task.json", road_json()), 1000.0 * kHeight);
  // Lambertian rays carry pi I / cosine.
  const RoadScore found = traced(
      road, 1 << 23, [](double x, double y, double z) { return std::numbers::pi * lamp(x, y, z) / z; });
  const auto far = [](const Estimate& e, double from, double grain) {
    return std::abs(e.mean - from) / (e.standard_error + grain * from);
  };
  const Standard right = by_formula(false), wrong = by_formula(true);
  EXPECT_LT(far(found.lm_per_cd_m2, right.lm_per_cd_m2, 1e-4), 5.0);
  // The least of noisy cells lies below the least one, by an error or two.
  EXPECT_LT(far(found.overall, right.overall, 2e-3), 5.0);
  EXPECT_LT(far(found.lengthwise, right.lengthwise, 2e-3), 5.0);
  // The eye's cell is 2.8 m long.
  EXPECT_LT(far(found.threshold_increment, right.increment, 1e-2), 5.0);
  EXPECT_GT(far(found.lm_per_cd_m2, wrong.lm_per_cd_m2, 1e-4), 20.0);
  EXPECT_LT(found.lm_per_cd_m2.standard_error, 0.005 * found.lm_per_cd_m2.mean);
}

TEST(Road, LampsOfARowLightTheSameField) {
  const Road road(JsonNode("task.json", road_json()), 8000.0);
  const Vec3 d = unit({0.7, 0.3, -0.5});
  Deposits here, there;
  ASSERT_TRUE(road.land({0, 0, 8000}, d, here));
  ASSERT_TRUE(road.land({-3 * 28000.0, 0, 8000}, d, there));
  for (std::size_t k = 1; k <= 2; ++k) {
    EXPECT_EQ(here[k].sum, there[k].sum);
    EXPECT_NEAR(here[k].per_weight, there[k].per_weight, 1e-12);
  }
  Deposits none;
  EXPECT_FALSE(road.land({0, 0, 8000}, unit({0.7, -0.1, -0.5}), none));
  EXPECT_FALSE(road.land({0, 0, 8000}, {0, 0, 1}, none));
  EXPECT_EQ(none[1].sum, -1);
}

TEST(Road, RefusesWhatIsNoRoad) {
  const auto message = [](const char* pointer, const Json& value, double height_mm = 8000.0) {
    Json t = road_json();
    t[Json::json_pointer(pointer)] = value;
    return refusal([&] { Road(JsonNode("task.json", t), height_mm); });
  };
  EXPECT_EQ(message("/lanes", 2), "");
  EXPECT_EQ(message("/lanes", 5), "task.json: /lanes: found 5, expected a whole number from 1 to 4");
  EXPECT_NE(message("/lanes", 2, 1400.0).find("expected above 1500 mm"), std::string::npos);
  EXPECT_NE(message("/reflection/tan_gamma", {0, 4, 4}).find("expected ascending numbers from 0 on"),
            std::string::npos);
  EXPECT_NE(message("/reflection/beta_deg", {0, 90, 170}).find("expected angles up to 180"),
            std::string::npos);
  EXPECT_NE(message("/reflection/r_1e4/1/0", -1).find("/reflection/r_1e4/1: "), std::string::npos);
  EXPECT_NE(message("/reflection/r_1e4", {{1, 1, 1}}).find("found 1 rows, expected 3"), std::string::npos);
}

TEST(Road, ABareSourceDoesNotLightItAsItMust) {
  Json task = task_json({{"emitter", "disk"}, {"radius_mm", 0.5}}, road_json());
  task["headline"] = "efficiency_with_losses";
  task["target"]["min_overall_uniformity"] = 0.9;
  // A mirror below the source's back, that no light meets.
  const Json submission = submission_json({mirror_json(bowl_json(0.0, 1.0), place(-5.0))});
  const auto bare = scored(task, submission, 1 << 20, 2), many = scored(task, submission, 1 << 20, 5);
  EXPECT_FALSE(bare.json["counts"].get<bool>());
  EXPECT_NE(bare.json["faults"].dump().find("overall uniformity: found"), std::string::npos);
  EXPECT_TRUE(bare.json["error_48"].is_null());
  // Half of the light beside the lamp, as far as the road is wide.
  const double share = 0.5 * std::sin(std::atan(7.0 / 8.0));
  EXPECT_NEAR(bare.score.efficiency.mean, share, 5.0 * bare.score.efficiency.standard_error + 1e-6);
  EXPECT_EQ(many.json["road"].dump(), bare.json["road"].dump());
}

}  // namespace
}  // namespace bench::test
