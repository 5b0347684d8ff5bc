// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/thinned_ray_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"
#include "tests/support/local_peers.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

/// A file of `n` rays along z, which start at x = 0, 1, ... and carry `flux_lm` together.
std::filesystem::path file_of(const test::TempDir& dir, const std::string& name, std::size_t n,
                              double flux_lm) {
  RaySet set;
  set.header.set_flux(flux_lm);
  set.rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    set.rays.set(i, {{static_cast<double>(i), 0, 0}, Direction()});
    set.rays.weight[i] = 1.0f;
  }
  write_ray_set(dir / name, set, "tm25");
  return dir / name;
}

double weight_of(const RayBlock& rays, std::size_t first, std::size_t last) {
  return std::accumulate(rays.weight.begin() + static_cast<std::ptrdiff_t>(first),
                         rays.weight.begin() + static_cast<std::ptrdiff_t>(last), 0.0);
}

TEST(ThinnedRaySet, AllRaysWhereThereAreNoMore) {
  const test::TempDir dir;
  const auto file = file_of(dir, "a", 500, 3.0);
  const ThinnedRaySet all = thinned_ray_set({file}, {.max_rays = 500}, no_progress());
  EXPECT_EQ(all.of, 500u);
  EXPECT_EQ(all.set, read_ray_set(file));
}

TEST(ThinnedRaySet, IsSpreadOverTheFile) {
  const test::TempDir dir;
  const ThinnedRaySet some =
      thinned_ray_set({file_of(dir, "a", 200'000, 3.0)}, {.max_rays = 1000}, no_progress());
  EXPECT_EQ(some.of, 200'000u);
  ASSERT_EQ(some.set.rays.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_EQ(static_cast<std::size_t>(some.set.rays.x_mm[i]) / 200, i);
}

/// The one ray that is left of a small file carries all of its flux.
TEST(ThinnedRaySet, EveryFileKeepsItsFlux) {
  const test::TempDir dir;
  const std::vector<std::filesystem::path> files{file_of(dir, "a", 100'000, 90.0),
                                                 file_of(dir, "b", 3, 10.0)};
  const ThinnedRaySet some = thinned_ray_set(files, {.max_rays = 1000}, no_progress());
  const std::size_t n = some.set.rays.size();
  EXPECT_EQ(n, 1000u);
  EXPECT_DOUBLE_EQ(*some.set.header.flux(), 100.0);
  EXPECT_NEAR(weight_of(some.set.rays, 0, n - 1), 90.0, 1e-4);
  EXPECT_NEAR(weight_of(some.set.rays, n - 1, n), 10.0, 1e-5);
}

// Peers that read a part each all have what one process reads, of every format, whole and thinned.
TEST(ThinnedRaySet, IsTheSameForAnyNumberOfPeers) {
  const test::TempDir dir;
  std::vector<std::filesystem::path> files{file_of(dir, "a", 10'007, 90.0), file_of(dir, "b", 2, 10.0)};
  RaySet text = read_ray_set(files[0]);
  text.rays.resize(1001);
  write_ray_set(dir / "c.txt", text, "text");
  files.push_back(dir / "c.txt");
  for (const std::uint64_t max_rays : {std::uint64_t{500}, std::uint64_t{20'000}}) {
    const ThinnedRaySet one = thinned_ray_set(files, {.max_rays = max_rays}, no_progress());
    for (const int n : {1, 2, 3, 7}) {
      const auto errors = test::on_peers(n, [&](Peers& peers) {
        const ThinnedRaySet some =
            thinned_ray_set(files, {.max_rays = max_rays, .peers = &peers}, no_progress());
        EXPECT_EQ(some.of, one.of);
        EXPECT_EQ(some.set, one.set) << peers.rank() << " of " << n;
      });
      for (const std::string& error : errors) EXPECT_EQ(error, "");
    }
  }
}

TEST(ThinnedRaySet, AFaultThatOnePeerMeetsIsThrownByAll) {
  const test::TempDir dir;
  const auto file = file_of(dir, "a", 1000, 1.0);
  std::string bytes = read_file(file, 1 << 20);
  bytes.replace(bytes.size() - 28, 4, std::string("\x00\x00\xC0\x7F", 4));  // the last ray's x is no number
  write_file(file, bytes);
  const auto errors = test::on_peers(
      3, [&](Peers& peers) { (void)thinned_ray_set({file}, {.peers = &peers}, no_progress()); });
  for (const std::string& error : errors) {
    EXPECT_THAT(error, testing::HasSubstr("ray 999"));
    EXPECT_EQ(error, errors.front());
  }
}

// Wavelengths stay where they are wanted, other columns go.
TEST(ThinnedRaySet, KeepsOfItsColumnsTheWavelengths) {
  const test::TempDir dir;
  RaySet set = read_ray_set(file_of(dir, "a", 100, 1.0));
  set.header.columns = {{ColumnKind::tristimulus_x, standard_label(ColumnKind::tristimulus_x)},
                        {ColumnKind::wavelength_nm, standard_label(ColumnKind::wavelength_nm)}};
  set.rays.extra = {std::vector<float>(100, 3.0f), std::vector<float>(100, 600.0f)};
  write_ray_set(dir / "b", set, "tm25");
  const RaySet read =
      thinned_ray_set({dir / "b"}, {.max_rays = 10, .only_wavelengths = true}, no_progress()).set;
  ASSERT_EQ(read.header.columns.size(), 1u);
  EXPECT_EQ(read.header.columns[0].kind, ColumnKind::wavelength_nm);
  ASSERT_EQ(read.rays.extra.size(), 1u);
  EXPECT_EQ(read.rays.extra[0], std::vector<float>(10, 600.0f));
}

/// `n` rays with a colour: one wavelength, or the spectra of a header with the index of each ray.
std::filesystem::path coloured_file(const test::TempDir& dir, const std::string& name, std::size_t n,
                                    const RaySetHeader& colour) {
  RaySet set = read_ray_set(file_of(dir, name, n, 10.0));
  set.header.spectra = colour.spectra;
  set.header.wavelength_nm = colour.wavelength_nm;
  if (colour.spectra.size() > 1) {
    set.header.columns = {{ColumnKind::spectrum_index, standard_label(ColumnKind::spectrum_index)}};
    set.rays.extra = {std::vector<float>(n)};
    for (std::size_t i = 0; i < n; ++i) set.rays.extra[0][i] = i % 2 == 0 ? 1.0F : 2.0F;
  }
  write_ray_set(dir / name, set, "tm25");
  return dir / name;
}

const SpectralTable kBlue{{440.0F, 460.0F}, {1.0F, 1.0F}}, kYellow{{520.0F, 700.0F}, {1.0F, 1.0F}};

// A white LED as makers publish it: a file of the die and one of the phosphor.
TEST(ThinnedRaySet, FilesOfTwoColoursGiveEachRayAWavelength) {
  const test::TempDir dir;
  const std::vector<std::filesystem::path> files{coloured_file(dir, "blue", 500, {.spectra = {kBlue}}),
                                                 coloured_file(dir, "yellow", 1500, {.spectra = {kYellow}})};
  const ThinnedRaySet all = thinned_ray_set(files, {.only_wavelengths = true}, no_progress());
  EXPECT_TRUE(all.warnings.empty());
  ASSERT_EQ(all.set.header.columns.size(), 1U);
  EXPECT_EQ(all.set.header.columns[0].kind, ColumnKind::wavelength_nm);
  EXPECT_TRUE(all.set.header.spectra.empty());
  const std::vector<float>& nm = all.set.rays.extra.at(0);
  for (std::size_t i = 0; i < nm.size(); ++i)
    EXPECT_TRUE(i < 500 ? nm[i] >= 440.0F && nm[i] <= 460.0F : nm[i] >= 520.0F && nm[i] <= 700.0F) << i;
  // The rays are lumens: within the phosphor's they crowd about 560 nm.
  EXPECT_NEAR(std::accumulate(nm.begin() + 500, nm.end(), 0.0) / 1500.0, 572.2, 1.0) << "610 nm of its watts";
  const auto errors = test::on_peers(3, [&](Peers& peers) {
    const ThinOptions options{.only_wavelengths = true, .peers = &peers};
    EXPECT_EQ(thinned_ray_set(files, options, no_progress()).set, all.set);
  });
  for (const std::string& error : errors) EXPECT_EQ(error, "");
}

TEST(ThinnedRaySet, RaysWithSpectraOfTheirOwnGetWavelengths) {
  const test::TempDir dir;
  const auto file = coloured_file(dir, "both", 100, {.spectra = {kBlue, kYellow}});
  const ThinnedRaySet all = thinned_ray_set({file}, {.only_wavelengths = true}, no_progress());
  for (std::size_t i = 0; i < 100; ++i) EXPECT_EQ(all.set.rays.extra.at(0)[i] < 500.0F, i % 2 == 0) << i;
}

TEST(ThinnedRaySet, OneColourStaysWithTheHeader) {
  const test::TempDir dir;
  const std::vector<std::filesystem::path> files{coloured_file(dir, "a", 10, {.spectra = {kBlue}}),
                                                 coloured_file(dir, "b", 10, {.spectra = {kBlue}})};
  const ThinnedRaySet all = thinned_ray_set(files, {.only_wavelengths = true}, no_progress());
  EXPECT_EQ(all.set.header.spectra, std::vector{kBlue});
  EXPECT_TRUE(all.set.rays.extra.empty());
}

TEST(ThinnedRaySet, ColoursThatAreNotAllKnownAreDroppedAloud) {
  const test::TempDir dir;
  const std::vector<std::filesystem::path> files{coloured_file(dir, "blue", 10, {.wavelength_nm = 450.0F}),
                                                 file_of(dir, "unknown", 10, 10.0)};
  const ThinnedRaySet all = thinned_ray_set(files, {.only_wavelengths = true}, no_progress());
  ASSERT_EQ(all.warnings.size(), 1U);
  EXPECT_THAT(all.warnings[0], testing::HasSubstr("unknown: nothing is known of its colour"));
  EXPECT_TRUE(all.set.rays.extra.empty());
  EXPECT_FALSE(all.set.header.wavelength_nm);
}

TEST(RayReader, PassesOverRays) {
  const test::TempDir dir;
  const RaySet set = read_ray_set(file_of(dir, "a", 1000, 1.0));
  for (const char* const format : {"tm25", "text", "mcpl"}) {
    write_ray_set(dir / "b", set, format);
    const RaySet whole = read_ray_set(dir / "b");
    for (const std::uint64_t skipped : {0, 1, 437, 1000, 2000}) {
      const auto reader = open_ray_file(dir / "b");
      reader->skip(skipped);
      RayBlock rest;
      const std::size_t n = reader->read(rest, 2000);
      ASSERT_EQ(n, 1000 - std::min<std::uint64_t>(skipped, 1000)) << format;
      for (std::size_t i = 0; i < n; ++i) EXPECT_EQ(rest.x_mm[i], whole.rays.x_mm[1000 - n + i]) << format;
    }
  }
}

/// All rays of files, block by block, as one.
RayBlock streamed(const std::vector<std::filesystem::path>& files) {
  RayBlock all;
  for_each_ray_block(
      files, [&](const RayBlock& block) { all.append(block); }, no_progress());
  return all;
}

TEST(ForEachRayBlock, HasTheRaysOfTheWholeSet) {
  const test::TempDir dir;
  const auto one = file_of(dir, "one", 200'000, 3.0);
  EXPECT_EQ(streamed({one}), thinned_ray_set({one}, {}, no_progress()).set.rays);
  const std::vector<std::filesystem::path> files{
      coloured_file(dir, "blue", 500, {.spectra = {kBlue}}), one,
      coloured_file(dir, "both", 1500, {.spectra = {kBlue, kYellow}})};
  const std::vector<std::filesystem::path> coloured{files[0], files[2]};
  EXPECT_EQ(streamed(coloured),
            thinned_ray_set(coloured, {.only_wavelengths = true}, no_progress()).set.rays);
  const RayBlock dropped = streamed(files);  // of `one` no colour is known
  EXPECT_TRUE(dropped.extra.empty());
  EXPECT_EQ(dropped.size(), 202'000u);
  EXPECT_NEAR(weight_of(dropped, 500, 200'500), 3.0, 1e-4);
}

TEST(ForEachRayBlock, BlocksAreOfAMillion) {
  const test::TempDir dir;
  const std::size_t n = (std::size_t{1} << 20) + 100'000;
  std::vector<std::size_t> sizes;
  for_each_ray_block(
      {file_of(dir, "a", n, 1.0)}, [&](const RayBlock& block) { sizes.push_back(block.size()); },
      no_progress());
  ASSERT_EQ(sizes.size(), 2u);
  EXPECT_EQ(sizes[0], std::size_t{1} << 20);
  EXPECT_EQ(sizes[1], 100'000u);
}

}  // namespace
}  // namespace lucerna
