// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/constraints/limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/cad.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/constraints/keep_out.h"
#include "lucerna/design/constraints/light_limits.h"
#include "lucerna/design/constraints/limit_check.h"
#include "lucerna/source.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::TempDir;
using testing::HasSubstr;

Eigen::VectorXd random_move(std::size_t n, double size_mm, std::uint64_t seed) {
  Eigen::VectorXd p(static_cast<Eigen::Index>(n));
  Rng rng(seed, 0);
  for (double& x : p) x = size_mm * (2.0 * rng.uniform() - 1.0);
  return p;
}

std::vector<DesignShape> wild_shapes() {
  const auto wild = [](const DesignShape& s, std::uint64_t seed) {
    return s.with(random_move(s.parameter_count(), 0.5, seed));
  };
  return {wild(DesignShape::revolution(12, Aperture::circle(80, 10), 8), 1),
          wild(DesignShape::bspline(12, Aperture::circle(80), 5, 5), 2),
          wild(DesignShape::bspline(12, Aperture::rectangle(80, 60, 12), 6, 4, ShapeSymmetry::both), 3)};
}

/// In the luminaire frame here the mirror opens along +z, as in its own.
DesignLimits read(const std::string& text, bool revolution = true,
                  const Aperture& aperture = Aperture::circle(80, 10)) {
  const TempDir folder;
  write_file(folder / "l.toml", text);
  const toml::table table = parse_toml_file(folder / "l.toml");
  return read_limits(TomlReader(table, (folder / "l.toml").string(), "design.limits"), aperture, revolution,
                     Frame(), {}, 1000.0);
}

std::string refusal(const std::string& text, bool revolution = true) {
  try {
    read(text, revolution);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// Every kind of limit that a wild shape breaks.
std::vector<DesignLimits> breakable() {
  std::vector<DesignLimits> all(4);
  all[0].max_height_mm = 20.0;
  all[1].max_slope_deg = 50.0;
  all[2].min_radius_mm = 18.0;
  all[3] =
      read("[[keep_out]]\nkind = \"box\"\nmin_mm = [15, -4, 4]\nmax_mm = [25, 6, 20]\nclearance_mm = 1.5\n");
  return all;
}

TEST(ShapeLimits, DerivativesAgreeWithCentralDifferences) {
  for (const DesignShape& shape : wild_shapes()) {
    const auto limits = breakable();
    for (std::size_t l = 0; l < limits.size(); ++l) {
      const ShapeLimits cost(limits[l], shape);
      const auto n = static_cast<Eigen::Index>(shape.parameter_count());
      NormalEquations e{0.0, Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)};
      ResidualRows rows;
      const double here = cost.cost(shape, &rows);
      rows.add_to(e);
      if (here == 0.0) continue;
      // Curvature keeps its direction and metric in the derivative: good enough for a step, not exact.
      const double within = l == 2 ? 0.3 : 1e-4;
      Eigen::VectorXd difference(n);
      for (Eigen::Index p = 0; p < n; ++p) {
        Eigen::VectorXd x = shape.parameters();
        constexpr double kStep = 1e-6;
        x[p] += kStep;
        const double plus = cost.cost(shape.with(x), nullptr);
        x[p] -= 2.0 * kStep;
        difference[p] = (plus - cost.cost(shape.with(x), nullptr)) / (2.0 * kStep);
      }
      EXPECT_LT((difference - 2.0 * e.gradient).norm(), within * difference.norm()) << "limit " << l;
    }
  }
}

TEST(ShapeLimits, TheNearestShapeHoldsThemInItsExportedMesh) {
  for (const DesignShape& shape : wild_shapes()) {
    for (const DesignLimits& limits : breakable()) {
      const ShapeLimits form(limits, shape);
      const DesignShape held = form.nearest(shape);
      EXPECT_TRUE(form.held(held));
      CadTolerance tolerance;
      const Mesh mesh = cad_mesh_within(held.reflector(), tolerance);
      for (const LimitCheck& c : check_limits(mesh, limits, tolerance.chord_mm, tolerance.slope_deg)) {
        EXPECT_TRUE(c.held) << c.limit << ": " << c.found.mean << " of " << c.allowed;
      }
      // A shape that holds them is left as it is.
      EXPECT_EQ(form.nearest(held).parameters(), held.parameters());
    }
  }
}

TEST(ShapeLimits, TheMeshTellsWhenALimitIsBroken) {
  const DesignShape shape = wild_shapes()[1];
  const CadTolerance tolerance;
  const Mesh mesh = cad_mesh(shape.reflector(), tolerance);
  for (const DesignLimits& limits : breakable()) {
    const bool held = ShapeLimits(limits, shape).held(shape);
    for (const LimitCheck& c : check_limits(mesh, limits, tolerance.chord_mm, tolerance.slope_deg)) {
      EXPECT_EQ(c.held, held) << c.limit << ": " << c.found.mean << " of " << c.allowed;
    }
  }
  DesignLimits sizes;
  sizes.max_diameter_mm = 79.0;
  sizes.min_opening_mm = 81.0;
  sizes.min_hole_diameter_mm = 1.0;
  const auto found = check_limits(mesh, sizes, tolerance.chord_mm, tolerance.slope_deg);
  ASSERT_EQ(found.size(), 3u);
  for (const LimitCheck& c : found) EXPECT_FALSE(c.held) << c.limit;
  EXPECT_NEAR(found[0].found.mean, 80.0, 1e-6);
}

TEST(ShapeLimits, ASphereHasItsRadius) {
  DesignShape shape = DesignShape::revolution(20, Aperture::circle(40), 16);
  shape = shape.through([](double x, double y) { return 40.0 - std::sqrt(1600.0 - x * x - y * y); });
  DesignLimits limits;
  limits.min_radius_mm = 39.0;
  EXPECT_TRUE(ShapeLimits(limits, shape).held(shape));
  const auto mesh = check_limits(cad_mesh(shape.reflector()), limits, 0.01, 2.0);
  EXPECT_NEAR(mesh.at(0).found.mean, 40.0, 0.2);
  limits.min_radius_mm = 41.0;
  EXPECT_FALSE(ShapeLimits(limits, shape).held(shape));
}

TEST(ShapeLimits, NamesThePairThatContradicts) {
  const DesignShape shape = DesignShape::bspline(15, Aperture::circle(80), 6, 6);
  const auto message = [&](const std::string& text) {
    try {
      ShapeLimits(read(text, false), shape).nearest(shape);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  // In front of the middle, behind the rim: together they want 20 mm of height.
  const std::string front = "[[keep_out]]\nkind = \"box\"\nmin_mm = [-5, -5, 1]\nmax_mm = [5, 5, 30]\n";
  const std::string behind = "[[keep_out]]\nkind = \"box\"\nmin_mm = [30, -5, -20]\nmax_mm = [36, 5, 13]\n";
  EXPECT_THAT(message("max_height_mm = 5\n" + front + behind),
              HasSubstr("leave no mirror of this aperture, though any two of them do"));
  EXPECT_THAT(
      message(
          "max_height_mm = 60\n" + front +
          "[[keep_out]]\nkind = \"box\"\nmin_mm = [-4, -4, -30]\nmax_mm = [4, 4, -1]\nclearance_mm = 3\n"),
      HasSubstr("keep_out[0] and keep_out[1] contradict each other"));
  EXPECT_EQ(message("max_height_mm = 40\nmax_slope_deg = 70\n" + front + behind), "");
}

TEST(DesignLimits, WhatTheApertureDecidesIsRefusedWithThePair) {
  EXPECT_THAT(refusal("max_diameter_mm = 70\n"),
              HasSubstr("contradicts the reflector's aperture, 80 mm across"));
  EXPECT_THAT(refusal("min_opening_mm = 90\n"),
              HasSubstr("contradicts the reflector's aperture, 80 mm wide"));
  EXPECT_THAT(refusal("min_opening_mm = 90\nmax_diameter_mm = 85\n"),
              HasSubstr("contradicts max_diameter_mm = 85"));
  EXPECT_THAT(refusal("min_hole_diameter_mm = 12\n"),
              HasSubstr("contradicts the reflector's hole_diameter_mm = 10"));
  EXPECT_THAT(refusal("min_hole_diameter_mm = 90\nmax_diameter_mm = 85\n"),
              HasSubstr("the hole would be the whole"));
  EXPECT_THAT(refusal("symmetry = \"rotational\"\n", false), HasSubstr("contradicts the family"));
  EXPECT_THAT(refusal("max_slope_deg = 95\n"), HasSubstr("found 95, expected > 0 and < 90"));
  EXPECT_THAT(refusal("max_hight_mm = 9\n"), HasSubstr("max_height_mm"));
  EXPECT_THAT(refusal("body_clearance_mm = 1\n"), HasSubstr("needs a [[body]]"));
  EXPECT_THAT(refusal("[glare]\nbeyond_deg = 60\n"), HasSubstr("either max_cd or max_cd_per_klm"));
  EXPECT_THAT(refusal("[[keep_out]]\nkind = \"ball\"\n"), HasSubstr("expected box, cylinder or mesh"));
  EXPECT_EQ(refusal("max_diameter_mm = 80\nmin_opening_mm = 80\nmin_hole_diameter_mm = 10\n"
                    "symmetry = \"rotational\"\n[glare]\nbeyond_deg = 60\nmax_cd = 100\n"),
            "");
}

TEST(KeepOut, ColumnsHoldAThickenedZone) {
  const DesignLimits limits = read(
      "[[keep_out]]\nkind = \"cylinder\"\nfrom_mm = [0, 0, 5]\nto_mm = [0, 0, 9]\nradius_mm = "
      "6\nclearance_mm = 2\n");
  const auto columns = zone_columns(limits.keep_out[0], Aperture::circle(80), false);
  ASSERT_FALSE(columns.empty());
  double middle_low = 1e9, reach = 0.0;
  for (const ZoneColumn& c : columns) {
    reach = std::max(reach, std::hypot(c.x_mm, c.y_mm));
    if (std::hypot(c.x_mm, c.y_mm) < 1.0) middle_low = std::min(middle_low, c.low_mm);
  }
  EXPECT_NEAR(middle_low, 3.0, 1e-9);
  EXPECT_GE(reach, 8.0);
  EXPECT_LE(reach, 8.0 + 3.0 * 80.0 / 80.0);  // and no more than the places' own distance beyond
}

/// A disk that shines at a mirror.
DesignRays rays_at(double focal_mm, std::uint64_t seed = 7) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  PlacedSource source{make_emitter(options), Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, focal_mm}), {}};
  DesignRays out({source}, Frame(), seed);
  out.grow(1 << 16);
  return out;
}

TEST(LightLimits, GlareDerivativesAgreeWithCentralDifferences) {
  DesignRays light = rays_at(12);
  DesignLimits limits;
  limits.glare = GlareLimit{8.0, 0.05, ""};
  const LightLimits cost(limits, Reflectance(0.9));
  DesignShape shape = wild_shapes()[1];
  shape = shape.with(3.0 * shape.parameters());
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  NormalEquations e{0.0, Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)};
  ResidualRows rows;
  ASSERT_GT(cost.cost(shape, light, 1 << 16, &rows), 0.0);
  rows.add_to(e);
  Eigen::VectorXd difference(n);
  for (Eigen::Index p = 0; p < n; ++p) {
    Eigen::VectorXd x = shape.parameters();
    x[p] += 1e-6;
    const double plus = cost.cost(shape.with(x), light, 1 << 16, nullptr);
    x[p] -= 2e-6;
    difference[p] = (plus - cost.cost(shape.with(x), light, 1 << 16, nullptr)) / 2e-6;
  }
  EXPECT_LT((difference - 2.0 * e.gradient).norm(), 0.05 * difference.norm());
}

TEST(LightLimits, EfficiencyBeyondTheReflectanceIsRefused) {
  DesignRays light = rays_at(12);
  const DesignShape shape = DesignShape::bspline(12, Aperture::circle(80), 4, 4);
  DesignLimits limits;
  limits.min_efficiency = 0.95;
  try {
    LightLimits(limits, Reflectance(0.8)).check(shape, light);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("min_efficiency = 0.95 and the reflector's reflectance, at most 0.8"));
  }
  LightLimits(limits, Reflectance(0.98)).check(shape, light);
  limits.min_efficiency = 0.75;
  LightLimits(limits, Reflectance(0.8)).check(shape, light);
}

TEST(LimitCheck, NamesTheLimitsThatBind) {
  const std::string said = binding_limits({{"max_diameter_mm", 80.0, {80.0, 0.0}, true},
                                           {"max_height_mm", 15.0, {14.99, 0.0}, true},
                                           {"max_slope_deg", 60.0, {40.0, 0.0}, true},
                                           {"min_efficiency", 0.85, {0.852, 0.001}, true},
                                           {"keep_out[0]", 1.0, {1.1, 0.0}, true},
                                           {"glare 10 cd/klm", 100.0, {20.0, 0.0}, true}});
  EXPECT_EQ(
      said,
      "what limits this design is set: envelope (max_height_mm: 14.99 found, 15 allowed), efficiency "
      "(min_efficiency: 0.8520 +- 0.0010 found, 0.85 allowed), envelope (keep_out[0]: 1.1 found, 1 allowed)");
  EXPECT_EQ(binding_limits({{"max_height_mm", 15.0, {12.0, 0.0}, true}}), "");
}

TEST(LimitCheck, NamesTheLimitsThatAreBroken) {
  EXPECT_EQ(
      broken_limits(
          {{"max_height_mm", 15.0, {12.0, 0.0}, true}, {"min_efficiency", 0.85, {0.802, 0.001}, false}}),
      std::vector<std::string>{"limit min_efficiency is not held: 0.8020 +- 0.0010 found, 0.85 allowed"});
}

}  // namespace
}  // namespace lucerna
