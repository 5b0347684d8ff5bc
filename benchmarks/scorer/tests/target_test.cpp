// SPDX-License-Identifier: Apache-2.0
#include "target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "intensity_table.h"
#include "support.h"

namespace bench::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

JsonNode node(const Json& json) { return {"task.json", json}; }

const Json kPlane{{"kind", "plane"},
                  {"place", place(1000.0, -1.0)},
                  {"function", "uniform_rectangle"},
                  {"size_mm", {200, 100}},
                  {"cells", {20, 10}}};

TEST(Target, PlaneHasItsRectangleAndCells) {
  const Target t(node(kPlane));
  EXPECT_NEAR(t.low()[0], -99.5, 1e-9);
  EXPECT_NEAR(t.high()[1], 49.75, 1e-9);
  EXPECT_TRUE(t.is_uniform());
  EXPECT_EQ(t.cell_target().size(), 200u);
  EXPECT_NEAR(t.cell_target()[0], 100.0, 1e-6);
  // The window less 5 %: half sides 95 and 47.5 mm, cells of 10 mm: 18 x 8 are wholly inside.
  EXPECT_EQ(std::count(t.cell_steady().begin(), t.cell_steady().end(), 1), 18 * 8);
}

TEST(Target, TablesAreBilinearBetweenTheirNodes) {
  Json table{{"kind", "far_field"},
             {"axis", "-z"},
             {"function", "table"},
             {"c_step_deg", 90},
             {"gamma_step_deg", 20}};
  // C0 to C270, gamma 0, 20, 40.
  table["rows"] = std::vector<std::vector<double>>{{1, 4, 0}, {1, 2, 0}, {1, 1, 0}, {1, 0, 0}};
  const IntensityTable t(node(table));
  const auto at = [&](double c, double gamma) {
    const double s = std::sin(gamma * kDegree);
    return t.at(s * std::cos(c * kDegree), -s * std::sin(c * kDegree));
  };
  EXPECT_NEAR(at(0, 20), 4.0, 1e-9);
  EXPECT_NEAR(at(90, 20), 2.0, 1e-9);
  EXPECT_NEAR(at(270, 20), 0.0, 1e-9);
  EXPECT_NEAR(at(45, 20), 3.0, 1e-9);
  EXPECT_NEAR(at(315, 10), 0.5 * (1.0 + 2.0), 1e-9);
  EXPECT_NEAR(at(180, 30), 0.5, 1e-9);
  EXPECT_EQ(at(10, 41), 0.0);
  // A fine table of a beam is the beam.
  const Json beam{
      {"kind", "far_field"}, {"axis", "-z"}, {"function", "round_gaussian_beam"}, {"beam_deg", 30}};
  Json fine{{"kind", "far_field"},
            {"axis", "-z"},
            {"function", "table"},
            {"c_step_deg", 60},
            {"gamma_step_deg", 0.25}};
  std::vector<double> row;
  for (int k = 0; k <= 360; ++k) row.push_back(std::exp2(-std::pow(2.0 * 0.25 * k / 30.0, 2)));
  fine["rows"] = std::vector<std::vector<double>>(6, row);
  const Target a(node(beam)), b(node(fine));
  double off = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < a.box_target().size(); ++k) {
    off += std::abs(a.box_target()[k] - b.box_target()[k]);
    sum += a.box_target()[k];
  }
  EXPECT_LT(off, 2e-4 * sum);
}

TEST(Target, BrokenTablesAreRefused) {
  const auto message = [](const Json& rows, double step) {
    Json t{{"kind", "far_field"},
           {"axis", "-z"},
           {"function", "table"},
           {"c_step_deg", 180},
           {"gamma_step_deg", step}};
    t["rows"] = rows;
    return refusal([&] { const Target target(node(t)); });
  };
  using Rows = std::vector<std::vector<double>>;
  EXPECT_NE(message(Rows{{1, 2}, {1, 2, 3}}, 10).find("/rows/1: found 3 values"), std::string::npos);
  EXPECT_NE(message(Rows{{1, 2}}, 10).find("/rows: found 1 rows, expected 360 / c_step_deg"),
            std::string::npos);
  EXPECT_NE(message(Rows{{1, -2}, {1, 2}}, 10).find("found an intensity < 0"), std::string::npos);
  EXPECT_NE(message(Rows{{1, 2, 0}, {1, 2, 0}}, 60).find("beyond 90 degrees"), std::string::npos);
  EXPECT_NE(message(Rows{{0, 0}, {0, 0}}, 10).find("expected a target with light"), std::string::npos);
}

TEST(Target, LightLandsOnThePlane) {
  const Target t(node(kPlane));
  const Landing a = t.land({0, 0, 0}, unit({0.0905, 0, 1}));  // x = 90.5 mm, y = 0
  EXPECT_TRUE(a.in_window);
  EXPECT_EQ(a.cell[0], 5 * 20 + 19);
  EXPECT_EQ(a.box % 48, static_cast<int>((90.5 + 99.5) / 199.0 * 48));
  const Landing rim = t.land({0, 0, 0}, unit({0.0998, 0, 1}));  // in the window, not in the rectangle
  EXPECT_TRUE(rim.in_window);
  EXPECT_EQ(rim.box, -1);
  EXPECT_FALSE(t.land({0, 0, 0}, unit({0.11, 0, 1})).in_window);
  EXPECT_FALSE(t.land({0, 0, 0}, {0, 0, -1}).in_window);
  EXPECT_FALSE(t.land({0, 0, 1500}, {0, 0, 1}).in_window);  // from behind
}

TEST(Target, SteepLightDoesNotCountWhereAnglesAreLimited) {
  Json limited = kPlane;
  limited["max_angle_deg"] = 30;
  const Target t(node(limited));
  EXPECT_TRUE(t.land({-500, 0, 0}, unit({0.5, 0, 1})).in_window);
  EXPECT_FALSE(t.land({-600, 0, 0}, unit({0.6, 0, 1})).in_window);
}

// A Lambertian intensity is even in direction cosines: its marginal is a half circle.
TEST(Target, CosineHasItsRectangle) {
  const Target t(node(
      {{"kind", "far_field"}, {"axis", "+z"}, {"function", "cosine_power"}, {"power", 1}, {"edge_deg", 90}}));
  const double u = t.high()[0];
  const double above = (std::acos(u) - u * std::sqrt(1.0 - u * u)) / std::numbers::pi;
  EXPECT_NEAR(above, 0.0025, 2e-5);
  double sum = 0.0;
  for (const double f : t.box_target()) sum += f;
  EXPECT_NEAR(sum, 0.99 * std::numbers::pi, 0.01);
}

// Half of the peak at half the beam angle; the rectangle of 99.5 % is symmetric.
TEST(Target, GaussianBeamIsAsWideAsItSays) {
  const Target t(node({{"kind", "far_field"},
                       {"axis", "-z"},
                       {"function", "gaussian_beam"},
                       {"beam_x_deg", 4},
                       {"beam_y_deg", 2}}));
  EXPECT_NEAR(t.low()[0], -t.high()[0], 1e-6);
  EXPECT_NEAR(t.high()[0] / t.high()[1], 2.0, 0.05);
  // 2^-(x/1 deg)^2 is a Gaussian of sigma 1 / sqrt(2 ln 2) degrees; 0.25 % lie above 2.807 sigma.
  const double degrees = std::asin(t.high()[1]) * 180.0 / std::numbers::pi;
  EXPECT_NEAR(degrees, 2.807 / std::sqrt(2.0 * std::log(2.0)), 0.005);
}

TEST(Target, AngleHasTentsAndBoxesOfTheSine) {
  const Target t(node(
      {{"kind", "angle"}, {"axis", "-z"}, {"function", "cosine_power"}, {"power", 0}, {"edge_deg", 20}}));
  EXPECT_EQ(t.box_measure().size(), 48u);
  double radians = 0.0;
  for (const double m : t.box_measure()) radians += m;
  EXPECT_NEAR(radians, 0.995 * 40.0 * std::numbers::pi / 180.0, 1e-4);
  EXPECT_EQ(t.cell_target().size(), 181u);
  EXPECT_NEAR(t.cell_target()[90] / t.cell_target()[80], 1.0, 1e-9);
  EXPECT_NEAR(t.cell_target()[70] / t.cell_target()[80], 0.5, 1e-3);
  EXPECT_EQ(t.cell_target()[68], 0.0);
  const double phi = 10.25 * std::numbers::pi / 180.0;
  const Landing at = t.land({}, {std::sin(phi), 0, -std::cos(phi)});
  EXPECT_EQ(at.cell[0], 100);
  EXPECT_EQ(at.cell[1], 101);
  EXPECT_NEAR(at.share_of_first, 0.75, 1e-9);
  EXPECT_TRUE(at.in_window);
  EXPECT_EQ(t.land({}, {0, 0, 1}).cell[0], -1);
}

TEST(Target, RefusesWhatItDoesNotKnow) {
  Json t = kPlane;
  t["function"] = "star";
  EXPECT_EQ(refusal([&] { Target target(node(t)); }),
            "task.json: /function: found \"star\", expected one of uniform_rectangle, uniform_disk");
  t = kPlane;
  t["cells"] = {0, 4};
  EXPECT_EQ(refusal([&] { Target target(node(t)); }),
            "task.json: /cells/0: found 0, expected a whole number from 1 to 1000");
  t = kPlane;
  t["place"]["z_axis"] = {0, 1, 1};
  EXPECT_NE(refusal([&] { Target target(node(t)); }).find("/place: found"), std::string::npos);
}

}  // namespace
}  // namespace bench::test
