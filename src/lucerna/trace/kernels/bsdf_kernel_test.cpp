// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/bsdf_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/scatter.h"
#include "lucerna/trace/kernels/measured_scatter.h"
#include "lucerna/trace/kernels/scatter_kernel.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

/// A lobe about the mirrored direction that is wider towards the normal, and wider still on one side.
BsdfTable lobe_table(double end_deg, double width_deg) {
  BsdfTable t;
  t.incidence_deg = {10.0, 35.0, 60.0};
  for (double a = 0.0; a <= end_deg; a += 30.0) t.azimuth_deg.push_back(a);
  t.radial_deg = {0.0, 4.0, 9.0, 15.0, 25.0, 40.0, 70.0, 120.0};
  for (const double incidence : t.incidence_deg) {
    for (const double azimuth : t.azimuth_deg) {
      const double wide =
          width_deg * (1.0 + 0.4 * std::cos(radians(azimuth)) + 0.2 * std::sin(radians(azimuth)));
      for (const double radial : t.radial_deg)
        t.brdf.push_back(0.1 + (1.0 + incidence / 60.0) * std::exp(-radial * radial / (2.0 * wide * wide)));
    }
    t.total.push_back(0.8);
  }
  return t;
}

/// The same lobe at all azimuths, by angles about the mirrored direction or about the normal.
BsdfTable round_lobe(bool about_normal) {
  BsdfTable t;
  t.is_about_normal = about_normal;
  t.incidence_deg = {0.0, 20.0, 50.0};
  for (double a = 0.0; a <= 180.0; a += 4.0) t.azimuth_deg.push_back(a);
  for (double r = 0.0; r <= (about_normal ? 90.0 : 150.0); r += 2.0) t.radial_deg.push_back(r);
  for (const double incidence : t.incidence_deg) {
    const double tilt = radians(incidence);
    for (const double azimuth : t.azimuth_deg) {
      for (const double radial : t.radial_deg) {
        const double r = radians(radial), a = radians(azimuth);
        const double to_mirrored = std::cos(r) * std::cos(tilt) + std::sin(r) * std::cos(a) * std::sin(tilt);
        const double off = about_normal ? std::acos(std::clamp(to_mirrored, -1.0, 1.0)) : r;
        t.brdf.push_back(0.1 + std::exp(-off * off / (2.0 * 0.3 * 0.3)));
      }
    }
    t.total.push_back(0.8);
  }
  return t;
}

Direction bsdf_mirrored(double incidence_deg) {
  return Direction::from({std::sin(radians(incidence_deg)), 0.0, std::cos(radians(incidence_deg))});
}
Direction bsdf_light(double incidence_deg) {
  return Direction::from({-std::sin(radians(incidence_deg)), 0.0, std::cos(radians(incidence_deg))});
}

/// Squares of the two cosines along the surface, and last all of what is near the horizon.
constexpr int kSide = 16;
constexpr double kRim = 0.9;
std::size_t square_of(double x, double y) {
  if (x * x + y * y > kRim) return std::size_t{kSide} * kSide;
  const auto place = [](double v) {
    return std::clamp(static_cast<int>((v + 1.0) * 0.5 * kSide), 0, kSide - 1);
  };
  return static_cast<std::size_t>(place(y) * kSide + place(x));
}

/// Counts that `scatter` states for n directions: the BRDF is a density over the cosines.
std::vector<double> stated_counts(const Scatter& scatter, double incidence_deg, double n) {
  constexpr int kFine = 800;
  std::vector<double> out(kSide * kSide + 1, 0.0);
  for (int i = 0; i < kFine * kFine; ++i) {
    const double x = (2.0 * (i % kFine) + 1.0) / kFine - 1.0, y = (2.0 * (i / kFine) + 1.0) / kFine - 1.0;
    if (x * x + y * y > kRim) continue;
    const Direction to_eye = Direction::from_unit({x, y, std::sqrt(1.0 - x * x - y * y)});
    out[square_of(x, y)] +=
        n * scatter.brdf(Direction{}, bsdf_light(incidence_deg), to_eye) * 4.0 / (kFine * kFine);
  }
  double all = 0.0;
  for (const double c : out) all += c;
  out.back() = n - all;
  return out;
}

std::vector<double> drawn_counts(const Scatter& scatter, double incidence_deg, std::uint64_t n) {
  SurfaceFinish finish;
  finish.measured = &scatter.measured()->view();
  std::vector<double> out(kSide * kSide + 1, 0.0);
  for (std::uint64_t i = 0; i < n; ++i) {
    const Direction d = scattered(finish, Direction{}, bsdf_mirrored(incidence_deg), {7, i, 1});
    EXPECT_GE(d.z(), 0.0);
    out[square_of(d.x(), d.y())] += 1.0;
  }
  return out;
}

double bsdf_p_value(const BsdfTable& drawn, const BsdfTable& stated, double incidence_deg) {
  constexpr std::uint64_t kDraws = 200'000;
  return test::chi_square_p(drawn_counts(Scatter(drawn), incidence_deg, kDraws),
                            stated_counts(Scatter(stated), incidence_deg, static_cast<double>(kDraws)));
}

// At, between and beyond the table's incidences. False alarm 1e-6 each; 200 000 draws see cells that are 3 %
// off.
TEST(BsdfStatistical, DirectionsFollowTheTable) {
  for (const double end_deg : {180.0, 360.0}) {
    const BsdfTable table = lobe_table(end_deg, 12.0);
    for (const double incidence_deg : {0.0, 35.0, 50.0, 80.0})
      EXPECT_GT(bsdf_p_value(table, table, incidence_deg), test::kFalseAlarm)
          << end_deg << ' ' << incidence_deg;
  }
}

// As LightTools has tables. False alarm 1e-6 each.
TEST(BsdfStatistical, DirectionsFollowATableAboutTheNormal) {
  const BsdfTable table = round_lobe(true);
  for (const double incidence_deg : {0.0, 20.0, 40.0, 70.0})
    EXPECT_GT(bsdf_p_value(table, table, incidence_deg), test::kFalseAlarm) << incidence_deg;
  BsdfTable other = table;
  other.is_about_normal = false;
  EXPECT_LT(bsdf_p_value(other, table, 20.0), test::kFalseAlarm) << "taken for Zemax's angles";
}

// One lobe in the angles of either maker: the same light, between the incidences of the tables too.
TEST(Bsdf, AnglesAboutTheNormalAreTheSameSurface) {
  const Scatter about_normal(round_lobe(true)), about_mirrored(round_lobe(false));
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(about_normal.integrals()[i], about_mirrored.integrals()[i],
                2e-3 * about_mirrored.integrals()[i]);
  for (const double incidence_deg : {0.0, 20.0, 35.0, 50.0}) {
    for (const double to_deg : {-40.0, 0.0, 20.0, 45.0, 60.0}) {
      const Direction to = Direction::from(bsdf_mirrored(to_deg).vec() + Vec3{0.0, 0.2, 0.0});
      const double expected = about_mirrored.brdf(Direction{}, bsdf_light(incidence_deg), to);
      EXPECT_NEAR(about_normal.brdf(Direction{}, bsdf_light(incidence_deg), to), expected, 0.02 * expected)
          << incidence_deg << ' ' << to_deg;
    }
  }
}

TEST(BsdfStatistical, AWrongTableIsRejected) {
  const BsdfTable table = lobe_table(360.0, 12.0);
  EXPECT_LT(bsdf_p_value(lobe_table(360.0, 12.4), table, 35.0), test::kFalseAlarm) << "3 % too wide";
  EXPECT_LT(bsdf_p_value(lobe_table(180.0, 12.0), table, 35.0), test::kFalseAlarm) << "one side for both";
}

// What is as bright from all sides is Lambert's law: 1 / pi over the reflectance, wherever it is looked at.
TEST(Bsdf, AnEvenTableIsLambertsLaw) {
  BsdfTable t;
  t.incidence_deg = {0.0, 30.0};
  t.azimuth_deg = {0.0, 90.0, 180.0};
  for (double r = 0.0; r <= 180.0; r += 2.0) t.radial_deg.push_back(r);
  t.brdf.assign(t.incidence_deg.size() * t.azimuth_deg.size() * t.radial_deg.size(), 0.2);
  t.total = {0.6, 0.6};
  const Scatter scatter(t);
  for (const double found : scatter.integrals()) EXPECT_NEAR(found, 0.2 * std::numbers::pi, 2e-3);
  for (const double incidence_deg : {0.0, 30.0}) {
    for (const double to_deg : {-70.0, -10.0, 45.0})
      EXPECT_NEAR(scatter.brdf(Direction{}, bsdf_light(incidence_deg), bsdf_mirrored(to_deg)),
                  1.0 / std::numbers::pi, 3e-3);
  }
  EXPECT_FALSE(scatter.empty());
  EXPECT_EQ(scatter.total(0.5), 1.0);
}

/// The mean of what is drawn: along the plane of incidence, across, up; and the share below 10 degrees of
/// elevation.
std::array<double, 4> mean_of_draws(const BsdfTable& table, double incidence_deg) {
  const Scatter scatter(table);
  SurfaceFinish finish;
  finish.measured = &scatter.measured()->view();
  constexpr std::uint64_t kDraws = 100'000;
  std::array<double, 4> out{};
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const Direction d = scattered(finish, Direction{}, bsdf_mirrored(incidence_deg), {3, i, 1});
    const double low = d.z() < std::sin(radians(10.0)) ? 1.0 : 0.0;
    for (const auto& [k, value] : {std::pair{0U, d.x()}, {1U, d.y()}, {2U, d.z()}, {3U, low}})
      out[k] += value / static_cast<double>(kDraws);
  }
  return out;
}

// A table of one incidence that is as bright from all sides is so for light from anywhere: the mean direction
// of Lambert's law is (0, 0, 2/3), and sin^2(10 degrees) of the light is below 10 degrees. False alarm 1e-6
// each (4.9 sigma of 1.6e-3 and 5.4e-4); a table that turns with the mirrored direction has 0.5 along at 50
// degrees.
TEST(BsdfStatistical, AnEvenTableIsLambertsLawBeyondItsIncidences) {
  for (const bool about_normal : {true, false}) {
    BsdfTable t;
    t.is_about_normal = about_normal;
    t.incidence_deg = {0.0};
    t.azimuth_deg = {0.0, 90.0, 180.0};
    for (double r = 0.0; r <= 90.0; r += 2.0) t.radial_deg.push_back(r);
    t.brdf.assign(t.azimuth_deg.size() * t.radial_deg.size(), 0.25);
    t.total = {0.8};
    for (const double incidence_deg : {0.0, 50.0, 85.0}) {
      const auto mean = mean_of_draws(t, incidence_deg);
      EXPECT_NEAR(mean[0], 0.0, 0.008) << incidence_deg;
      EXPECT_NEAR(mean[1], 0.0, 0.008);
      EXPECT_NEAR(mean[2], 2.0 / 3.0, 0.004);
      EXPECT_NEAR(mean[3], 0.0302, 0.0027);
      EXPECT_NEAR(Scatter(t).brdf(Direction{}, bsdf_light(incidence_deg), bsdf_mirrored(30.0)),
                  1.0 / std::numbers::pi, 3e-3);
    }
  }
}

// The peak of a lobe goes where a mirror sends the light, also between the incidences of its table.
TEST(Bsdf, PeaksFollowTheMirroredDirection) {
  for (const bool about_normal : {true, false}) {
    const Scatter scatter(round_lobe(about_normal));
    for (const double incidence_deg : {10.0, 35.0, 60.0}) {
      double best = 0.0, at_deg = 0.0;
      for (double to_deg = -80.0; to_deg <= 80.0; to_deg += 1.0) {
        const double found = scatter.brdf(Direction{}, bsdf_light(incidence_deg), bsdf_mirrored(to_deg));
        if (found > best) best = found, at_deg = to_deg;
      }
      EXPECT_NEAR(at_deg, incidence_deg, 2.0) << about_normal;
    }
  }
}

TEST(Bsdf, AzimuthNoughtLeadsToTheNormal) {
  BsdfTable t = lobe_table(180.0, 12.0);
  const Scatter scatter(t);
  // At 60 degrees the lobe is wider towards the normal.
  EXPECT_GT(scatter.brdf(Direction{}, bsdf_light(60.0), bsdf_mirrored(35.0)),
            2.0 * scatter.brdf(Direction{}, bsdf_light(60.0), bsdf_mirrored(84.0)));
}

TEST(Bsdf, RefusesTablesThatCannotBeDrawnFrom) {
  BsdfTable t = lobe_table(180.0, 12.0);
  std::fill(t.brdf.begin(), t.brdf.begin() + static_cast<std::ptrdiff_t>(t.row(1, 0)), 0.0);
  EXPECT_THROW(Scatter{t}, InputError);
  t = lobe_table(180.0, 12.0);
  t.brdf.pop_back();
  EXPECT_THROW(Scatter{t}, InputError);
  EXPECT_THROW(Scatter{BsdfTable()}, InputError);
  t = lobe_table(180.0, 12.0);
  t.is_about_normal = true;
  EXPECT_THROW(Scatter{t}, InputError) << "120 degrees from the normal";
  t = lobe_table(180.0, 12.0);
  std::swap(t.radial_deg[1], t.radial_deg[2]);
  EXPECT_THROW(Scatter{t}, InputError);
}

}  // namespace
}  // namespace lucerna
