// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/source_etendue.h"

#include <gtest/gtest.h>

#include <memory>
#include <numbers>

#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source/model/model_etendue.h"

namespace lucerna {
namespace {

/// The etendue of a Lambertian disk of 1 mm radius; half of its flux needs half of it.
constexpr double kDisk_mm2_sr = std::numbers::pi * std::numbers::pi;

std::shared_ptr<const RaySource> disk() {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 1.0;
  return make_emitter(options);
}

std::shared_ptr<const RaySource> model_of_disk() {
  RaySet set;
  set.header.set_flux(disk()->flux());
  set.rays = draw_rays(*disk(), Sequence(SequenceKind::random, 1), 30'000);
  return compress_adaptive(set, {});
}

PlacedSource placed(std::shared_ptr<const RaySource> rays, double x_mm) {
  return {std::move(rays), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {x_mm, 0, 0}), {}};
}

DesignRays rays_of(const std::vector<PlacedSource>& sources) {
  DesignRays rays(sources, Frame(), 1);
  rays.grow(std::uint64_t{1} << 17);
  return rays;
}

TEST(SourceEtendue, OfADiskIsTheKnownOneAndMadeOnce) {
  const DesignRays rays = rays_of({placed(disk(), 0.0)});
  SourceEtendue etendue(rays);
  EXPECT_EQ(etendue.rays().size(), rays.size());
  const EtendueCurve& quick = etendue.quick();
  EXPECT_NEAR(quick.at(0.5) / (0.5 * kDisk_mm2_sr), 1.0, 0.1);
  EXPECT_EQ(&etendue.quick(), &quick);
}

// The searched curve of a model comes from its density, that of two models from rays of both, which have
// twice the etendue of one.
TEST(SourceEtendue, OfOneModelAndOfTwo) {
  const auto model = model_of_disk();
  const DesignRays one = rays_of({placed(model, 0.0)});
  const DesignRays two = rays_of({placed(model, -20.0), placed(model, 20.0)});
  SourceEtendue of_one(one), of_two(two);
  const EtendueCurve& curve = of_one.searched();
  EXPECT_EQ(curve.at(0.5), etendue_curve(dynamic_cast<const SourceModel&>(*model)).at(0.5));
  EXPECT_EQ(&of_one.searched(), &curve);
  EXPECT_NEAR(of_two.searched().at(0.5) / curve.at(0.5), 2.0, 0.3);
}

}  // namespace
}  // namespace lucerna
