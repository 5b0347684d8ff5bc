// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/tm25/tm25.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/rayset/formats/tm25/tm25_layout.h"
#include "tests/support/data_dir.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::bytes_of, test::message_of, test::patched, test::put_bytes, test::random_ray_set, test::TempDir;
using ::testing::AllOf, ::testing::HasSubstr;

ColumnSpec standard(ColumnKind kind, std::size_t n = 0) { return {kind, standard_label(kind, n)}; }

std::vector<ColumnSpec> stokes(std::size_t n) {
  std::vector<ColumnSpec> columns;
  for (std::size_t s = 0; s < n; ++s) columns.push_back(standard(ColumnKind::stokes, s));
  return columns;
}

RaySet written_and_read(const RaySet& set, std::vector<std::string>* warnings = nullptr) {
  const TempDir dir;
  write_ray_set(dir / "a", set, "tm25");
  return read_ray_set(dir / "a", {}, no_progress(), warnings);
}

/// A set that uses everything that TM-25 has for radiant rays.
RaySet full_set(std::size_t n) {
  std::vector<ColumnSpec> columns = stokes(6);
  columns.push_back(standard(ColumnKind::spectrum_index));
  columns.push_back({ColumnKind::additional, "phase"});
  columns.push_back({ColumnKind::additional, "Länge µm"});
  RaySet set = random_ray_set(n, 5, columns);
  for (std::size_t i = 0; i < n; ++i) set.rays.extra[6][i] = static_cast<float>(1 + i % 2);
  RaySetHeader& h = set.header;
  h.flux_unit = FluxUnit::watt;
  h.flux_w = 1.25;
  h.flux_lm = 337.0;
  h.spectra = {{{400.0F, 500.0F, 600.0F}, {1.0F, 100.0F, 0.0F}}, {{555.0F}, {1.0F}}};
  h.creation_method = 1;
  h.start_position = 7;
  h.texts = {"lamp",      "maker \xF0\x9F\x92\xA1",
             "model",     "file",
             "RiGO",      "camera",
             "20 °C",     "info",
             "cad",       "much more",
             "2026-11-20"};
  return set;
}

TEST(Tm25, WhatIsWrittenIsRead) {
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{3}, kStreamBlock + 1}) {
    const RaySet plain = random_ray_set(n, n);
    EXPECT_EQ(written_and_read(plain), plain) << n;
    std::vector<std::string> warnings;
    EXPECT_EQ(written_and_read(full_set(n), &warnings), full_set(n)) << n;
    EXPECT_THAT(warnings, ::testing::IsEmpty());
  }
}

TEST(Tm25, EverySpectrumKindSurvives) {
  RaySet one = random_ray_set(3, 1);
  one.header.wavelength_nm = 555.5F;
  EXPECT_EQ(written_and_read(one), one);
  RaySet table = random_ray_set(3, 1);
  table.header.spectra = {{{400.0F, 700.0F}, {1.0F, 2.0F}}};
  EXPECT_EQ(written_and_read(table), table);
  RaySet colour =
      random_ray_set(3, 1, {standard(ColumnKind::tristimulus_x), standard(ColumnKind::tristimulus_z)});
  EXPECT_EQ(written_and_read(colour), colour);
  RaySet both = random_ray_set(3, 1, {standard(ColumnKind::radiant_flux_w)});
  both.header.flux_w = 2.0;
  EXPECT_EQ(written_and_read(both), both);
  RaySet per_ray = random_ray_set(3, 1, {standard(ColumnKind::wavelength_nm)});
  per_ray.header.flux_unit = FluxUnit::watt;
  per_ray.header.flux_w = 0.5;
  EXPECT_EQ(written_and_read(per_ray), per_ray);
}

TEST(Tm25, ColumnsWithoutAPlaceBecomeAdditional) {
  const RaySet set = random_ray_set(5, 2,
                                    {{ColumnKind::additional, "q"},
                                     standard(ColumnKind::tristimulus_x),
                                     standard(ColumnKind::wavelength_nm)});
  const TempDir dir;
  const auto warnings = write_ray_set(dir / "a", set, "tm25");
  EXPECT_THAT(warnings, ::testing::Contains(HasSubstr("tristimulus X")));
  const RaySet back = read_ray_set(dir / "a");
  ASSERT_EQ(back.header.columns.size(), 3u);
  EXPECT_EQ(back.header.columns[0].kind, ColumnKind::wavelength_nm);
  EXPECT_EQ(back.rays.extra[0], set.rays.extra[2]);
  EXPECT_EQ(back.rays.extra[1], set.rays.extra[0]);
  EXPECT_EQ(back.rays.extra[2], set.rays.extra[1]);
}

TEST(Tm25, StokesOfThreeColumnsAndIntegerIndices) {
  std::vector<ColumnSpec> columns = stokes(3);
  columns.push_back(standard(ColumnKind::spectrum_index));
  RaySet set = random_ray_set(4, 3, columns);
  set.header.flux_unit = FluxUnit::watt;
  set.header.spectra.assign(3, {{500.0F}, {1.0F}});
  set.rays.extra[3] = {1.0F, 2.0F, 3.0F, 1.0F};
  std::vector<std::string> warnings;
  EXPECT_EQ(written_and_read(set, &warnings).rays, set.rays);
  EXPECT_THAT(warnings, ::testing::Contains(HasSubstr("Stokes")));

  const TempDir dir;
  write_ray_set(dir / "a", set, "tm25");
  std::string bytes = bytes_of(dir / "a");
  for (std::size_t i = 0; i < 4; ++i) {
    bytes = patched(bytes, bytes.size() - 4 - 44 * i, static_cast<std::int32_t>(set.rays.extra[3][3 - i]));
  }
  put_bytes(dir / "a", bytes);
  EXPECT_EQ(read_ray_set(dir / "a").rays, set.rays);
}

TEST(Tm25, NotStatedFluxesAreAbsent) {
  const TempDir dir;
  write_ray_set(dir / "a", random_ray_set(2, 1), "tm25");
  const std::string good = bytes_of(dir / "a");
  for (const std::uint32_t bits : {0x7FC00001U, 0x0100807FU, 0x00000000U, 0xFF800000U, 0xBF800000U}) {
    put_bytes(dir / "a", patched(good, tm25::kFluxLm, bits));
    const RaySet set = read_ray_set(dir / "a");
    EXPECT_FALSE(set.header.flux_lm.has_value()) << bits;
    EXPECT_THAT(message_of<InputError>([&] { require_flux(set.header, "a"); }),
                HasSubstr("it has to be given"));
  }
}

TEST(Tm25, AnchorsTheRaysToTheEndWhereWritersPadOtherwise) {
  RaySet set = random_ray_set(5, 1);
  set.header.spectra = {{{400.0F, 700.0F}, {1.0F, 2.0F}}};  // 20 bytes, padded to 32
  const TempDir dir;
  write_ray_set(dir / "a", set, "tm25");
  const std::string good = bytes_of(dir / "a");
  std::string unpadded = good, more = good;
  unpadded.erase(tm25::kHeaderSize + 20, 12);
  more.insert(tm25::kHeaderSize + 32, std::string(4, '\0'));
  for (const std::string& bytes : {unpadded, more}) {
    put_bytes(dir / "a", bytes);
    std::vector<std::string> warnings;
    EXPECT_EQ(read_ray_set(dir / "a", {}, no_progress(), &warnings), set);
    EXPECT_THAT(warnings, ::testing::ElementsAre(HasSubstr("from the end of the file")));
  }
  put_bytes(dir / "a", good + "trailing junk");
  std::vector<std::string> warnings;
  EXPECT_EQ(read_ray_set(dir / "a", {}, no_progress(), &warnings), set);
  EXPECT_THAT(warnings, ::testing::ElementsAre(HasSubstr("13 bytes after the last ray")));
}

TEST(Tm25, EveryTruncationIsAnErrorAndSalvageTakesWholeRays) {
  RaySet set = random_ray_set(4, 9);
  set.header.spectra = {{{400.0F, 500.0F}, {1.0F, 2.0F}}};
  const TempDir dir;
  write_ray_set(dir / "a", set, "tm25");
  const std::string good = bytes_of(dir / "a");
  const std::size_t rays = good.size() - std::size_t{4} * 28;
  for (std::size_t size = 0; size < good.size(); size += size + 1 < tm25::kTexts || size >= 36000 ? 1 : 97) {
    put_bytes(dir / "a", std::string_view(good).substr(0, size));
    const std::string message = message_of<InputError>([&] { read_ray_set(dir / "a"); });
    EXPECT_THAT(message, AllOf(HasSubstr("expected"), ::testing::Not(HasSubstr("\n")))) << size;
    if (size < rays) continue;
    EXPECT_EQ(read_ray_set(dir / "a", {.salvage = true}).rays.size(), (size - rays) / 28);
  }
}

TEST(Tm25, HostileHeadersAreErrorsThatNameTheByte) {
  const TempDir dir;
  write_ray_set(dir / "a", full_set(3), "tm25");
  const std::string good = bytes_of(dir / "a");
  const auto message = [&](const std::string& bytes) {
    put_bytes(dir / "a", bytes);
    return message_of<InputError>([&] { read_ray_set(dir / "a"); });
  };
  EXPECT_THAT(message(patched(good, tm25::kVersion, 2014)),
              AllOf(HasSubstr("byte 4"), HasSubstr("2014"), HasSubstr("2013")));
  for (const std::uint64_t n :
       {std::uint64_t{1} << 63, ~std::uint64_t{0}, std::uint64_t{4}, std::uint64_t{1} << 40}) {
    EXPECT_THAT(message(patched(good, tm25::kRayCount, n)),
                AllOf(HasSubstr("byte 20"), HasSubstr(fmt::format("{} rays", n))));
  }
  EXPECT_THAT(message(patched(good, tm25::kSpectralId, 5)), HasSubstr("byte 60"));
  EXPECT_THAT(message(patched(good, tm25::kTableCount, -1)), HasSubstr("byte 76"));
  EXPECT_THAT(message(patched(good, tm25::kTableCount, std::numeric_limits<int>::max())),
              HasSubstr("byte 76"));
  EXPECT_THAT(message(patched(good, tm25::kItemCount, -1)), HasSubstr("byte 80"));
  EXPECT_THAT(message(patched(good, tm25::kItemCount, 257)), HasSubstr("byte 80"));
  EXPECT_THAT(message(patched(good, tm25::kTextSize, -32)), HasSubstr("byte 84"));
  EXPECT_THAT(message(patched(good, tm25::kTextSize, 1 << 24)), HasSubstr("byte 84"));
  EXPECT_THAT(message(patched(good, tm25::kFlags, 2)), HasSubstr("byte 256"));
  EXPECT_THAT(message(patched(good, tm25::kFlags + 8, 0)), HasSubstr("byte 264"));
  EXPECT_THAT(message(patched(good, tm25::kHeaderSize, -1)), HasSubstr("byte 36288"));
  EXPECT_THAT(message(patched(good, tm25::kHeaderSize, 1 << 19)), HasSubstr("byte 36288"));
  EXPECT_THAT(message(patched(good, tm25::kHeaderSize + 12, 300.0F)), HasSubstr("byte 36300"));
  EXPECT_THAT(message(""), HasSubstr("empty"));
  EXPECT_THAT(message("TM"), HasSubstr("no ray file"));
  EXPECT_THAT(message("PK\3\4 something else"), AllOf(HasSubstr("50 4b 03 04"), HasSubstr("tm25")));
}

TEST(Tm25, Edition2020IsReadWithAWarning) {
  const TempDir dir;
  const RaySet set = random_ray_set(2, 1);
  write_ray_set(dir / "a", set, "tm25");
  put_bytes(dir / "a", patched(bytes_of(dir / "a"), tm25::kVersion, 2020));
  std::vector<std::string> warnings;
  EXPECT_EQ(read_ray_set(dir / "a", {}, no_progress(), &warnings), set);
  EXPECT_THAT(warnings, ::testing::ElementsAre(HasSubstr("TM-25-20")));
}

TEST(Tm25, FaultyRaysAreNamedAndSalvageLeavesThemOut) {
  const TempDir dir;
  const RaySet set = random_ray_set(20000, 1);
  write_ray_set(dir / "a", set, "tm25");
  const std::string good = bytes_of(dir / "a");
  const std::size_t ray = tm25::kHeaderSize + std::size_t{28} * 10007;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto message = [&](std::size_t column, float value) {
    put_bytes(dir / "a", patched(good, ray + 4 * column, value));
    return message_of<InputError>([&] { read_ray_set(dir / "a"); });
  };
  const auto place = HasSubstr(fmt::format("ray 10007 (byte {})", ray));
  EXPECT_THAT(message(0, nan), AllOf(place, HasSubstr("x is nan, a finite number expected")));
  EXPECT_THAT(message(3, nan), AllOf(place, HasSubstr("kx is nan")));
  EXPECT_THAT(message(5, 40.0F), AllOf(place, HasSubstr("length 40"), HasSubstr("1 expected")));
  EXPECT_THAT(message(6, std::numeric_limits<float>::infinity()), AllOf(place, HasSubstr("flux is inf")));
  EXPECT_THAT(message(6, -1.0F), AllOf(place, HasSubstr("flux is -1")));

  std::vector<std::string> warnings;
  const RaySet whole = read_ray_set(dir / "a", {.salvage = true}, no_progress(), &warnings);
  EXPECT_EQ(whole.rays.size(), 19999u);
  EXPECT_EQ(whole.rays.x_mm[10007], set.rays.x_mm[10008]);
  EXPECT_THAT(warnings, ::testing::ElementsAre(HasSubstr("ray 10007")));

  put_bytes(dir / "a", good.substr(0, tm25::kHeaderSize) + std::string(std::size_t{28} * 20000, '\xFF'));
  EXPECT_THAT(message_of<InputError>([&] { read_ray_set(dir / "a"); }), HasSubstr("ray 0 (byte 36288)"));
  EXPECT_EQ(read_ray_set(dir / "a", {.salvage = true}).rays.size(), 0u);
}

TEST(Tm25, RoughDirectionsAreNormalisedAndGoodOnesKeepTheirBits) {
  const TempDir dir;
  RaySet set = random_ray_set(9, 1);
  const RaySet exact = set;
  set.rays.kx[4] *= 1.0004F, set.rays.ky[4] *= 1.0004F, set.rays.kz[4] *= 1.0004F;
  write_ray_set(dir / "a", set, "tm25");
  const RaySet back = read_ray_set(dir / "a");
  EXPECT_NEAR(back.rays.kx[4], exact.rays.kx[4], 2e-7);
  EXPECT_NE(back.rays.kx[4], set.rays.kx[4]);
  EXPECT_EQ(back.rays.kx[3], exact.rays.kx[3]);
  write_ray_set(dir / "b", back, "tm25");
  EXPECT_EQ(read_ray_set(dir / "b"), back);
}

TEST(Tm25Data, MeasuredLed) {
  LUCERNA_DATA_FILE(path, "rayfiles/rayfile_LERTDUW_S2WP_green_100k_20161013_IES_TM25.TM25RAY");
  std::vector<std::string> warnings;
  const RaySet set = read_ray_set(path, {}, no_progress(), &warnings);
  EXPECT_THAT(warnings, ::testing::IsEmpty());
  EXPECT_EQ(set.rays.size(), 100000u);
  EXPECT_EQ(set.header.flux(), 337.0);
  EXPECT_NEAR(set.header.flux_w.value(), 0.69379, 1e-5);
  ASSERT_EQ(set.header.spectra.size(), 1u);
  EXPECT_EQ(set.header.spectra[0].wavelength_nm.size(), 86u);
  EXPECT_EQ(set.header.spectra[0].wavelength_nm.front(), 450.0F);
  EXPECT_EQ(set.header.spectra[0].wavelength_nm.back(), 620.0F);
  EXPECT_EQ(set.header.creation_method, 1);
  EXPECT_EQ(set.header.texts.date, "2016-10-13 14:07:45");
  EXPECT_NEAR(set.rays.x_mm[0], -0.9814177F, 1e-7);
  EXPECT_NEAR(set.rays.y_mm[0], 0.2846405F, 1e-7);
  EXPECT_NEAR(set.rays.kz[0], 0.8811187F, 1e-7);
  EXPECT_NEAR(set.rays.weight[0], 3.37e-3F, 1e-9);
  const TempDir dir;
  write_ray_set(dir / "a", set, "tm25");
  EXPECT_EQ(read_ray_set(dir / "a"), set);
  EXPECT_EQ(bytes_of(dir / "a").substr(36992), bytes_of(path).substr(36992)) << "the rays keep every bit";
}

TEST(Tm25Data, LightToolsAndPointSourceFiles) {
  LUCERNA_DATA_FILE(cylinder, "rayfiles/Cyl10k.1.tm25ray");
  const RaySet a = read_ray_set(cylinder);
  EXPECT_EQ(a.rays.size(), 10000u);
  EXPECT_EQ(a.header.flux(), 1.0);
  EXPECT_THAT(a.header.texts.file_creator, HasSubstr("LightTools"));
  LUCERNA_DATA_FILE(point, "rayfiles/farfield.TM25ray");
  const RaySet b = read_ray_set(point);
  EXPECT_EQ(b.rays.size(), 100000u);
  EXPECT_EQ(b.header.flux_unit, FluxUnit::watt);
  EXPECT_EQ(b.header.flux(), 1.0);
  EXPECT_EQ(b.header.wavelength_nm, 500.0F);
}

}  // namespace
}  // namespace lucerna
