// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/zone_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "lucerna/design/validation/validation.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

using testing::HasSubstr;

constexpr double kFlux = 100.0;

/// One zone of cells of 10 x 10 mm in a row, with bounds.
ZoneCells lane(std::vector<ZoneBound> bounds) {
  return {
      {{"lane", ZoneCoordinates::plane, {-5, 5}, {0, 40}, 10.0, std::move(bounds)}}, Direction(), Frame()};
}

/// Replicates whose illuminances are `lx`, with noise of `relative` (standard error of their mean).
std::vector<BoxSums> light(const ZoneCells& cells, const std::vector<double>& lx, double relative) {
  std::vector<BoxSums> out(16);
  for (std::size_t r = 0; r < out.size(); ++r) {
    out[r].emitted = 1.0;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      // +-d alternately has the standard error d / sqrt(15).
      const double off = (r % 2 == 0 ? 1.0 : -1.0) * relative * std::sqrt(15.0);
      out[r].zones.push_back(lx[c] * (1.0 + off) * cells.cells()[c].measure * 1e-6 / kFlux);
      out[r].zones_direct.push_back(0.0);
    }
  }
  return out;
}

ZoneCheck check(const ZoneBound& bound, const std::vector<double>& lx, double relative) {
  const ZoneCells cells = lane({bound});
  return check_zones(cells, light(cells, lx, relative), kFlux).front();
}

TEST(ZoneCheck, FindsTheExtremesAndWhatIsMissing) {
  const ZoneCheck z = check({"min_lx", true, 10.0}, {12, 20, 8, 16}, 0.01);
  EXPECT_EQ(z.cells, 4u);
  EXPECT_NEAR(z.min.mean, 8.0, 1e-9);
  EXPECT_NEAR(z.max.mean, 20.0, 1e-9);
  EXPECT_NEAR(z.mean.mean, 14.0, 1e-9);
  EXPECT_NEAR(z.min.standard_error, 0.08, 1e-9);
  EXPECT_NEAR(z.bounds[0].missing, 0.2, 1e-9);
  EXPECT_NEAR(z.bounds[0].found.mean, 8.0, 1e-9);
  EXPECT_EQ(z.bounds[0].place, "x 25, y 0 mm");
  EXPECT_EQ(z.verdict(), ZoneVerdict::missed);
}

TEST(ZoneCheck, DecidesOnlyBeyondTheNoise) {
  const auto verdict = [](double min, double relative) {
    return check({"min_lx", true, 10.0}, {12, 20, min, 16}, relative).verdict();
  };
  EXPECT_EQ(verdict(10.5, 0.01), ZoneVerdict::met);  // 4.8 errors
  EXPECT_EQ(verdict(10.3, 0.01), ZoneVerdict::undetermined);
  EXPECT_EQ(verdict(9.7, 0.01), ZoneVerdict::undetermined);
  EXPECT_EQ(verdict(9.5, 0.01), ZoneVerdict::missed);
  EXPECT_EQ(verdict(10.3, 0.001), ZoneVerdict::met);
  EXPECT_EQ(check({"max_lx", false, 21.0}, {12, 20, 8, 16}, 0.001).verdict(), ZoneVerdict::met);
  EXPECT_EQ(check({"max_lx", false, 19.0}, {12, 20, 8, 16}, 0.001).verdict(), ZoneVerdict::missed);
}

TEST(ZoneCheck, UniformityIsOfTheMeanAndOfTheBrightest) {
  const std::vector<double> lx{12, 20, 8, 16};  // 8 / 14 and 8 / 20
  const ZoneCheck uo = check({"min_uo", true, 0.55, ZoneReference::mean, 0}, lx, 1e-4);
  EXPECT_EQ(uo.verdict(), ZoneVerdict::met);
  EXPECT_NEAR(uo.bounds[0].found.mean, 8.0 / 14.0, 1e-6);
  EXPECT_EQ(check({"min_uo", true, 0.6, ZoneReference::mean, 0}, lx, 1e-4).verdict(), ZoneVerdict::missed);
  const ZoneCheck ul = check({"min_ul", true, 0.38, ZoneReference::brightest}, lx, 1e-4);
  EXPECT_EQ(ul.verdict(), ZoneVerdict::met);
  EXPECT_NEAR(ul.bounds[0].found.mean, 0.4, 1e-6);
  EXPECT_EQ(check({"min_ul", true, 0.42, ZoneReference::brightest}, lx, 1e-4).verdict(), ZoneVerdict::missed);
}

TEST(ZoneCheck, TheHeadlineNamesWhatIsMissed) {
  const ZoneCells cells = lane({{"min_lx", true, 10.0}, {"max_lx", false, 30.0}});
  const std::vector<ZoneCheck> zones = check_zones(cells, light(cells, {12, 20, 8, 16}, 0.001), kFlux);
  EXPECT_THAT(zones_headline(zones),
              HasSubstr("0 of 1 zones met; missed: lane (min_lx: 8.000 +- 0.008 found at x 25"));
  EXPECT_NEAR(missing_in_zones(zones), 0.2, 1e-9);
  EXPECT_FALSE(any_undetermined(zones));
}

TEST(ZoneCheck, DirectLightAloneMayBreakAnUpperBound) {
  const ZoneCells cells = lane({{"max_lx", false, 10.0}, {"min_lx", true, 1.0}});
  const auto bounds = [&](double direct_share, double relative) {
    std::vector<BoxSums> sums = light(cells, {12, 20, 8, 16}, relative);
    for (BoxSums& r : sums) {
      r.zones_direct = r.zones;
      for (double& flux : r.zones_direct) flux *= direct_share;
    }
    return check_zones(cells, sums, kFlux).front().bounds;
  };
  const auto most = bounds(0.6, 0.01);
  ASSERT_TRUE(most[0].direct);
  EXPECT_NEAR(most[0].direct->mean, 12.0, 1e-9);
  EXPECT_NEAR(most[0].direct->standard_error, 0.12, 1e-9);
  EXPECT_TRUE(most[0].broken_by_direct);
  EXPECT_FALSE(most[1].direct) << "a lower bound has no use of it";
  EXPECT_FALSE(bounds(0.45, 0.01)[0].broken_by_direct) << "the mirror's light is the rest";
  EXPECT_FALSE(bounds(0.51, 0.01)[0].broken_by_direct) << "10.2 +- 0.1 is not clear";
}

TEST(ZoneCheck, AnUnlitReferenceIsNotMet) {
  EXPECT_NE(check({"min_uo", true, 0.5, ZoneReference::mean, 0}, {0, 0, 0, 0}, 0.001).verdict(),
            ZoneVerdict::met);
}

/// A Lambertian disk alone: I = flux / pi * cos. Every cell's mean is known; 4.5 standard errors of 16
/// replicates (t, 15 degrees of freedom) are passed by one of 800 cells in 5 runs; a wrong solid angle of 3 %
/// is ten errors.
TEST(ZoneCheckStatistical, ValidationSeesTheLightOfALambertianDisk) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 0.5;
  options.flux = 1000.0;
  Scene scene;
  scene.sources.push_back({make_emitter(options), Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), {}});
  const ZoneCells cells({{"g", ZoneCoordinates::gamma_c, {0, 60}, {0, 360}, 15.0, {{"min_cd", true, 100.0}}},
                         {"h", ZoneCoordinates::h_v, {-20, 20}, {-20, 20}, 10.0, {{"min_cd", true, 250.0}}}},
                        Direction::from({0, 0, -1}), std::nullopt);
  const IntensityDistribution target = [] {
    IntensityDistribution d = uniform_distribution(0.0, 10.0);
    for (std::size_t g = 0; g < 9; ++g) d.at(0, g) = std::cos(radians(10.0 * static_cast<double>(g)));
    return d;
  }();
  const ErrorBoxes boxes(target_rectangle(target));
  ValidationOptions o;
  o.min_rays = o.max_rays = std::uint64_t{1} << 18;
  o.engine = HitEngine::tree;
  o.zones = &cells;
  const Validation v = validate(scene, boxes, boxes.flux_of(target), TargetMode::shape, o);
  ASSERT_EQ(v.zones.size(), 2u);
  EXPECT_EQ(v.zones[0].verdict(), ZoneVerdict::met);
  for (const BoxSums& r : v.replicates) EXPECT_EQ(r.zones, r.zones_direct) << "there is no mirror";
  for (std::size_t c = 0; c < cells.size(); ++c) {
    double truth = 0.0, sum = 0.0, square = 0.0;
    for (int i = 0; i < 400; ++i) {
      const Ray ray = cells.ray_into(cells.cells()[c], (i / 20 + 0.5) / 20.0, (i % 20 + 0.5) / 20.0);
      const double weight = cells.cells()[c].zone == 0
                                ? std::hypot(ray.direction.x(), ray.direction.y())
                                : std::sqrt(1.0 - ray.direction.y() * ray.direction.y());
      truth += weight * -ray.direction.z();
      sum += weight;
    }
    truth *= 1000.0 / std::numbers::pi / sum;
    std::vector<double> cd;
    for (const BoxSums& r : v.replicates)
      cd.push_back(1000.0 * r.zones[c] / r.emitted / cells.cells()[c].measure);
    sum = 0.0;
    for (const double x : cd) sum += x / 16.0;
    for (const double x : cd) square += (x - sum) * (x - sum);
    EXPECT_NEAR(sum, truth, 1e-3 * truth + 4.5 * std::sqrt(square / 240.0))
        << cells.place_text(cells.cells()[c]);
  }
}

}  // namespace
}  // namespace lucerna
