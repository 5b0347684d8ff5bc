// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/street.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {
namespace {

IntensityDistribution street_light(const std::function<double(double c_deg, double g_deg)>& cd,
                                   double c_step = 5.0) {
  IntensityDistribution d = uniform_distribution(c_step, 1.0);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) d.at(c, g) = cd(d.c_deg[c], d.gamma_deg[g]);
  }
  return d;
}

TEST(Street, ZonesOfAnEvenSourceAreTheirSolidAngles) {
  const auto d = street_light([](double, double) { return 100.0; });
  const LuminaireZones z = luminaire_zones(d, 90.0);
  const auto half = [](double from, double to) {
    return 100.0 * std::numbers::pi * (std::cos(radians(from)) - std::cos(radians(to)));
  };
  EXPECT_NEAR(z.front_low, half(0, 30), 1e-9);
  EXPECT_NEAR(z.back_medium, half(30, 60), 1e-9);
  EXPECT_NEAR(z.front_high, half(60, 80), 1e-9);
  EXPECT_NEAR(z.back_very_high, half(80, 90), 1e-9);
  EXPECT_NEAR(z.up_low, 2.0 * half(90, 100), 1e-9);
  EXPECT_NEAR(z.up_high, 2.0 * half(100, 180), 1e-9);
  EXPECT_NEAR(z.sum(), total_flux(d), 1e-9);
}

// Light goes to one side of the street: it is in front for the street side there, behind for the other, and
// the sum stays, also where the border lies between planes (30 degree steps, border at C5 and C185).
TEST(Street, FrontAndBackFollowTheStreetSide) {
  for (const double street : {0.0, 90.0, 95.0, 210.0}) {
    const auto d = street_light(
        [&](double c, double g) {
          return g < 85.0 ? 500.0 * std::max(0.0, std::cos(radians(c - street))) + 20.0 : 20.0;
        },
        30.0);
    const LuminaireZones here = luminaire_zones(d, street), there = luminaire_zones(d, street + 180.0);
    EXPECT_GT(here.front_medium, 5.0 * here.back_medium) << street;
    EXPECT_NEAR(here.front_medium, there.back_medium, 1e-9);
    EXPECT_NEAR(here.back_very_high, there.front_very_high, 1e-9);
    EXPECT_NEAR(here.sum(), total_flux(d), 1e-9 * total_flux(d));
    EXPECT_NEAR(here.up_low, there.up_low, 1e-12);
  }
  EXPECT_EQ(street_side_c_deg({.format = "IES LM-63-2002"}, IesTurn::none), 0.0);
  EXPECT_EQ(street_side_c_deg({.format = "IES LM-63-2002"}, IesTurn::minus_90), 90.0);
  EXPECT_EQ(street_side_c_deg({.format = "EULUMDAT"}, IesTurn::none), 90.0);
}

/// Flux `lm` in one zone alone, as even light in the middle of it (front: about C90).
IntensityDistribution only(double from, double to, bool front, double lm) {
  auto d = street_light([&](double c, double g) {
    const bool lit = (front ? 1.0 : -1.0) * std::sin(radians(c)) > 0.01;  // dark at C0 and C180
    return g > from && g < to && (from >= 90.0 || lit) ? 1.0 : 0.0;
  });
  scale(d, lm / total_flux(d));
  return d;
}

struct ZoneLimit {
  double from, to;
  bool front;
  std::array<double, 5> limits;
  int BugRating::*number;
};

// Each limit of the tables: just below it the rating is met, just above it the next begins. Rings and planes
// at the zones' borders are dark, so that no light leaks into the next one.
TEST(Street, EveryLimitOfTheBugTables) {
  const ZoneLimit zones[] = {{1, 29, false, {110, 500, 1000, 2500, 5000}, &BugRating::backlight},
                             {31, 59, false, {220, 1000, 2500, 5000, 8500}, &BugRating::backlight},
                             {61, 79, false, {110, 500, 1000, 2500, 5000}, &BugRating::backlight},
                             {61, 79, false, {110, 500, 1000, 2500, 5000}, &BugRating::glare},
                             {61, 79, true, {660, 1800, 5000, 7500, 12000}, &BugRating::glare},
                             {81, 89, true, {10, 100, 225, 500, 750}, &BugRating::glare},
                             {81, 89, false, {10, 100, 225, 500, 750}, &BugRating::glare},
                             {91, 99, true, {0, 10, 50, 500, 1000}, &BugRating::uplight},
                             {101, 179, true, {0, 10, 50, 500, 1000}, &BugRating::uplight}};
  for (const ZoneLimit& zone : zones) {
    for (int i = 0; i < 5; ++i) {
      const double limit = zone.limits[static_cast<std::size_t>(i)];
      SCOPED_TRACE(fmt::format("{} to {}, front {}, rating {}", zone.from, zone.to, zone.front, i));
      if (limit > 0.0) {
        EXPECT_EQ(bug_rating(only(zone.from, zone.to, zone.front, 0.999 * limit)).*zone.number, i);
      }
      EXPECT_EQ(bug_rating(only(zone.from, zone.to, zone.front, 1.001 * limit + 0.001)).*zone.number, i + 1);
    }
  }
  // Type V: 600 lm behind and high are G0, else G2.
  const auto back = only(61, 79, false, 600.0);
  EXPECT_EQ(bug_rating(back, {.type_v = true}).glare, 0);
  EXPECT_EQ(bug_rating(back).glare, 2);
  EXPECT_EQ(bug_rating(back).text(), "B2-U0-G2");
}

TEST(Street, ThresholdTurnsNoiseIntoU0AndSaysSo) {
  auto d = only(31, 59, true, 5000.0);
  for (std::size_t i = 0; i < d.cd.size(); ++i) d.cd[i] += 0.05;  // 0.3 lm up
  const BugRating strict = bug_rating(d), tolerant = bug_rating(d, {.dark_below_lm = 0.5});
  EXPECT_EQ(strict.uplight, 1);
  EXPECT_FALSE(strict.threshold_used);
  EXPECT_EQ(tolerant.uplight, 0);
  EXPECT_TRUE(tolerant.threshold_used);
  EXPECT_NEAR(tolerant.zones.up_low + tolerant.zones.up_high, 0.05 * 2.0 * std::numbers::pi, 1e-6);
  EXPECT_FALSE(bug_rating(d, {.dark_below_lm = 0.01}).threshold_used);
}

/// cd/klm `at` 70, 80, 90 degrees, falling in between, on top of light below 60 degrees that makes 1000 lm.
IntensityDistribution glaring(double at_70, double at_80, double at_90, double beyond) {
  auto d = street_light([](double, double g) { return g < 60.0 ? 1.0 : 0.0; });
  const double rest = 1000.0 / total_flux(d);
  return street_light([=](double c, double g) {
    if (g < 60.0) return rest;
    const double here = c == 40.0 ? 1.0 : 0.0;  // one plane only: the flux stays within a few percent
    if (g < 70.0) return 0.0;
    if (g < 80.0) return here * at_70;
    if (g < 90.0) return here * at_80;
    return here * (g <= 95.0 ? at_90 : beyond);
  });
}

TEST(Street, GlareClassesOfEn13201) {
  EXPECT_EQ(glare_class(glaring(900, 190, 40, 30)).number, 1);
  EXPECT_EQ(glare_class(glaring(900, 145, 25, 20)).number, 2);
  EXPECT_EQ(glare_class(glaring(900, 95, 15, 10)).number, 3);
  EXPECT_EQ(glare_class(glaring(450, 95, 8, 0)).number, 4);
  EXPECT_EQ(glare_class(glaring(450, 95, 8, 1)).number, 3);  // light beyond 95 degrees
  EXPECT_EQ(glare_class(glaring(330, 95, 8, 0)).number, 5);
  EXPECT_EQ(glare_class(glaring(330, 95, 0, 0)).number, 6);
  EXPECT_EQ(glare_class(glaring(330, 300, 0, 0)).number, 0);
  EXPECT_EQ(glare_class(glaring(330, 300, 0, 0)).text(), "none");
  const GlareClass noisy = glare_class(glaring(330, 95, 0.2, 0.1), 0.5);
  EXPECT_EQ(noisy.text(), "G*6");
  EXPECT_TRUE(noisy.threshold_used);
  EXPECT_NEAR(noisy.from_80, 95.0, 5.0);
  EXPECT_GT(noisy.from_90, 0.1);
}

TEST(Street, RefusesWhatItIsNotDefinedFor) {
  auto d = street_light([](double, double) { return 1.0; });
  EXPECT_THROW(bug_rating(d, {.dark_below_lm = -1.0}), InputError);
  EXPECT_THROW(glare_class(d, std::nan("")), InputError);
  EXPECT_THROW(glare_class(uniform_distribution(90.0, 10.0)), InputError);
  EXPECT_THROW(luminaire_zones(d, std::nan("")), InputError);
  d.unit = FluxUnit::watt;
  EXPECT_THROW(bug_rating(d), InputError);
  EXPECT_THROW(glare_class(d), InputError);
}

}  // namespace
}  // namespace lucerna
