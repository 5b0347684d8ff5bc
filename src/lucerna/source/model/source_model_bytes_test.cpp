// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/io/file.h"
#include "lucerna/source_model.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::unique_ptr<SourceModel> encoded_disk() {
  RaySet set;
  set.header.set_flux(100.0);
  set.rays = sample(*make_emitter({.kind = EmitterKind::disk, .radius_mm = 1.0}), 100'000,
                    Sequence(SequenceKind::sobol, 1));
  return compress(set);
}

TEST(SourceModelBytes, AreThoseOfTheFile) {
  const test::TempDir dir;
  const auto model = encoded_disk();
  save_source_model(dir / "a.nfl", *model);
  const std::string bytes = source_model_bytes(*model);
  EXPECT_EQ(bytes, read_file(dir / "a.nfl", 1 << 24));
  EXPECT_EQ(source_model_bytes(*source_model_from_bytes(bytes, "bytes")), bytes);
  EXPECT_THROW(source_model_from_bytes(bytes.substr(1), "bytes"), InputError);
}

// A Lambertian disk of 1 mm has pi mm2 x pi sr, all equally bright.
TEST(SourceModelBytes, EtendueOfADiskIsThatOfItsArea) {
  const auto model = encoded_disk();
  const double all = std::numbers::pi * std::numbers::pi;
  const auto found = etendue_mm2sr(*model, std::vector<double>{0.0, 0.5, 0.9});
  EXPECT_EQ(found[0], 0.0);
  EXPECT_NEAR(found[1], 0.5 * all, 0.05 * all);
  EXPECT_NEAR(found[2], 0.9 * all, 0.05 * all);
  EXPECT_THROW(etendue_mm2sr(*model, std::vector<double>{1.5}), InputError);
}

}  // namespace
}  // namespace lucerna
