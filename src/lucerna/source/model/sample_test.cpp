// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numeric>

#include "lucerna/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "lucerna/source_model.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::unique_ptr<SourceModel> disk_model() {
  const auto emitter = make_emitter({.kind = EmitterKind::disk, .flux = 50.0});
  RaySet set;
  set.rays = sample(*emitter, 20'000, Sequence(SequenceKind::random, 4));
  set.header.set_flux(emitter->flux());
  return compress(set);
}

TEST(Sample, AFileHoldsTheModelsFluxAndRays) {
  const test::TempDir dir;
  const auto model = disk_model();
  sample(*model, 5000, dir / "rays.tm25ray", {.seed = 3, .origin = "disk.nfl"});
  const RaySet file = read_ray_set(dir / "rays.tm25ray");
  EXPECT_DOUBLE_EQ(*file.header.flux(), 50.0);
  EXPECT_EQ(file.header.texts.light_source, "sampled from disk.nfl");
  const RayBlock here = sample(*model, 5000, Sequence(SequenceKind::random, 3));
  ASSERT_EQ(file.rays.size(), here.size());
  EXPECT_EQ(file.rays.x_mm, here.x_mm);
  EXPECT_EQ(file.rays.kz, here.kz);
  EXPECT_NEAR(std::accumulate(here.weight.begin(), here.weight.end(), 0.0) / 5000.0, 1.0, 1e-6);
}

TEST(Sample, RefusesNoRaysAndUnknownFormats) {
  const test::TempDir dir;
  const auto model = disk_model();
  EXPECT_THROW(sample(*model, 0, dir / "rays.tm25ray"), InputError);
  EXPECT_THROW(sample(*model, 10, dir / "rays.ray"), UsageError);
  EXPECT_THROW(sample(*model, 10, dir / "rays.ray", {.format = "none"}), UsageError);
  EXPECT_FALSE(std::filesystem::exists(dir / "rays.ray"));
}

}  // namespace
}  // namespace lucerna
