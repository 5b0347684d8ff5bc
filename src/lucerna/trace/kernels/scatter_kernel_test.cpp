// SPDX-License-Identifier: Apache-2.0
// Lobes and the directions that they draw: each against the other.
#include "lucerna/trace/kernels/scatter_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lucerna/error.h"
#include "lucerna/random.h"
#include "lucerna/scatter.h"
#include "tests/support/random_direction.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

constexpr double kPi = std::numbers::pi;

/// Lobes of every kind, narrow and wide, with light tails and heavy ones.
std::vector<ScatterLobe> lobes() {
  return {lambert_lobe(0.9),         gaussian_lobe(0.8, 0.02),   gaussian_lobe(0.7, 0.5),
          abg_lobe(0.02, 1e-4, 2.0), abg_lobe(0.005, 0.01, 1.3), abg_lobe(2e-4, 1e-6, 3.0),
          abg_lobe(0.1, 0.5, 0.5)};
}

Direction incident(double deg) {
  return Direction::from({std::sin(radians(deg)), 0.0, std::cos(radians(deg))});
}
Direction mirrored(const Direction& to_light) {
  return Direction::from({-to_light.x(), -to_light.y(), to_light.z()});
}

TEST(Scatter, IsTheSameWithLightAndEyeExchanged) {
  const Direction normal = Direction::from({0.3, -0.2, 0.9});
  Rng rng(1, 0);
  for (const ScatterLobe& lobe : lobes()) {
    const Scatter scatter({lobe});
    for (int i = 0; i < 1000; ++i) {
      const Direction a = test::random_direction(rng), b = test::random_direction(rng);
      const double there = scatter.brdf(normal, a, b);
      EXPECT_NEAR(there, scatter.brdf(normal, b, a), 1e-12 * there);
      const bool both_above = dot(a, normal) > 0.0 && dot(b, normal) > 0.0;
      if (!both_above) {
        EXPECT_EQ(there, 0.0);
      }
    }
  }
}

// The integral over the hemisphere, by cosines along the surface.
TEST(Scatter, TotalIsTheIntegralOfTheBrdf) {
  for (const ScatterLobe& lobe : lobes()) {
    if (lobe.kind == ScatterKind::gaussian && lobe.sigma < 0.1) continue;  // too sharp for this grid
    if (lobe.kind == ScatterKind::abg && lobe.b < 1e-3) continue;
    const Scatter scatter({lobe, lambert_lobe(0.05)});
    for (const double deg : {0.0, 40.0, 80.0}) {
      constexpr int kSide = 1000;
      double sum = 0.0;
      for (int i = 0; i < kSide * kSide; ++i) {
        const double x = (2.0 * (i % kSide) + 1.0) / kSide - 1.0, y = (2.0 * (i / kSide) + 1.0) / kSide - 1.0;
        const double z2 = 1.0 - x * x - y * y;
        if (z2 > 0.0) sum += scatter.brdf(Direction{}, incident(deg), Direction::from({x, y, std::sqrt(z2)}));
      }
      EXPECT_NEAR(scatter.total(std::cos(radians(deg))), sum * 4.0 / (kSide * kSide), 2e-3) << deg;
    }
  }
}

TEST(Scatter, ShareOfAbgInClosedForm) {
  EXPECT_NEAR(abg_lobe(0.02, 1e-4, 2.0).share, kPi * 0.02 * std::log(1.0 + 4.0 / 1e-4), 1e-6);
  const ScatterLobe lobe = abg_lobe(0.005, 1e-3, 4.0);  // 1 / (b + d^4): arc tangent
  EXPECT_NEAR(lobe.share, kPi * 0.005 / std::sqrt(1e-3) * std::atan(4.0 / std::sqrt(1e-3)), 1e-6);
}

TEST(Scatter, NarrowLobesScatterAsMuchAsTheirShareAndLessWhenGrazing) {
  const Scatter narrow({gaussian_lobe(0.3, 0.01)});
  EXPECT_NEAR(narrow.total(1.0), 0.3, 1e-6);
  EXPECT_NEAR(narrow.total(std::cos(radians(60.0))), 0.3, 1e-6);
  EXPECT_LT(narrow.total(0.001), 0.16);
  EXPECT_EQ(Scatter().total(0.5), 0.0);
}

TEST(Scatter, RefusesWhatIsNoLobe) {
  EXPECT_THROW((void)lambert_lobe(0.0), InputError);
  EXPECT_THROW((void)lambert_lobe(1.1), InputError);
  EXPECT_THROW((void)gaussian_lobe(0.5, 0.0), InputError);
  EXPECT_THROW((void)gaussian_lobe(0.5, 1.5), InputError);
  EXPECT_THROW((void)gaussian_lobe(0.5, std::nan("")), InputError);
  EXPECT_THROW((void)abg_lobe(0.0, 1e-3, 2.0), InputError);
  EXPECT_THROW((void)abg_lobe(0.01, 0.0, 2.0), InputError);
  EXPECT_THROW((void)abg_lobe(0.01, 1e-3, 20.0), InputError);
  EXPECT_THROW((void)abg_lobe(1.0, 1e-6, 2.0), InputError) << "it scatters more than there is";
  EXPECT_THROW(Scatter({lambert_lobe(0.6), gaussian_lobe(0.5, 0.1)}), InputError);
}

/// Density of offsets from the BRDF: where light and eye are both half of one aside. Over the plane of
/// cosines.
double density(const Scatter& scatter, double offset) {
  const double half = 0.5 * offset;
  const Direction aside = Direction::from({half, 0.0, std::sqrt(1.0 - half * half)});
  return scatter.brdf(Direction{}, aside, aside);
}

/// Cells: shells of about equal probability of the offset by sectors of its angle, and last what is mirrored.
class OffsetCells {
 public:
  OffsetCells(const ScatterLobe& lobe, double incidence_deg) : expected_(kShells * kSectors + 1, 0.0) {
    const Scatter scatter({lobe});
    constexpr int kSteps = 20000;
    const double low = 1e-6, ratio = std::pow(kLargestScatterOffset / low, 1.0 / kSteps);
    double from = 0.0, to = low, sum = 0.0;
    for (int i = 0; i < kSteps; ++i, from = to, to *= ratio) {
      const double middle = 0.5 * (from + to);
      const double ring = density(scatter, middle) * kPi * (to * to - from * from);
      sum += ring / lobe.share;
      if (sum * kShells > static_cast<double>(ends_.size() + 1) && ends_.size() + 1 < kShells)
        ends_.push_back(to);
      add_ring(std::sin(radians(incidence_deg)), middle, ring);
    }
  }

  std::size_t cell(const Direction& mirror, const Direction& out) const {
    const double x = out.x() - mirror.x(), y = out.y() - mirror.y(), d = std::hypot(x, y);
    if (d < 1e-15) return kShells * kSectors;
    return shell(d) * kSectors + sector(std::atan2(y, x));
  }
  std::vector<double> expected(double n) const {
    std::vector<double> counts = expected_;
    counts.back() = 1.0;
    for (std::size_t k = 0; k + 1 < counts.size(); ++k) counts.back() -= counts[k];
    for (double& c : counts) c *= n;
    return counts;
  }

 private:
  static constexpr std::size_t kShells = 24, kSectors = 8;
  std::size_t shell(double offset) const {
    return static_cast<std::size_t>(std::lower_bound(ends_.begin(), ends_.end(), offset) - ends_.begin());
  }
  static std::size_t sector(double angle) {
    return std::min(static_cast<std::size_t>((angle / (2.0 * kPi) + 0.5) * kSectors), kSectors - 1);
  }
  /// Shares a ring of probability out to the sectors, but for what is below the horizon.
  void add_ring(double mirrored_x, double offset, double ring) {
    constexpr int kAround = 80 * static_cast<int>(kSectors);
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2.0 * kPi * ((k + 0.5) / kAround - 0.5);
      const double x = -mirrored_x + offset * std::cos(angle), y = offset * std::sin(angle);
      if (x * x + y * y < 1.0) expected_[shell(offset) * kSectors + sector(angle)] += ring / kAround;
    }
  }

  std::vector<double> ends_, expected_;
};

/// p-value of 200 000 directions that a lobe draws, against the cells of another.
double p_value(const ScatterLobe& drawn, const ScatterLobe& expected, double incidence_deg) {
  const OffsetCells cells(expected, incidence_deg);
  const Direction mirror = mirrored(incident(incidence_deg));
  constexpr std::uint64_t kDraws = 200'000;
  std::vector<double> counts = cells.expected(0.0);
  for (std::uint64_t i = 0; i < kDraws; ++i)
    counts[cells.cell(mirror, scattered({0.0, &drawn, 1}, Direction{}, mirror, {7, i, 1}))] += 1.0;
  return test::chi_square_p(counts, cells.expected(static_cast<double>(kDraws)));
}

// False alarm 1e-6 a lobe and angle; 200 000 draws see cells that are 3 % off (test::seen_deviation).
TEST(ScatterStatistical, DirectionsFollowTheBrdf) {
  for (const ScatterLobe& lobe : lobes()) {
    if (lobe.kind == ScatterKind::lambert) continue;
    for (const double deg : {0.0, 50.0, 85.0}) {
      EXPECT_GT(p_value(lobe, lobe, deg), test::kFalseAlarm)
          << static_cast<int>(lobe.kind) << " " << lobe.sigma << " " << lobe.b << " " << lobe.g << " at "
          << deg;
    }
  }
}

TEST(ScatterStatistical, AWrongSamplerIsRejected) {
  const auto rejected = [](const ScatterLobe& drawn, const ScatterLobe& expected) {
    return p_value(drawn, expected, 50.0) < test::kFalseAlarm;
  };
  ScatterLobe lobe = gaussian_lobe(0.8, 0.02);
  EXPECT_TRUE(rejected(gaussian_lobe(0.8, 0.0206), lobe)) << "3 % too wide";
  EXPECT_TRUE(rejected(gaussian_lobe(0.816, 0.02), lobe)) << "2 % too much";
  lobe = abg_lobe(0.02, 1e-4, 2.0);
  ScatterLobe wrong = lobe;
  wrong.g = 2.1;
  EXPECT_TRUE(rejected(wrong, lobe));
  wrong = lobe;
  wrong.b = 1.3e-4;
  EXPECT_TRUE(rejected(wrong, lobe));
}

// Lambert's law is even in the cosines along the surface, whatever the incidence.
TEST(ScatterStatistical, LambertIsEvenInTheCosines) {
  const ScatterLobe lobe = lambert_lobe(1.0);
  const Direction normal = Direction::from({1.0, 2.0, 3.0}), mirror = Direction::from({1.0, 2.0, 1.0});
  std::vector<double> counts(20);
  for (std::uint64_t i = 0; i < 100'000; ++i) {
    const double z = dot(normal, scattered({0.0, &lobe, 1}, normal, mirror, {3, i, 0}));
    counts[std::min<std::size_t>(static_cast<std::size_t>((1.0 - z * z) * 20.0), 19)] += 1.0;
  }
  EXPECT_GT(test::chi_square_uniform_p(counts), test::kFalseAlarm);
}

/// Of light at 60 degrees, what a gloss meter's receptor takes: by angles from the mirrored direction.
double received(const Scatter& scatter) {
  const Direction mirror = mirrored(incident(60.0));
  const auto& l = scatter.lobes();
  constexpr std::uint64_t kDraws = 400'000;
  std::uint64_t in = 0;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const Direction out =
        scattered({0.0, l.data(), static_cast<std::uint32_t>(l.size())}, Direction{}, mirror, {5, i, 0});
    const double along = degrees(std::atan2(-out.x(), out.z())) - 60.0, across = degrees(std::asin(out.y()));
    in += std::abs(along) < 2.2 && std::abs(across) < 5.85 ? 1 : 0;
  }
  return static_cast<double>(in) / kDraws;
}

TEST(ScatterStatistical, ADataSheetsSurfaceHasItsGloss) {
  for (const double gloss : {200.0, 300.0, 700.0}) {
    const Scatter scatter = scatter_of({.total = 0.87, .diffuse = 0.1, .gloss_60 = gloss});
    ASSERT_EQ(scatter.lobes().size(), 2u);
    EXPECT_NEAR(scatter.lobes()[0].share, 0.1 / 0.87, 1e-12);
    // 100 gloss units are 10 % of the light; the receptor is small, so cosines are nearly even in it.
    EXPECT_NEAR(0.87 * received(scatter), gloss * 1e-3, 0.02 * gloss * 1e-3 + 2e-3) << gloss;
  }
}

TEST(ScatterOfSheet, WithoutGlossTheRestIsMirrored) {
  const Scatter scatter = scatter_of({.total = 0.8, .diffuse = 0.2});
  ASSERT_EQ(scatter.lobes().size(), 1u);
  EXPECT_NEAR(scatter.total(1.0), 0.25, 1e-12);
  EXPECT_TRUE(scatter_of({.total = 0.95, .diffuse = 0.0}).empty());
  EXPECT_NEAR(scatter_of({.total = 0.8, .diffuse = 0.8}).total(1.0), 1.0, 1e-12);
}

TEST(ScatterOfSheet, RefusesWhatNoSurfaceHas) {
  EXPECT_THROW((void)scatter_of({.total = 1.2, .diffuse = 0.0}), InputError);
  EXPECT_THROW((void)scatter_of({.total = 0.5, .diffuse = 0.6}), InputError);
  EXPECT_THROW((void)scatter_of({.total = 0.8, .diffuse = 0.8, .gloss_60 = 5.0}), InputError);
  EXPECT_THROW((void)scatter_of({.total = 0.5, .diffuse = 0.1, .gloss_60 = 600.0}), InputError)
      << "more than is left";
  EXPECT_THROW((void)scatter_of({.total = 0.9, .diffuse = 0.1, .gloss_60 = 50.0}), InputError)
      << "wider than any lobe";
}

}  // namespace
}  // namespace lucerna
