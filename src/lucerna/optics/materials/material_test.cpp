// SPDX-License-Identifier: Apache-2.0
#include "lucerna/material.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/geometry.h"

namespace lucerna {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(Material, IndicesAreThosePublished) {
  // n at the d line (587.56 nm), as the makers and publications of the formulas state it.
  EXPECT_NEAR(refractive_index("bk7", 587.56).n, 1.5168, 1e-5);
  EXPECT_NEAR(refractive_index("fused-silica", 587.56).n, 1.45846, 1e-5);
  EXPECT_NEAR(refractive_index("pmma", 587.56).n, 1.4917, 1.5e-3) << "grades differ in the third decimal";
  EXPECT_NEAR(refractive_index("polycarbonate", 587.56).n, 1.585, 1e-3);
  EXPECT_NEAR(refractive_index("soda-lime", 587.56).n, 1.5234, 1e-3);
  EXPECT_EQ(refractive_index("bk7", 587.56).k, 0.0);
  // A row of the table, and halfway between two.
  EXPECT_NEAR(refractive_index("aluminium", 500.0).k, 5.3205, 1e-9);
  EXPECT_NEAR(refractive_index("aluminium", 510.0).n, 0.5 * (0.6257 + 0.6883), 1e-9);
  EXPECT_NEAR(refractive_index("silver", 780.0).n, 0.0635, 1e-9);
}

TEST(Material, ClearMediaDisperseNormally) {
  for (const MaterialInfo& m : materials()) {
    if (m.is_metal) continue;
    double last = refractive_index(m.name, 440.0).n;
    for (double nm = 460.0; nm <= 700.0; nm += 20.0) {
      const double n = refractive_index(m.name, nm).n;
      EXPECT_LT(n, last) << m.name << " at " << nm;
      last = n;
    }
  }
}

TEST(Material, HasItsOwnRangeAndNoOther) {
  for (const MaterialInfo& m : materials()) {
    EXPECT_GT(refractive_index(m.name, m.min_nm).n, 0.0);
    EXPECT_GT(refractive_index(m.name, m.max_nm).n, 0.0);
    EXPECT_FALSE(m.source.empty() || m.meaning.empty());
    for (const double nm : {m.min_nm - 1.0, m.max_nm + 1.0, std::nan("")})
      EXPECT_THROW((void)refractive_index(m.name, nm), InputError) << m.name;
  }
}

TEST(Dispersion, IsTheIndexOfEachWavelength) {
  for (const MaterialInfo& m : materials()) {
    if (m.is_metal) continue;
    const Dispersion d = dispersion(m.name);
    EXPECT_EQ(d.min_nm(), m.min_nm);
    EXPECT_EQ(d.max_nm(), m.max_nm);
    for (int i = 0; i <= 1000; ++i) {
      const double nm = std::lerp(m.min_nm, m.max_nm, i / 1000.0);
      EXPECT_NEAR(d.index(nm), refractive_index(m.name, nm).n, 1e-5) << m.name << " at " << nm;
    }
    EXPECT_EQ(d.index(100.0), d.index(m.min_nm)) << "held beyond the ends";
    EXPECT_EQ(d.index(9000.0), d.index(m.max_nm));
    EXPECT_FALSE(d.has_absorption());
  }
  EXPECT_THROW((void)dispersion("silver"), InputError);
  EXPECT_THROW((void)dispersion("butter"), InputError);
}

TEST(Dispersion, RefusesWhatIsNone) {
  EXPECT_THROW(Dispersion(500.0, 500.0, {1.5, 1.5}), InputError);
  EXPECT_THROW(Dispersion(0.0, 500.0, {1.5, 1.5}), InputError);
  EXPECT_THROW(Dispersion(400.0, std::nan(""), {1.5, 1.5}), InputError);
  EXPECT_THROW(Dispersion(400.0, 500.0, {1.5}), InputError);
  EXPECT_THROW(Dispersion(400.0, 500.0, {1.5, 0.9}), InputError);
  EXPECT_THROW(Dispersion(400.0, 500.0, {1.5, 1.5}, {0.1}), InputError);
  EXPECT_THROW(Dispersion(400.0, 500.0, {1.5, 1.5}, {0.1, -0.1}), InputError);
  const Dispersion d(400.0, 500.0, {1.6, 1.5}, {0.0, 0.2});
  EXPECT_NEAR(d.index(425.0), 1.575, 1e-12);
  EXPECT_NEAR(d.absorption_per_mm(475.0), 0.15, 1e-12);
}

TEST(Material, NamesTheNearestThatIsKnown) {
  try {
    (void)refractive_index("aluminum", 550.0);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("'aluminum'"), HasSubstr("'aluminium'")));
  }
}

TEST(Fresnel, OfAClearMediumIsSnellsAndFresnels) {
  const double n = 1.5;
  for (int i = 0; i < 1000; ++i) {
    const double angle = 0.5 * std::numbers::pi * (i + 0.5) / 1000.0, inside = std::asin(std::sin(angle) / n);
    const double s = std::sin(angle - inside) / std::sin(angle + inside);
    const double p = std::tan(angle - inside) / std::tan(angle + inside);
    EXPECT_NEAR(fresnel_reflectance(std::cos(angle), {n}), 0.5 * (s * s + p * p), 1e-12) << angle;
  }
  EXPECT_NEAR(fresnel_reflectance(1.0, {n}), 0.04, 1e-15);
  EXPECT_NEAR(fresnel_reflectance(0.0, {n}), 1.0, 1e-15);
}

TEST(Fresnel, OfAMetalIsAsCalculatedAtNormalIncidence) {
  const RefractiveIndex metal = refractive_index("aluminium", 550.0);
  const double n = metal.n, k = metal.k;
  EXPECT_NEAR(fresnel_reflectance(1.0, metal), ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k),
              1e-14);
  // Films of evaporated metal in the visible.
  EXPECT_NEAR(fresnel_reflectance(1.0, metal), 0.915, 0.005);
  EXPECT_NEAR(fresnel_reflectance(1.0, refractive_index("silver", 550.0)), 0.985, 0.005);
}

TEST(Fresnel, StaysBetweenNothingAndAll) {
  for (const double n : {0.05, 1.0, 1.5, 4.0}) {
    for (const double k : {0.0, 0.01, 3.0, 30.0}) {
      for (double c = 0.0; c <= 1.0; c += 0.01) {
        const double r = fresnel_reflectance(c, {n, k});
        EXPECT_TRUE(r >= 0.0 && r <= 1.0 + 1e-15) << n << " " << k << " " << c << ": " << r;
      }
    }
  }
  EXPECT_EQ(fresnel_reflectance(0.5, {1.0}), 0.0) << "air to air";
}

}  // namespace
}  // namespace lucerna
