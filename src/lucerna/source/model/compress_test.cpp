// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/file.h"
#include "lucerna/core/parallel/parallel.h"
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

/// Intensity as cos(theta)^exponent from a square of 1 mm, of one wavelength or spectrum.
RaySet lobe_rays(std::size_t n, double exponent, double flux_lm, std::uint64_t seed) {
  RaySet set;
  set.header.set_flux(flux_lm);
  set.rays.resize(n);
  Rng rng(seed, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const double z = std::pow(1.0 - rng.uniform(), 1.0 / (exponent + 1.0));
    const double turn = 2.0 * std::numbers::pi * rng.uniform(), sine = std::sqrt(1.0 - z * z);
    set.rays.set(i, {{rng.uniform() - 0.5, rng.uniform() - 0.5, 0.0},
                     Direction::from({sine * std::cos(turn), sine * std::sin(turn), z})});
    set.rays.weight[i] = 1.0F;
  }
  return set;
}

// A die of 30 lm in a narrow lobe and a phosphor of 70 lm by Lambert's law, a file each: within 20 degrees of
// the axis 0.611 of the light is blue, beyond 60 degrees 0.003. A model that forgets which direction has
// which colour has 0.3 in both.
TEST_F(Compress, TwoFilesAreOneSourceWithColourOverAngle) {
  RaySet blue = lobe_rays(30'000, 8.0, 30.0, 1), yellow = lobe_rays(30'000, 1.0, 70.0, 2);
  blue.header.wavelength_nm = 450.0F;
  yellow.header.spectra = {{{520.0F, 580.0F, 700.0F}, {0.2F, 1.0F, 0.1F}}};
  write_ray_set(dir_ / "blue", blue, "tm25");
  write_ray_set(dir_ / "yellow", yellow, "tm25");
  const CompressedFiles made = compress({dir_ / "blue", dir_ / "yellow"});
  EXPECT_TRUE(made.warnings.empty());
  ASSERT_TRUE(made.model->has_wavelengths());
  sample(*made.model, 200'000, dir_ / "led", {.format = "tm25"});
  const RaySet drawn = read_ray_set(dir_ / "led");
  const auto column = find_column(drawn.header.columns, ColumnKind::wavelength_nm);
  ASSERT_TRUE(column);
  double blue_near = 0.0, near = 0.0, blue_far = 0.0, far = 0.0;
  for (std::size_t i = 0; i < drawn.rays.size(); ++i) {
    const bool is_blue = drawn.rays.extra[*column][i] < 500.0F;
    const double z = drawn.rays.kz[i];
    if (z > std::cos(radians(20.0))) near += 1.0, blue_near += is_blue ? 1.0 : 0.0;
    if (z < 0.5) far += 1.0, blue_far += is_blue ? 1.0 : 0.0;
  }
  EXPECT_NEAR(blue_near / near, 0.611, 0.03);
  EXPECT_LT(blue_far / far, 0.03);
}

// In memory and by its file, rays with spectra by index are the same model; what is dropped is told.
TEST_F(Compress, ColoursAreKeptOrDroppedAloud) {
  RaySet set = lobe_rays(20'000, 1.0, 30.0, 3);
  set.header.flux_unit = FluxUnit::watt;  // TM-25 wants watts of rays with colours
  set.header.set_flux(2.0);
  set.header.spectra = {{{450.0F}, {1.0F}}, {{520.0F, 700.0F}, {1.0F, 1.0F}}};
  set.header.columns = {{ColumnKind::spectrum_index, standard_label(ColumnKind::spectrum_index)}};
  set.rays.extra = {std::vector<float>(20'000)};
  for (std::size_t i = 0; i < 20'000; ++i) set.rays.extra[0][i] = i % 2 == 0 ? 1.0F : 2.0F;
  write_ray_set(dir_ / "both", set, "tm25");
  const auto in_memory = compress(set);
  const CompressedFiles by_file = compress({dir_ / "both"});
  EXPECT_TRUE(in_memory->has_wavelengths() && by_file.model->has_wavelengths());
  EXPECT_TRUE(in_memory->spectra().empty() && by_file.warnings.empty());
  EXPECT_EQ(source_model_bytes(*in_memory), source_model_bytes(*by_file.model));

  const CompressedFiles clusters = compress({dir_ / "both"}, {.method = CompressMethod::clusters});
  ASSERT_EQ(clusters.warnings.size(), 1U);
  EXPECT_NE(clusters.warnings[0].find("clusters have no colours"), std::string::npos);

  set.header.spectra.clear();
  set.header.columns = {{ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
  set.rays.extra[0].assign(20'000, 500.0F);
  set.rays.extra[0][7] = 0.0F;
  write_ray_set(dir_ / "one", set, "tm25");
  const CompressedFiles one = compress({dir_ / "one"});
  ASSERT_EQ(one.warnings.size(), 1U);
  EXPECT_NE(one.warnings[0].find("1 of 20000 rays have no wavelength"), std::string::npos);
  EXPECT_FALSE(one.model->has_wavelengths());
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

/// The flux with x > 0 of the weights' sum.
double right_share(const RayBlock& rays) {
  double right = 0.0, all = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const auto weight = static_cast<double>(rays.weight[i]);
    all += weight;
    right += rays.x_mm[i] > 0.0F ? weight : 0.0;
  }
  return right / all;
}

// 5000 of 100,000 rays lie on the right by chance to 0.7 %; all of them by the file's share, which the
// model has to within what its trees smooth.
TEST_F(Compress, RaysThatAreNotInMemoryCount) {
  RaySet set = lobe_rays(100'000, 1.0, 100.0, 5);
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    // Half of the rays right of the middle are faint; nothing of 0.01 mm lies astride of it.
    set.rays.x_mm[i] += set.rays.x_mm[i] > 0.0F ? 0.01F : -0.01F;
    if (set.rays.x_mm[i] > 0.0F && i % 2 == 0) set.rays.weight[i] = 0.5F;
  }
  const double share = right_share(set.rays);
  write_ray_set(dir_ / "rays", set, "tm25");
  const auto model_share = [&](const SourceModel& model) {
    return right_share(draw_rays(model, Sequence(SequenceKind::sobol, 1), 1 << 20));
  };
  double worst_of_some = 0.0;
  for (const std::uint64_t seed : {1, 2}) {
    const CompressedFiles made = compress({dir_ / "rays"}, {.seed = seed, .max_rays_in_memory = 5000});
    EXPECT_EQ(made.rays, 100'000u);
    EXPECT_EQ(made.model->training_rays(), 100'000u);
    ASSERT_EQ(made.notes.size(), 1u);
    EXPECT_NEAR(model_share(*made.model), share, 0.0015) << seed;
    RaySet some = set;
    some.rays = {};
    for (std::size_t i = seed; i < set.rays.size(); i += 20) some.rays.append(set.rays, i);
    worst_of_some = std::max(worst_of_some, std::abs(model_share(*compress(some)) - share));
  }
  EXPECT_GT(worst_of_some, 0.003) << "without the other rays";
}

TEST_F(Compress, AModelOfAllRaysIsTheSameForAnyNumberOfThreads) {
  const auto rays = file("a", 1.0, 1);
  const auto bytes = [&](const std::string& name) {
    save_source_model(dir_ / name, *compress({rays}, {.max_rays_in_memory = 5000}).model);
    return read_file(dir_ / name, 1 << 20);
  };
  const std::string many = bytes("many.nfl");
  const ThreadLimit one(1);
  EXPECT_EQ(bytes("one.nfl"), many);
}

using CompressSlow = Compress;

// Two layers, a background and colours, each counted.
TEST_F(CompressSlow, AModelOfAllRaysWithColoursIsTheSameForAnyNumberOfThreads) {
  RaySet blue = lobe_rays(8000, 8.0, 30.0, 1), yellow = lobe_rays(8000, 1.0, 70.0, 2);
  for (std::size_t i = 0; i < yellow.rays.size(); i += 3) yellow.rays.z_mm[i] -= 3.0F;
  blue.header.wavelength_nm = 450.0F;
  yellow.header.wavelength_nm = 580.0F;
  write_ray_set(dir_ / "blue", blue, "tm25");
  write_ray_set(dir_ / "yellow", yellow, "tm25");
  const CompressOptions options{.max_rays_in_memory = 4000};
  const auto bytes = [&](const std::string& name) {
    const CompressedFiles made = compress({dir_ / "blue", dir_ / "yellow"}, options);
    EXPECT_TRUE(made.model->has_wavelengths());
    EXPECT_EQ(made.model->training_rays(), 16'000u);
    save_source_model(dir_ / name, *made.model);
    return read_file(dir_ / name, 1 << 20);
  };
  const std::string many = bytes("many.nfl");
  const ThreadLimit one(1);
  EXPECT_EQ(bytes("one.nfl"), many);
}

TEST_F(Compress, NoRayInMemoryIsRefused) {
  EXPECT_THROW((void)compress({file("a", 1.0, 1)}, {.max_rays_in_memory = 0}), UsageError);
}

}  // namespace
}  // namespace lucerna
