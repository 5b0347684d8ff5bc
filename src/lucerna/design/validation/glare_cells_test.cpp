// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/glare_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/design/validation/validation.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

Vec3 tilted(double from_axis_deg, double about_deg) {
  const double t = radians(from_axis_deg), a = radians(about_deg);
  return {std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t)};
}

std::vector<double> light_in(const GlareCells& cells, const Vec3& direction) {
  std::vector<double> sums(cells.size(), 0.0);
  cells.add(direction, 2.0, sums);
  return sums;
}

double sum_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v;
  return sum;
}

TEST(GlareCells, BeginAtTheirAngleAndReachTheOtherPole) {
  const GlareCells cells(Frame(), 45.0);
  EXPECT_EQ(cells.size(), 25u * 12u + 9u + 3u) << "wider ones at the pole";
  EXPECT_EQ(sum_of(light_in(cells, tilted(44.999, 10))), 0.0);
  EXPECT_EQ(sum_of(light_in(cells, tilted(45.001, 10))), 2.0);
  EXPECT_EQ(light_in(cells, tilted(46, 10)), light_in(cells, tilted(49.9, 25)));
  EXPECT_NE(light_in(cells, tilted(46, 10)), light_in(cells, tilted(50.1, 10)));
  EXPECT_NE(light_in(cells, tilted(46, 10)), light_in(cells, tilted(46, 40)));
  EXPECT_EQ(sum_of(light_in(cells, {0, 0, -1})), 2.0);
  const GlareCells turned(Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 5}), 45.0);
  EXPECT_EQ(sum_of(light_in(turned, {0, 0, -1})), 0.0) << "along that mirror's axis";
  EXPECT_EQ(sum_of(light_in(turned, {0, 0, 1})), 2.0);
}

// A disk that shines away from the axis: the brightest cell is about the pole, where tents that end there
// would see half of it. The mean of a cosine over 5 degrees about the pole is (1 + cos 5 deg) / 2 of its
// top. The largest of three cells there is above it by one of their errors.
TEST(GlareCells, SeeTheLightAboutThePole) {
  Scene scene;
  scene.sources.push_back(
      {make_emitter({.kind = EmitterKind::disk, .radius_mm = 0.5}), Frame(), std::nullopt});
  const GlareCells cells(Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), 60.0);
  const ErrorBoxes boxes(target_rectangle([] {
    IntensityDistribution d = zero_distribution({0.0}, {0.0, 90.0, 180.0});
    d.cd = {0.0, 0.0, 1.0};
    return d;
  }()));
  ValidationOptions o;
  o.min_rays = o.max_rays = std::uint64_t{1} << 20;
  o.engine = HitEngine::tree;
  o.glare = &cells;
  const Validation v = validate(scene, boxes, std::vector<double>(boxes.size(), 1.0), TargetMode::shape, o);
  const Estimate found = cells.brightest(v.replicates);
  const double truth = 0.5 * (1.0 + std::cos(radians(5.0))) / std::numbers::pi;
  EXPECT_GT(found.standard_error, 0.0);
  EXPECT_LT(found.standard_error, 0.05 * truth);
  EXPECT_GT(found.mean, truth - 2.0 * found.standard_error);
  EXPECT_LT(found.mean, truth + 6.0 * found.standard_error);
  EXPECT_EQ(cells.brightest(v.replicates, &BoxSums::glare_direct).mean, found.mean) << "there is no mirror";
}

}  // namespace
}  // namespace lucerna
