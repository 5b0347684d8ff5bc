// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "lucerna/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "lucerna/source_model.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

RaySet disk_rays(std::size_t n, double flux_lm, std::uint64_t seed) {
  const auto emitter = make_emitter({.kind = EmitterKind::disk});
  RaySet set;
  set.rays = draw_rays(*emitter, Sequence(SequenceKind::random, seed), n);
  set.header.set_flux(flux_lm);
  return set;
}

class Compress : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, double flux_lm, std::uint64_t seed) {
    write_ray_set(dir_ / name, disk_rays(20'000, flux_lm, seed), "tm25");
    return dir_ / name;
  }
  test::TempDir dir_;
};

TEST_F(Compress, FluxesOfFilesAdd) {
  const CompressedFiles made = compress({file("a", 100.0, 1), file("b", 50.0, 2)});
  EXPECT_EQ(made.rays, 40'000u);
  EXPECT_EQ(made.model->training_rays(), 40'000u);
  EXPECT_NEAR(made.model->flux(), 150.0, 1e-9 * 150.0);
  EXPECT_EQ(made.model->method(), "adaptive");
}

TEST_F(Compress, AGivenFluxTakesThePlaceOfWhatFilesState) {
  const auto a = file("a", 100.0, 1), b = file("b", 50.0, 2);
  for (const CompressMethod method : {CompressMethod::adaptive, CompressMethod::clusters}) {
    const CompressOptions options{.method = method, .flux = 7.0};
    EXPECT_DOUBLE_EQ(compress({a}, options).model->flux(), 7.0);
    EXPECT_DOUBLE_EQ(compress({a, b}, options).model->flux(), 7.0);
    EXPECT_DOUBLE_EQ(compress(disk_rays(20'000, 100.0, 1), options)->flux(), 7.0);
  }
}

TEST_F(Compress, TheMethodIsTheOneThatWasAskedFor) {
  const auto a = file("a", 100.0, 1);
  const auto clusters = compress({a}, {.method = CompressMethod::clusters}).model;
  EXPECT_EQ(clusters->method(), to_string(CompressMethod::clusters));
  EXPECT_EQ(compress_method("clusters"), CompressMethod::clusters);
  EXPECT_THROW(compress_method("trees"), UsageError);
}

TEST_F(Compress, KeepsToTheSizeThatWasAskedFor) {
  for (const CompressMethod method : {CompressMethod::adaptive, CompressMethod::clusters}) {
    const auto made = compress({file("a", 100.0, 1)}, {.method = method, .max_bytes = 3000});
    EXPECT_LE(save_source_model(dir_ / "small.nfl", *made.model), 3000u);
  }
}

TEST_F(Compress, RefusesNoFilesAndNoFlux) {
  EXPECT_THROW(static_cast<void>(compress(std::vector<std::filesystem::path>{})), UsageError);
  RaySet set = disk_rays(1000, 1.0, 1);
  set.header.flux_lm.reset();
  EXPECT_THROW(static_cast<void>(compress(set)), InputError);
}

}  // namespace
}  // namespace lucerna
