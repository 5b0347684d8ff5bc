// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "lucerna/core/io/error.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

/// A set whose ray i starts at x = i, with weights 1, 2, 3, ...
std::shared_ptr<RaySet> numbered_set(std::size_t n) {
  auto set = std::make_shared<RaySet>();
  set->header.flux_lm = 50.0;
  set->rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    set->rays.set(i, {{static_cast<double>(i), 0, 0}, Direction()});
    set->rays.weight[i] = static_cast<float>(i + 1);
  }
  return set;
}

TEST(RaySetSource, VisitsEveryRayOnceForEveryCountAndSeed) {
  for (const std::size_t n : {1u, 2u, 63u, 64u, 65u, 128u, 1000u, 6401u}) {
    const RaySetSource source(numbered_set(n), "set");
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      RayBlock rays;
      rays.resize(n);
      source.emit(Sequence(SequenceKind::random, seed), 0, rays);
      std::set<float> seen(rays.x_mm.begin(), rays.x_mm.end());
      EXPECT_EQ(seen.size(), n) << "seed " << seed;
      RayBlock again;
      again.resize(n);
      source.emit(Sequence(SequenceKind::random, seed), n, again);
      EXPECT_EQ(rays, again) << "the second round is the first";
    }
  }
}

TEST(RaySetSource, MeanWeightIsOneAndSharesAreKept) {
  const RaySetSource source(numbered_set(1000), "set");
  RayBlock rays;
  rays.resize(1000);
  source.emit(Sequence(SequenceKind::random, 1), 0, rays);
  EXPECT_NEAR(std::accumulate(rays.weight.begin(), rays.weight.end(), 0.0), 1000.0, 1e-3);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(rays.weight[i]), (static_cast<double>(rays.x_mm[i]) + 1.0) / 500.5, 1e-6);
  }
}

TEST(RaySetSource, AFirstPartIsSpreadOverTheFile) {
  const RaySetSource source(numbered_set(64'000), "set");
  RayBlock rays;
  rays.resize(6400);
  source.emit(Sequence(SequenceKind::random, 9), 0, rays);
  for (int tenth = 0; tenth < 10; ++tenth) {
    const auto in_tenth = std::count_if(rays.x_mm.begin(), rays.x_mm.end(), [&](float x) {
      return x >= static_cast<float>(6400 * tenth) && x < static_cast<float>(6400 * (tenth + 1));
    });
    EXPECT_NEAR(static_cast<double>(in_tenth), 640.0, 4 * 64.0) << "of ten runs of 64; tenth " << tenth;
  }
}

TEST(RaySetSource, RefusesWhatCannotShine) {
  EXPECT_THROW(RaySetSource(numbered_set(0), "empty"), InputError);
  auto no_flux = numbered_set(3);
  no_flux->header.flux_lm.reset();
  EXPECT_THROW(RaySetSource(no_flux, "no flux"), InputError);
  auto dark = numbered_set(3);
  std::fill(dark->rays.weight.begin(), dark->rays.weight.end(), 0.0f);
  EXPECT_THROW(RaySetSource(dark, "dark"), InputError);
}

/// Wavelengths of the first `n` rays of a stream, and where these begin.
std::pair<std::vector<float>, RayBlock> coloured(const RaySource& source, std::uint64_t first,
                                                 std::size_t n) {
  const Sequence sequence(SequenceKind::random, 3);
  RayBlock rays;
  rays.resize(n);
  source.emit(sequence, first, rays);
  std::vector<float> nm(n);
  source.emit_wavelengths(sequence, first, nm);
  return {nm, rays};
}

TEST(RaySetSource, EachRayKeepsItsWavelength) {
  const auto set = numbered_set(1000);
  set->header.columns = {{ColumnKind::wavelength_nm, "wavelength nm"}};
  set->rays.extra = {std::vector<float>(1000)};
  for (std::size_t i = 0; i < 1000; ++i) set->rays.extra[0][i] = 400.0F + static_cast<float>(i);
  const RaySetSource source(set, "set");
  ASSERT_TRUE(source.has_wavelengths());
  const auto [nm, rays] = coloured(source, 777, 500);
  for (std::size_t i = 0; i < nm.size(); ++i) EXPECT_EQ(nm[i], 400.0F + rays.x_mm[i]) << i;
}

TEST(RaySetSource, TakesTheOneWavelengthOrTheSpectrumOfItsIndex) {
  const auto set = numbered_set(64);
  EXPECT_FALSE(RaySetSource(set, "set").has_wavelengths());
  set->header.spectra = {{{450.0F}, {1.0F}}, {{600.0F, 610.0F}, {1.0F, 1.0F}}};
  set->header.columns = {{ColumnKind::spectrum_index, "spectrum index"}};
  set->rays.extra = {std::vector<float>(64, 2.0F)};
  set->rays.extra[0][9] = 1.0F;
  set->rays.extra[0][10] = 77.0F;
  const auto [nm, rays] = coloured(RaySetSource(set, "set"), 0, 64);
  for (std::size_t i = 0; i < nm.size(); ++i) {
    if (rays.x_mm[i] == 9.0F || rays.x_mm[i] == 10.0F) {
      EXPECT_EQ(nm[i], 450.0F) << "an index that names none is the first";
    } else {
      EXPECT_TRUE(nm[i] >= 600.0F && nm[i] <= 610.0F) << nm[i];
    }
  }
  set->header.spectra.clear();
  set->header.wavelength_nm = 530.0F;
  for (const float one : coloured(RaySetSource(set, "set"), 0, 64).first) EXPECT_EQ(one, 530.0F);
}

}  // namespace
}  // namespace lucerna
