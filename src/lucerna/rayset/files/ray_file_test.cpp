// SPDX-License-Identifier: Apache-2.0
// Every format through the registry: what one writes any other can carry on, and no bytes break a reader.
#include "lucerna/ray_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "tests/support/data_dir.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::bytes_of, test::message_of, test::put_bytes, test::random_ray_set, test::TempDir;
using ::testing::AllOf, ::testing::Contains, ::testing::HasSubstr;

const std::vector<ColumnSpec> kWavelength{{ColumnKind::wavelength_nm, "wavelength nm"}};

RaySet radiant_set(std::size_t n, std::vector<ColumnSpec> columns = {}) {
  RaySet set = random_ray_set(n, n + 1, std::move(columns));
  set.header.flux_unit = FluxUnit::watt;
  set.header.flux_lm.reset();
  set.header.flux_w = 1.25;
  return set;
}

/// Starts, directions and weights, without extra columns.
RayBlock bare(RayBlock rays) {
  rays.extra.clear();
  return rays;
}

/// What is left of the rays in such a file: MCPL makes the largest cosine of the other two and its sign.
RayBlock kept_by(std::string_view format, RayBlock rays) {
  for (std::size_t i = 0; format == "mcpl" && i < rays.size(); ++i) {
    float* k[] = {&rays.kx[i], &rays.ky[i], &rays.kz[i]};
    std::ranges::sort(k, {}, [](const float* c) { return std::abs(*c); });
    const double a = *k[0], b = *k[1];
    *k[2] = std::copysign(static_cast<float>(std::sqrt(1.0 - (a * a + b * b))), *k[2]);
  }
  return rays;
}

TEST(RayFile, EveryPairOfFormatsKeepsEveryBit) {
  const TempDir dir;
  for (const std::string_view a : ray_formats()) {
    for (const std::string_view b : ray_formats()) {
      for (const std::size_t n : {0, 1, 3, 1001}) {
        const RaySet set = radiant_set(n);
        write_ray_set(dir / "a", set, a);
        const RaySet first = read_ray_set(dir / "a");
        write_ray_set(dir / "b", first, b);
        const RaySet second = read_ray_set(dir / "b");
        ASSERT_EQ(bare(second.rays), kept_by(b, kept_by(a, bare(set.rays))))
            << a << " to " << b << ", " << n << " rays";
        ASSERT_EQ(second.header.flux_unit, FluxUnit::watt) << a << " to " << b;
        if (a != "zemax-text" && b != "zemax-text") {
          ASSERT_EQ(second.header.flux(), 1.25) << a << " to " << b;
        }
      }
    }
  }
}

TEST(RayFile, EveryFormatKeepsLumens) {
  const TempDir dir;
  for (const std::string_view format : ray_formats()) {
    const RaySet set = random_ray_set(77, 3);
    write_ray_set(dir / "a", set, format);
    EXPECT_EQ(detect_ray_format(dir / "a"), format);
    const RaySet back = read_ray_set(dir / "a");
    EXPECT_EQ(back.header.flux_unit, FluxUnit::lumen) << format;
    EXPECT_EQ(bare(back.rays), kept_by(format, set.rays)) << format;
    if (format != "zemax-text") {
      EXPECT_EQ(back.header.flux(), 337.5) << format;
    }
  }
}

TEST(RayFile, WavelengthsSurviveWhereThereIsAPlaceAndAWarningSaysWhereNot) {
  const TempDir dir;
  for (const std::string_view format : ray_formats()) {
    const RaySet set = radiant_set(501, kWavelength);
    const auto warnings = write_ray_set(dir / "a", set, format);
    const RaySet back = read_ray_set(dir / "a");
    EXPECT_EQ(bare(back.rays), kept_by(format, bare(set.rays))) << format;
    if (format == "asap") {
      EXPECT_THAT(warnings, Contains(HasSubstr("wavelength nm")));
      continue;
    }
    ASSERT_EQ(back.header.columns, kWavelength) << format;
    for (std::size_t i = 0; i < 501; ++i) {
      const float there = set.rays.extra[0][i];
      // Micrometres in between cost at most one unit in the last place.
      ASSERT_NEAR(back.rays.extra[0][i], there, there * 1.2e-7F) << format;
    }
  }
}

TEST(RayFile, OddColumnsAndTablesAreKeptOrNamed) {
  RaySet set = radiant_set(9, {{ColumnKind::additional, "phase"},
                               {ColumnKind::wavelength_nm, "wavelength nm"},
                               {ColumnKind::additional, "q"}});
  set.header.spectra = {{{400.0F, 500.0F}, {1.0F, 2.0F}}};
  set.header.texts.manufacturer = "maker";
  const TempDir dir;
  for (const std::string_view format : ray_formats()) {
    const auto warnings = write_ray_set(dir / "a", set, format);
    const RaySet back = read_ray_set(dir / "a");
    EXPECT_EQ(bare(back.rays), kept_by(format, bare(set.rays))) << format;
    if (format == "tm25") continue;
    EXPECT_THAT(warnings, Contains(HasSubstr("texts"))) << format;
    if (format != "speos" && format != "mcpl") {
      EXPECT_THAT(warnings, Contains(HasSubstr("spectral table"))) << format;
    }
    if (format == "text") {
      EXPECT_EQ(back.rays.extra, set.rays.extra);
    } else {
      EXPECT_THAT(warnings, AllOf(Contains(HasSubstr("'phase'")), Contains(HasSubstr("'q'")))) << format;
    }
  }
}

TEST(RayFile, LengthUnitsComeBackAsMillimetres) {
  const TempDir dir;
  const RaySet set = radiant_set(50);
  const std::pair<std::string_view, std::vector<std::string>> units[] = {
      {"zemax-binary", {"m", "inch", "cm", "feet", "mm"}},
      {"lighttools-binary", {"cm", "m", "inch", "feet", "um", "nm"}},
      {"asap", {"mm", "cm", "m", "inch"}},
      {"zemax-text", {"m", "inch", "cm", "feet"}},
      {"lighttools-ascii", {"cm", "inch"}}};
  for (const auto& [format, names] : units) {
    if (std::ranges::find(ray_formats(), format) == ray_formats().end()) continue;
    for (const std::string& unit : names) {
      write_ray_set(dir / "a", set, format, {.length_unit = unit});
      const auto reader = open_ray_file(dir / "a");
      EXPECT_EQ(reader->length_unit(), unit) << format;
      RayBlock rays;
      reader->read(rays, 100);
      for (std::size_t i = 0; i < 50; ++i)
        ASSERT_NEAR(rays.z_mm[i], set.rays.z_mm[i], 3e-6) << format << " " << unit;
    }
    EXPECT_THROW(write_ray_set(dir / "a", set, format, {.length_unit = "furlong"}), UsageError);
  }
}

TEST(RayFileFuzz, EveryTruncationIsAnErrorOrASpeosFileOfFewerRays) {
  const TempDir dir;
  for (const std::string_view format : ray_formats()) {
    if (format == "tm25") continue;  // tm25_test.cpp
    write_ray_set(dir / "a", radiant_set(3), format);
    const std::string good = bytes_of(dir / "a");
    const bool has_end = format != "speos" && format != "text";
    for (std::size_t size = 0; size < good.size(); ++size) {
      put_bytes(dir / "a", std::string_view(good).substr(0, size));
      const std::string message = message_of<InputError>([&] { read_ray_set(dir / "a"); });
      EXPECT_THAT(message, ::testing::Not(HasSubstr("\n")));
      // The last line's end, and what is behind the last number, may go.
      const bool whole =
          format.ends_with("text") || format.ends_with("ascii") ? size + 16 >= good.size() : false;
      if (has_end && !whole) {
        EXPECT_THAT(message, HasSubstr("expected")) << format << " " << size;
      }
      message_of<InputError>([&] { EXPECT_LE(read_ray_set(dir / "a", {.salvage = true}).rays.size(), 3u); });
    }
  }
}

/// A SPEOS file does not say how long its records are.
TEST(RayFile, ACutSpeosFileIsNotTakenForOneWithPolarisation) {
  const TempDir dir;
  write_ray_set(dir / "a", radiant_set(40), "speos");
  const std::string good = bytes_of(dir / "a");
  for (const std::size_t records : {13U, 21U}) {
    put_bytes(dir / "b", std::string_view(good).substr(0, 28 + 52 * records));
    const std::string message = message_of<InputError>([&] { read_ray_set(dir / "b"); });
    EXPECT_THAT(message, HasSubstr("whole rays of 32 bytes expected")) << message;
    EXPECT_EQ(read_ray_set(dir / "b", {.salvage = true}).rays.size(), 52 * records / 32);
  }
  // The same rays with five numbers more each; the last one cut.
  std::string polarised = good.substr(0, 28);
  for (std::size_t ray = 0; ray < 40; ++ray)
    polarised += good.substr(28 + 32 * ray, 32) + std::string(20, '\0');
  put_bytes(dir / "c", polarised);
  const RaySet set = read_ray_set(dir / "a"), more = read_ray_set(dir / "c");
  EXPECT_EQ(more.rays.kx, set.rays.kx);
  EXPECT_EQ(more.rays.extra.size(), set.rays.extra.size() + 5);
  put_bytes(dir / "c", std::string_view(polarised).substr(0, polarised.size() - 20));
  EXPECT_THAT(message_of<InputError>([&] { read_ray_set(dir / "c"); }), HasSubstr("whole rays of 52 bytes"));
}

TEST(RayFileFuzz, MutatedFilesAreReadOrRefused) {
  const TempDir dir;
  for (const std::string_view format : ray_formats()) {
    write_ray_set(dir / "a", radiant_set(3, kWavelength), format);
    const std::string good = bytes_of(dir / "a");
    for (std::uint64_t trial = 0; trial < 300; ++trial) {
      Rng rng(17, trial);
      std::string bad = good;
      for (std::uint32_t k = 0; k <= rng.bits() % 4; ++k) {
        // Half of the changes in the first 400 bytes, where the counts are.
        const std::size_t range = rng.bits() % 2 == 0 ? std::min<std::size_t>(400, bad.size()) : bad.size();
        bad[rng.bits() % range] = static_cast<char>(rng.bits());
      }
      put_bytes(dir / "a", bad);
      for (const bool salvage : {false, true}) {
        try {
          EXPECT_LE(read_ray_set(dir / "a", {.salvage = salvage, .format = std::string(format)}).rays.size(),
                    10u);
        } catch (const InputError& error) {
          EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        }
      }
    }
  }
}

TEST(RayFile, NamesAreChecked) {
  EXPECT_THAT(message_of<UsageError>([] { ray_format_for("a.tm25ray", "tm26"); }),
              AllOf(HasSubstr("tm26"), HasSubstr("speos")));
  EXPECT_EQ(ray_format_for("a.TM25RAY"), "tm25");
  EXPECT_EQ(ray_format_for("a.ray", "speos"), "speos");
  EXPECT_EQ(ray_format_for("a.mcpl"), "mcpl");
  EXPECT_THROW(ray_format_for("a.ray"), UsageError);
  EXPECT_THROW(open_ray_file("/nonexistent/file"), InputError);
  EXPECT_THROW(create_ray_file("/nonexistent/file", "tm25", {}, 0), InputError);
}

struct RealFile {
  const char* name;
  const char* format;
  std::size_t rays;
  FluxUnit unit;
  double flux;
};

// GoogleTest looks for this name. NOLINTNEXTLINE(readability-identifier-naming)
void PrintTo(const RealFile& file, std::ostream* out) { *out << file.name; }

class RealFileData : public ::testing::TestWithParam<RealFile> {};

TEST_P(RealFileData, HasTheRaysAndFluxThatItsMakerSays) {
  const RealFile& expected = GetParam();
  LUCERNA_DATA_FILE(path, std::string("rayfiles/") + expected.name);
  if (std::ranges::find(ray_formats(), expected.format) == ray_formats().end()) GTEST_SKIP();
  const auto reader = open_ray_file(path);
  EXPECT_EQ(reader->format(), expected.format);
  EXPECT_EQ(reader->ray_count(), expected.rays);
  RayBlock rays;
  std::size_t count = 0;
  while (const std::size_t n = reader->read(rays, 777)) count += n;
  EXPECT_EQ(count, expected.rays);
  EXPECT_EQ(reader->header().flux_unit, expected.unit);
  EXPECT_NEAR(reader->header().flux().value_or(0.0), expected.flux, 1e-6 * expected.flux);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealFileData,
    ::testing::Values(
        RealFile{"Cyl10k.1.ray", "lighttools-ascii", 10000, FluxUnit::lumen, 1.0},
        RealFile{"ThreeRays_PowerOnly.1.ray", "lighttools-binary", 3, FluxUnit::watt, 0.003106601},
        RealFile{"ThreeRays_Wavelength.1.ray", "lighttools-binary", 3, FluxUnit::watt, 0.003106601},
        RealFile{"ThreeRays_Wavelength.1.txt", "lighttools-ascii", 3, FluxUnit::watt, 0.003106601},
        RealFile{"ThreeRays_Wavelength_ZMX.ray", "zemax-binary", 3, FluxUnit::watt, 0.003106601},
        RealFile{"ZemaxText.txt", "zemax-text", 9, FluxUnit::watt, 0.0},
        RealFile{"ZemaxWavelengthText.txt", "zemax-text", 9, FluxUnit::watt, 0.0},
        RealFile{"ansys_test_08_dat.DAT", "zemax-binary", 11, FluxUnit::watt, 1.0},
        RealFile{"ansys_test_08_dat_flux_type_1.dat", "zemax-binary", 1, FluxUnit::lumen, 1.0},
        RealFile{"ansys_test_08_dat_reference.ray", "speos", 11, FluxUnit::watt, 1.0},
        RealFile{"ansys_test_08_ray.ray", "speos", 11, FluxUnit::watt, 1.0},
        RealFile{"ansys_test_08_ray_reference.sdf", "zemax-binary", 11, FluxUnit::watt, 1.0},
        RealFile{"ansys_test_08_sdf_reference.ray", "speos", 11, FluxUnit::watt, 1.0},
        RealFile{"pyspeos_Rays.ray", "speos", 45462, FluxUnit::watt, 4.01765776}));

TEST(DamagedFilesData, AreReportedAndSalvaged) {
  LUCERNA_DATA_FILE(swapped, "rayfiles/ansys_test_08_sdf.sdf");
  EXPECT_THAT(message_of<InputError>([&] { read_ray_set(swapped); }), HasSubstr("swapped"));
  const RaySet right = read_ray_set(swapped, {.salvage = true});
  EXPECT_EQ(right.rays.size(), 11u);
  EXPECT_EQ(right.rays.weight[0], 1.0F);
  EXPECT_NEAR(right.rays.extra[0][0], 486.0F, 1e-3F);
  LUCERNA_DATA_FILE(cut, "rayfiles/pyspeos_RaysWithoutSpectralData.RAY");
  EXPECT_THAT(message_of<InputError>([&] { read_ray_set(cut); }),
              AllOf(HasSubstr("LTRFEND"), HasSubstr("113 rays")));
  const RaySet whole = read_ray_set(cut, {.salvage = true});
  EXPECT_EQ(whole.rays.size(), 113u);
  EXPECT_EQ(whole.header.flux(), 55.0);
  EXPECT_NEAR(whole.rays.weight[0], 1.1e-4F, 1e-9F);
}

}  // namespace
}  // namespace lucerna
