// SPDX-License-Identifier: Apache-2.0
// The odd and broken files of tests/data/photometry: each gives the value or the message that its name calls
// for.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/data/symmetry.h"
#include "tests/support/paths.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

std::filesystem::path own(const std::string& name) {
  return test::source_dir() / "tests/data/photometry" / ("own_" + name);
}

/// What a file must read as: intensity at C, gamma and the repair (or note) that says so; empty = none at
/// all.
struct Case {
  const char* file;
  double c_deg, gamma_deg, cd;
  const char* repair;  ///< part of a repair's text; "" = no repair
  const char* note;    ///< part of a note's text; "" = any
};

const Case kCases[] = {
    {"ies_1986_no_version_label_lines.ies", 0, 10, 969.846 * 0.95, "", "ballast factor 0.95"},
    {"ies_1995_90_to_270.ies", 0, 0, 1000, "nadir", ""},
    {"ies_1995_90_to_270.ies", 270, 60, 150, "nadir", ""},
    {"ies_1995_90_to_270.ies", 45, 30, 962.132, "nadir", ""},
    {"ies_1995_width_only_negative.ies", 0, 30, 750, "", ""},
    {"ies_2019_fgt_1.00010_simulation.ies", 0, 30, 750, "", ""},
    {"ies_2019_fgt_1.10100_accredited_scaled.ies", 0, 30, 750, "", ""},
    {"ies_ballast_factor_0.88_relative_2lamps.ies", 0, 30, 660, "", "ballast factor 0.88"},
    {"ies_comma_decimals_illegal.ies", 0, 10, 969.846, "commas read as decimal points", ""},
    {"ies_comma_delimited_legal.ies", 0, 10, 969.846, "", ""},
    {"ies_cr_only.ies", 0, 10, 969.846, "", ""},
    {"ies_extra_trailing_values_and_comment.ies", 0, 10, 969.846, "left over", ""},
    {"ies_feet_round_negative_width.ies", 0, 10, 969.846, "", ""},
    {"ies_four_digit_exponent.ies", 0, 10, 969.8463104, "", ""},
    {"ies_missing_360_plane.ies", 337.5, 0, 1000, "end at 315", ""},
    {"ies_missing_record2.ies", 0, 10, 969.846, "record of ballast factor", ""},
    {"ies_multiplier_2.5.ies", 0, 30, 1875, "", "multiplier 2.5"},
    {"ies_nadir_not_equal.ies", 90, 0, 1000, "nadir differs between planes by 4.00 %", ""},
    {"ies_negative_candela.ies", 0, 90, 0, "negative intensities", ""},
    {"ies_no_final_newline.ies", 0, 10, 969.846, "", ""},
    {"ies_one_value_per_line_tabs.ies", 0, 10, 969.846, "", ""},
    {"ies_radiometric_mW_sr.ies", 0, 30, 0.75, "[MANUFAC]", ""},
    {"ies_tilt_file_missing.ies", 0, 10, 969.846, "LAMP123.TLT", ""},
    {"ies_tilt_include.ies", 0, 10, 969.846, "", "4 tilt factors"},
    {"ies_tilt_spaces_lowercase.ies", 0, 10, 969.846, "read as TILT=NONE", ""},
    {"ies_type_A_H_symmetric.ies", 90, 0, 2000, "", "type A turned"},
    {"ies_type_A_full.ies", 90, 30, 632.8, "", "type A turned"},
    {"ies_type_B_full.ies", 0, 30, 632.8, "", "type B turned"},
    {"ies_up_light_90_180.ies", 0, 150, 866.025, "", ""},
    {"ies_utf8_bom_crlf.ies", 0, 10, 969.846, "[TESTLAB]", ""},
    {"ies_version_with_space.ies", 0, 10, 969.846, "header 'IESNA: LM-63-2002'", ""},
    {"ies_vertical_ends_at_85.ies", 0, 85, 7.596, "vertical angles end at 85", ""},
    {"ldt_absolute_negative_lamps.ldt", 0, 30, 750 * 0.85, "", "absolute photometry"},
    {"ldt_bom_utf8.ldt", 0, 10, 969.85, "", ""},
    {"ldt_comma_decimals.ldt", 0, 10, 969.85, "decimal comma", ""},
    {"ldt_conversion_factor_2.ldt", 0, 30, 1500, "", "conversion factor 2"},
    {"ldt_cp1252_name.ldt", 0, 10, 969.85, "", ""},
    {"ldt_isym1_but_ityp2_blank_numbers.ldt", 0, 10, 969.85, "is blank: 0 taken", ""},
    {"ldt_isym1_mc1.ldt", 200, 30, 750, "", ""},
    {"ldt_isym4.ldt", 180, 30, 900, "nadir", ""},
    {"ldt_trailing_blank_and_eof.ldt", 0, 10, 969.85, "", ""},
    {"ldt_two_lamp_sets.ldt", 0, 30, 750 * 6.6, "", "HIT 70W"},
};

bool mentions(const std::vector<Diagnostic>& faults, const std::string& text) {
  for (const Diagnostic& fault : faults) {
    if (fault.text.find(text) != std::string::npos) return true;
  }
  return false;
}

std::string all(const std::vector<Diagnostic>& faults) {
  std::string text;
  for (const Diagnostic& fault : faults) text += fmt::format("[{}] ", to_string(fault));
  return text;
}

TEST(PhotometricIo, OddFilesGiveWhatTheirNameCallsFor) {
  for (const Case& expected : kCases) {
    SCOPED_TRACE(expected.file);
    const PhotometricFile file = read_photometric_file(own(expected.file));
    // The resampled types A and B are linear between angles 15 degrees apart.
    const double tolerance = file.origin.type == 'C' ? 1e-9 * expected.cd + 1e-12 : 0.08 * expected.cd;
    EXPECT_NEAR(intensity_at(file.distribution, expected.c_deg, expected.gamma_deg), expected.cd, tolerance);
    if (std::string(expected.repair).empty()) {
      EXPECT_TRUE(file.repairs.empty()) << all(file.repairs);
      EXPECT_NO_THROW(read_photometric_file(own(expected.file), {.strict = true}));
    } else {
      EXPECT_TRUE(mentions(file.repairs, expected.repair)) << all(file.repairs);
      EXPECT_THROW(read_photometric_file(own(expected.file), {.strict = true}), InputError);
    }
    EXPECT_TRUE(mentions(file.notes, expected.note) || std::string(expected.note).empty()) << all(file.notes);
  }
}

TEST(PhotometricIo, BrokenFilesNameLineFoundAndExpected) {
  const auto message = [](const std::string& name) {
    try {
      read_photometric_file(own(name));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("read");
  };
  EXPECT_NE(message("ies_too_few_candela.ies").find(": line 7: 10 vertical and 4 horizontal"),
            std::string::npos)
      << message("ies_too_few_candela.ies");
  EXPECT_NE(message("ldt_truncated.ldt").find("40 intensities expected"), std::string::npos)
      << message("ldt_truncated.ldt");
}

TEST(PhotometricIo, SidesOfIsym2And3) {
  const PhotometricFile two = read_photometric_file(own("ldt_isym2.ldt"));
  EXPECT_GT(intensity_at(two.distribution, 0, 30), intensity_at(two.distribution, 180, 30));
  EXPECT_DOUBLE_EQ(intensity_at(two.distribution, 90, 30), intensity_at(two.distribution, 270, 30));
  const PhotometricFile spec = read_photometric_file(own("ldt_isym3_spec_order_C270_to_C90.ldt"));
  EXPECT_DOUBLE_EQ(intensity_at(spec.distribution, 270, 30), 450.0);
  EXPECT_DOUBLE_EQ(intensity_at(spec.distribution, 90, 30), 1050.0);
  EXPECT_DOUBLE_EQ(intensity_at(spec.distribution, 0, 30), intensity_at(spec.distribution, 180, 30));
  const PhotometricFile reversed =
      read_photometric_file(own("ldt_isym3_reversed_order_qlumedit.ldt"), {.isym3 = Isym3Order::reversed});
  EXPECT_DOUBLE_EQ(intensity_at(reversed.distribution, 90, 30), 1050.0);
  EXPECT_TRUE(
      mentions(check_photometric_file(own("ldt_isym3_reversed_order_qlumedit.ldt")), "isym3 reversed"));
  EXPECT_FALSE(
      mentions(check_photometric_file(own("ldt_isym3_spec_order_C270_to_C90.ldt")), "isym3 reversed"));
  const PhotometricFile none = read_photometric_file(own("ldt_isym0.ldt"));
  EXPECT_EQ(none.distribution.c_deg.size(), 4u);
}

TEST(PhotometricIo, FilesMayBeUtf16) {
  const test::TempDir dir;
  for (const char* const name : {"ldt_isym0.ldt", "ies_feet_round_negative_width.ies"}) {
    std::string wide = "\xFF\xFE";
    for (const char c : read_file(own(name), 1 << 20)) wide += {c, '\0'};
    write_file(dir / name, wide);
    EXPECT_EQ(read_photometric_file(dir / name).distribution.cd,
              read_photometric_file(own(name)).distribution.cd)
        << name;
  }
}

TEST(PhotometricIo, SizesAndText) {
  const LuminaireData feet = read_photometric_file(own("ies_feet_round_negative_width.ies")).luminaire;
  EXPECT_DOUBLE_EQ(feet.luminous_length_mm, 152.4);
  EXPECT_EQ(feet.luminous_width_mm, 0.0);
  const LuminaireData old_round = read_photometric_file(own("ies_1995_width_only_negative.ies")).luminaire;
  EXPECT_DOUBLE_EQ(old_round.luminous_length_mm, 152.4);
  EXPECT_EQ(old_round.luminous_width_mm, 0.0);
  EXPECT_EQ(read_photometric_file(own("ldt_cp1252_name.ldt")).luminaire.manufacturer, "Müller");
  EXPECT_EQ(read_photometric_file(own("ldt_bom_utf8.ldt")).luminaire.manufacturer, "Müller");
  EXPECT_EQ(read_photometric_file(own("ies_utf8_bom_crlf.ies")).luminaire.manufacturer, "Müller");
  const LuminaireData relative =
      read_photometric_file(own("ies_ballast_factor_0.88_relative_2lamps.ies")).luminaire;
  EXPECT_FALSE(relative.absolute);
  EXPECT_EQ(relative.lamps.front().count, 2);
  EXPECT_EQ(relative.lamps.front().flux_lm, 3000.0);
}

TEST(PhotometricIo, HowTheLightWasFoundIsKept) {
  const PhotometricFile measured =
      read_photometric_file(own("ies_2019_fgt_1.10100_accredited_scaled.ies"), {.strict = true});
  EXPECT_EQ(measured.luminaire.generation_type, "1.10100");
  EXPECT_EQ(measured.luminaire.generation_info, "lumen scaled");
  const std::string text = ies_text(measured, PhotometricFormat::ies_2019);
  EXPECT_EQ(read_ies(text, "again", {.strict = true}).luminaire, measured.luminaire);
  // A factor of the ballast where 2019 has the type: not applied, and said.
  std::string wrong = text;
  wrong.replace(wrong.find("1.10100"), 7, "0.93");
  const PhotometricFile read = read_ies(wrong, "wrong", {});
  EXPECT_EQ(read.luminaire.generation_type, "");
  EXPECT_EQ(read.distribution.cd, measured.distribution.cd);
  ASSERT_EQ(read.repairs.size(), 1u);
  EXPECT_NE(ies_text(read, PhotometricFormat::ies_2019).find("\r\n1 1.00001 "), std::string::npos);
}

// 2000 cos^3: the flux of I0 cos^3 gamma over a hemisphere is 2 pi I0 / 4; 15 degree steps cost the trapezoid
// 2 to 3 %.
TEST(PhotometricIo, TypeAAndBHoldTheSameFlux) {
  const double exact = 2000.0 * 2.0 * std::numbers::pi / 9.0;
  for (const char* name : {"ies_type_A_full.ies", "ies_type_A_H_symmetric.ies", "ies_type_B_full.ies"}) {
    const PhotometricFile file = read_photometric_file(own(name));
    EXPECT_NEAR(total_flux(file.distribution), exact, 0.015 * exact) << name;
    EXPECT_NEAR(beam_metrics(file.distribution).peak.gamma_deg, 0.0, 1e-9) << name;
  }
}

TEST(PhotometricIo, TurnedReadingMovesC0AndKeepsSizes) {
  const auto path = own("ies_missing_360_plane.ies");
  const PhotometricFile plain = read_photometric_file(path);
  const PhotometricFile moved = read_photometric_file(path, {.ies_turn = IesTurn::minus_90});
  for (double h = 0.0; h < 360.0; h += 45.0) {
    EXPECT_NEAR(intensity_at(moved.distribution, h + 90.0, 40.0), intensity_at(plain.distribution, h, 40.0),
                1e-9);
  }
}

TEST(PhotometricIo, DetectsByContent) {
  for (const Case& each : kCases) EXPECT_TRUE(is_photometric_file(own(each.file))) << each.file;
  EXPECT_FALSE(is_photometric_file(own("no such file.ies")));
  EXPECT_FALSE(detect_photometric_format("TM25 ..."));
  EXPECT_FALSE(detect_photometric_format(std::string("IESNA91\n\0", 9)));
  std::string columns;
  for (int i = 0; i < 100; ++i) columns += "0.1 0.2 0.3 0 0 1 5\n";
  EXPECT_FALSE(detect_photometric_format(columns));
  EXPECT_EQ(detect_photometric_format("no header\nTILT=NONE\n"), PhotometricFormat::ies_2019);
}

TEST(PhotometricIo, CheckSortsByLineAndSurvivesErrors) {
  const auto faults = check_photometric_file(own("ies_too_few_candela.ies"));
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults.front().severity, Severity::error);
  EXPECT_EQ(faults.front().place, "line 7");
  EXPECT_TRUE(faults.front().text.starts_with("10 vertical")) << faults.front().text;
  const auto strict = check_photometric_file(own("ies_negative_candela.ies"), {.strict = true});
  EXPECT_TRUE(std::any_of(strict.begin(), strict.end(),
                          [](const Diagnostic& f) { return f.severity == Severity::error; }));
  const auto tolerant = check_photometric_file(own("ies_negative_candela.ies"));
  EXPECT_FALSE(std::any_of(tolerant.begin(), tolerant.end(),
                           [](const Diagnostic& f) { return f.severity == Severity::error; }));
  EXPECT_THROW(check_photometric_file("/no/such/file.ies"), InputError);
}

TEST(PhotometricIo, WritesAndReadsFiles) {
  const test::TempDir dir;
  const PhotometricFile file = read_photometric_file(own("ldt_isym4.ldt"));
  write_photometric_file(dir / "a.ies", file, PhotometricFormat::ies_2019);
  write_photometric_file(dir / "a.ldt", file, PhotometricFormat::ldt);
  EXPECT_EQ(find_symmetry(read_photometric_file(dir / "a.ies").distribution, 1e-3), Symmetry::both_planes);
  EXPECT_EQ(read_photometric_file(dir / "a.ldt").luminaire, file.luminaire);
}

}  // namespace
}  // namespace lucerna
