// SPDX-License-Identifier: Apache-2.0
#include "bspline.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "support.h"
#include "surface.h"

namespace bench::test {
namespace {

/// A bicubic surface with uneven knots and coefficients that no symmetry helps.
Json uneven() {
  Json points = Json::array();
  for (int i = 0; i < 6; ++i) {
    Json row = Json::array();
    for (int j = 0; j < 5; ++j)
      row.push_back({i + 0.1 * std::sin(j), j + 0.2 * std::cos(3 * i), std::sin(i * j + 1.0)});
    points.push_back(row);
  }
  Json s = bowl_json(1.0, 1.0);
  s["degree"] = {3, 2};
  s["knots_u"] = {0, 0, 0, 0, 0.3, 1.1, 2, 2, 2, 2};
  s["knots_v"] = {0, 0, 0, 0.5, 0.5, 1, 1, 1};
  s["points_mm"] = points;
  return s;
}

TEST(Bspline, BowlIsExact) {
  const Bspline s(JsonNode("s.json", bowl_json(0.02, 50.0)));
  for (const double u : {-50.0, -31.0, 0.0, 12.5, 50.0}) {
    for (const double v : {-50.0, -7.0, 50.0}) {
      const SurfaceJet j = s.at(u, v);
      EXPECT_NEAR(j.point.x, u, 1e-12);
      EXPECT_NEAR(j.point.y, v, 1e-12);
      EXPECT_NEAR(j.point.z, 0.02 * (u * u + v * v), 1e-12);
      EXPECT_NEAR(j.by_u.z, 0.04 * u, 1e-12);
      EXPECT_NEAR(j.by_v.z, 0.04 * v, 1e-12);
    }
  }
}

// Marsden's identity: with each point at the mean of its inner knots a spline of any degree is a straight
// line, and with the mean of their products by pairs it is the square.
TEST(Bspline, LinesAndSquaresAreExactOnUnevenKnots) {
  for (int p = 2; p <= kMaxDegree; ++p) {
    std::vector<double> knots(static_cast<std::size_t>(p) + 1, -1.0);
    for (const double k : {-0.7, -0.1, -0.1, 0.6}) knots.push_back(k);
    knots.insert(knots.end(), static_cast<std::size_t>(p) + 1, 1.5);
    const auto count = knots.size() - static_cast<std::size_t>(p) - 1;
    Json points = Json::array();
    for (std::size_t i = 0; i < count; ++i) {
      double sum = 0.0, squares = 0.0;
      for (std::size_t j = i + 1; j <= i + static_cast<std::size_t>(p); ++j) {
        sum += knots[j];
        squares += knots[j] * knots[j];
      }
      const double pairs = (sum * sum - squares) / (p * (p - 1.0));
      points.push_back({{sum / p, 0.0, pairs}, {sum / p, 1.0, pairs}});
    }
    const Bspline s(JsonNode(
        "s.json",
        Json{{"degree", {p, 1}}, {"knots_u", knots}, {"knots_v", {0, 0, 1, 1}}, {"points_mm", points}}));
    for (double u = -1.0; u <= 1.5; u += 0.125) {
      const SurfaceJet j = s.at(u, 0.25);
      EXPECT_NEAR(j.point.x, u, 1e-13) << p;
      EXPECT_NEAR(j.point.y, 0.25, 1e-13);
      EXPECT_NEAR(j.point.z, u * u, 1e-13) << p;
      EXPECT_NEAR(j.by_u.x, 1.0, 1e-12) << p;
      EXPECT_NEAR(j.by_u.z, 2.0 * u, 1e-12) << p;
    }
  }
}

void expect_derivatives(const Bspline& s) {
  constexpr double h = 1e-6;
  for (const double u : {0.1, 0.299, 0.7, 1.5}) {
    for (const double v : {0.2, 0.51, 0.9}) {
      const Vec3 du = (0.5 / h) * (s.at(u + h, v).point - s.at(u - h, v).point);
      const Vec3 dv = (0.5 / h) * (s.at(u, v + h).point - s.at(u, v - h).point);
      EXPECT_LT(length(du - s.at(u, v).by_u), 1e-7);
      EXPECT_LT(length(dv - s.at(u, v).by_v), 1e-7);
    }
  }
}

TEST(Bspline, DerivativesAreThoseOfThePoints) {
  Json s = uneven();
  expect_derivatives(Bspline(JsonNode("s.json", s)));
  Json weights = Json::array();
  for (int i = 0; i < 6; ++i) weights.push_back({1.0, 2.0, 0.5, 1.0 + 0.1 * i, 1.0});
  s["weights"] = weights;
  expect_derivatives(Bspline(JsonNode("s.json", s)));
}

// A quarter of a circle of radius 2, which polynomials cannot be.
TEST(Bspline, RationalArcIsRound) {
  const double w = std::sqrt(0.5);
  const Json arc{{"degree", {2, 1}},
                 {"knots_u", {0, 0, 0, 1, 1, 1}},
                 {"knots_v", {0, 0, 1, 1}},
                 {"points_mm", {{{2, 0, 0}, {2, 0, 1}}, {{2, 2, 0}, {2, 2, 1}}, {{0, 2, 0}, {0, 2, 1}}}},
                 {"weights", {{1, 1}, {w, w}, {1, 1}}}};
  const Bspline s(JsonNode("s.json", arc));
  for (double u = 0.0; u <= 1.0; u += 0.125) {
    EXPECT_NEAR(std::hypot(s.at(u, 0.3).point.x, s.at(u, 0.3).point.y), 2.0, 1e-12);
  }
}

TEST(Bspline, RefusesWhatIsNoSurface) {
  const auto message = [](const char* key, const Json& value) {
    Json s = uneven();
    s[key] = value;
    return refusal([&] { Bspline(JsonNode("s.json", s)); });
  };
  EXPECT_EQ(message("degree", {3, 2}), "");
  EXPECT_EQ(message("degree", {9, 2}), "s.json: /degree/0: found 9, expected a whole number from 1 to 7");
  EXPECT_EQ(message("knots_v", {0, 0, 0, 1, 1, 1}),
            "s.json: /knots_v: found 6 knots, expected 8 (points + degree + 1)");
  EXPECT_NE(message("knots_v", {0, 0, 0, 0.7, 0.5, 1, 1, 1}).find("ascending order"), std::string::npos);
  Json torn = uneven();
  torn["degree"] = {1, 2};
  torn["knots_u"] = {0, 0, 0.5, 0.5, 1, 1.5, 2, 2};
  EXPECT_NE(refusal([&] { Bspline(JsonNode("s.json", torn)); }).find("expected at most the degree"),
            std::string::npos);
  EXPECT_NE(message("points_mm", {{{0, 0, 0}}, {{0, 0, 0}, {1, 1, 1}}}).find("/points_mm/1: found 2 points"),
            std::string::npos);
  EXPECT_NE(message("weights", {{1, 1}}).find("found 1 rows of weights, expected 6"), std::string::npos);
  Json ragged(6, Json(5, 1.0));
  ragged[1].push_back(1.0);
  EXPECT_NE(message("weights", ragged).find("/weights/1: found 6 weights, expected 5"), std::string::npos);
  EXPECT_NE(message("knots_v", {0, 0, 0, 1e-310, 0.5, 1, 1, 1}).find("less than 1e-9 of the domain"),
            std::string::npos);
  EXPECT_NE(
      message("knots_v", {-1e308, -1e308, -1e308, 0, 0.5, 1e308, 1e308, 1e308}).find("a domain from 1e-6"),
      std::string::npos);
}

// Hits are those of the surface, not of the triangles: a line meets z = c r^2 where the quadratic says.
TEST(BsplineSurface, HitsAreExact) {
  const auto surface = read_bspline(JsonNode("s.json", bowl_json(0.0125, 50.0)), Frame());
  const auto& mesh = surface->triangles();
  const auto middle = [&](std::uint32_t k) {
    const auto& t = mesh.triangles[k];
    return (1.0 / 3.0) * (mesh.corners[t[0]] + mesh.corners[t[1]] + mesh.corners[t[2]]);
  };
  const Vec3 from{3, -2, 60};
  for (std::uint32_t k = 0; k < mesh.triangles.size(); k += 997) {
    const Vec3 d = unit(middle(k) - from);
    Hit hit;
    ASSERT_TRUE(surface->refine(from, d, {k, length(middle(k) - from), 1.0 / 3.0, 1.0 / 3.0}, hit));
    const Vec3 p = from + hit.t * d;
    EXPECT_NEAR(p.z, 0.0125 * (p.x * p.x + p.y * p.y), 1e-9);
    EXPECT_LT(length(hit.normal - unit({-0.025 * p.x, -0.025 * p.y, 1.0})), 1e-9);
  }
}

// Steeper than the triangles can follow within their number: both axes get their part of it.
TEST(BsplineSurface, TrianglesOfDeepSurfacesAreNotThin) {
  const auto surface = read_bspline(JsonNode("s.json", bowl_json(1.0, 50.0)), Frame());
  const auto& c = surface->triangles().corners;
  double along_x = 0.0, along_y = 0.0;
  for (const auto& t : surface->triangles().triangles) {
    along_x = std::max({along_x, std::abs(c[t[0]].x - c[t[1]].x), std::abs(c[t[1]].x - c[t[2]].x)});
    along_y = std::max({along_y, std::abs(c[t[0]].y - c[t[1]].y), std::abs(c[t[1]].y - c[t[2]].y)});
  }
  EXPECT_LT(along_x, 0.5);
  EXPECT_LT(along_y, 0.5);
}

/// A hit straight down at x, y on a sheet 50 wide.
double height_hit(const Json& sheet, double x, double y) {
  const TestFolder folder;
  const Task task(folder.write(
      "t.json", task_json({{"emitter", "point"}},
                          {{"kind", "far_field"}, {"axis", "-z"}, {"function", "wall_washer"}})));
  const Submission s(folder.write("s.json", submission_json({mirror_json(sheet, place(0.0))})), task);
  const SurfaceScene scene(s.parts);
  const auto found = scene.first_hit({x, y, 60}, {0, 0, -1});
  return found.part == nullptr ? std::nan("") : 60.0 - found.hit.t;
}

// Straight along both axes and yet no plane: two triangles would miss most of it.
TEST(BsplineSurface, TwistedSheetsAreCutFinely) {
  Json sheet = bowl_json(0.0, 25.0);
  sheet["degree"] = {1, 1};
  sheet["knots_u"] = sheet["knots_v"] = {-25, -25, 25, 25};
  sheet["points_mm"] = {{{-25, -25, 5}, {-25, 25, -5}}, {{25, -25, -5}, {25, 25, 5}}};
  for (const double x : {-20.0, -3.0, 14.0}) {
    for (const double y : {-18.0, 2.0, 22.0}) EXPECT_NEAR(height_hit(sheet, x, y), 5.0 * x * y / 625.0, 1e-9);
  }
}

// One piece whose middle, and whose ends, lie on a line.
TEST(BsplineSurface, OddProfilesAreCutFinely) {
  const double c = 4e-4, h = 25.0;
  // c (x^3 - h^2 x) in the Bernstein basis over [-h, h].
  const double b = 4.0 / 3.0 * c * h * h * h;
  Json sheet = bowl_json(0.0, h);
  sheet["degree"] = {3, 1};
  sheet["knots_u"] = {-h, -h, -h, -h, h, h, h, h};
  sheet["knots_v"] = {-h, -h, h, h};
  const double x[4] = {-h, -h / 3, h / 3, h}, z[4] = {0.0, b, -b, 0.0};
  sheet["points_mm"] = Json::array();
  for (int i = 0; i < 4; ++i) sheet["points_mm"].push_back({{x[i], -h, z[i]}, {x[i], h, z[i]}});
  for (const double at : {-14.0, -2.0, 9.0, 20.0})
    EXPECT_NEAR(height_hit(sheet, at, 3.0), c * (at * at * at - h * h * at), 1e-9) << at;
}

// Limits see a trimmed surface by a grid, so it must not be lost in a sheet.
TEST(BsplineSurface, ASmallTrimOfALargeSheetIsRefused) {
  Json sheet = bowl_json(0.0, 1000.0);
  sheet["trim"] = {{"kind", "circle"}, {"diameter_mm", 100.0}};
  EXPECT_NE(refusal([&] {
              read_bspline(JsonNode("s.json", sheet), Frame());
            }).find("/trim: found less than a hundredth"),
            std::string::npos);
}

TEST(BsplineSurface, TrimTakesAway) {
  Json bowl = bowl_json(0.0125, 50.0);
  bowl["trim"] = {{"kind", "circle"}, {"diameter_mm", 80.0}, {"hole_diameter_mm", 10.0}};
  const Json there = submission_json({mirror_json(bowl, place(0.0))});
  const TestFolder folder;
  const Task task(folder.write(
      "t.json", task_json({{"emitter", "point"}},
                          {{"kind", "far_field"}, {"axis", "-z"}, {"function", "wall_washer"}})));
  const Submission s(folder.write("s.json", there), task);
  const SurfaceScene scene(s.parts);
  const auto hits = [&](double x) { return scene.first_hit({x, 0, 60}, {0, 0, -1}).part != nullptr; };
  EXPECT_FALSE(hits(4.99));
  EXPECT_TRUE(hits(5.01));
  EXPECT_TRUE(hits(39.99));
  EXPECT_FALSE(hits(40.01));
  // Its extent ends at the rims, although no corner of a triangle lies there; the vertex is in the hole.
  double radius = 0.0, low = 1e9;
  for (const Vec3& p : s.parts[0].surface->extent()) {
    radius = std::max(radius, std::hypot(p.x, p.y));
    low = std::min(low, p.z);
  }
  EXPECT_NEAR(radius, 40.0, 1e-3);
  EXPECT_NEAR(low, 0.0125 * 25.0, 1e-2);
  EXPECT_NEAR(distance(*s.parts[0].surface, {0, 0, -10}), std::hypot(5.0, 10.0 + 0.0125 * 25.0), 0.02);
}

// The triangles at the pole of a surface of revolution have no area: a cone of radius 3, 4 high.
TEST(BsplineSurface, DistanceFromAPoleIsNotZero) {
  const double w = std::sqrt(0.5);
  const std::vector<std::array<double, 2>> turn{{1, 0},   {1, 1},  {0, 1},  {-1, 1}, {-1, 0},
                                                {-1, -1}, {0, -1}, {1, -1}, {1, 0}};
  Json points = Json::array(), weights = Json::array();
  for (std::size_t k = 0; k < turn.size(); ++k) {
    points.push_back({{0, 0, 4}, {3 * turn[k][0], 3 * turn[k][1], 0}});
    weights.push_back({k % 2 == 0 ? 1.0 : w, k % 2 == 0 ? 1.0 : w});
  }
  const Json cone{{"degree", {2, 1}},
                  {"knots_u", {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}},
                  {"knots_v", {0, 0, 1, 1}},
                  {"points_mm", points},
                  {"weights", weights}};
  const auto surface = read_bspline(JsonNode("s.json", cone), Frame());
  EXPECT_NEAR(distance(*surface, {0, 0, 7}), 3.0, 1e-9);
  EXPECT_NEAR(distance(*surface, {0, 0, 0}), 2.4, 1e-3);
}

}  // namespace
}  // namespace bench::test
