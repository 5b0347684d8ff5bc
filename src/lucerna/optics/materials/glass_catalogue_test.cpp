// SPDX-License-Identifier: Apache-2.0
#include "lucerna/glass_catalogue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/material.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::TempDir;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// The dispersion of the first is the published one of SCHOTT's N-BK7; all else is made up.
const char* const kCatalogue =
    "CC two glasses\r\n"
    "! a line of remarks\r\n"
    "NM CROWN-7 2.0 517642 1.516800 64.17 0 1 -1\r\n"
    "GC a remark\r\n"
    "ED 7.1 8.3 2.51 -0.0009 0\r\n"
    "CD 1.039612120E+000 6.000698670E-003 2.317923440E-001 2.001791440E-002 1.010469450E+000 "
    "1.035606530E+002 0.0 0.0 0.0 0.0\r\n"
    "TD 1.86E-6 1.31E-8 -1.37E-11 4.34E-7 6.27E-10 0.17 20.0\r\n"
    "OD 1.0 2.0 - - - -1\r\n"
    "LD 3.0E-001 2.5E+000\r\n"
    "IT 0.6 0.64 10\r\n"
    "IT 0.4 0.81 10\r\n"
    "IT 0.6 0.25 20\r\n"
    "IT 0.3 0 20\r\n"
    "NM Flint 1 620364 1.62 36.4\r\n"
    "CD 2.6244 0 0 0\r\n"
    "   0 0 0 0\r\n"
    "LD 0.4 0.7\r\n";

std::filesystem::path written(const TempDir& dir, const std::string& text) {
  std::ofstream(dir / "made.agf", std::ios::binary) << text;
  return dir / "made.agf";
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(GlassCatalogue, GlassesHaveTheIndexOfTheirFormula) {
  const TempDir dir;
  const auto file = written(dir, kCatalogue);
  EXPECT_THAT(glass_names(file), ElementsAre("CROWN-7", "Flint"));
  const CatalogueGlass crown = read_glass(file, "crown-7");
  EXPECT_EQ(crown.name, "CROWN-7");
  for (const double nm : {300.0, 404.66, 587.56, 1060.0, 2500.0})
    EXPECT_NEAR(glass_index(crown, nm), refractive_index("bk7", nm).n, 1e-9) << nm;
  EXPECT_NEAR(glass_index(read_glass(file, "FLINT"), 500.0), 1.62, 1e-12) << "coefficients on two lines";
}

TEST(GlassCatalogue, AbsorptionFollowsFromTheThickestPlate) {
  const TempDir dir;
  const auto file = written(dir, kCatalogue);
  const CatalogueGlass crown = read_glass(file, "CROWN-7");
  ASSERT_EQ(crown.transmittance.size(), 3u);
  EXPECT_NEAR(glass_absorption_per_mm(crown, 400.0), -std::log(0.81) / 10.0, 1e-12);
  EXPECT_NEAR(glass_absorption_per_mm(crown, 600.0), -std::log(0.25) / 20.0, 1e-12);
  const double half = 0.5 * (std::pow(0.81, 0.1) + std::pow(0.25, 0.05));
  EXPECT_NEAR(glass_absorption_per_mm(crown, 500.0), -std::log(half), 1e-12);
  EXPECT_THROW((void)glass_absorption_per_mm(crown, 300.0), InputError) << "no light passes";
  EXPECT_THROW((void)glass_absorption_per_mm(crown, 601.0), InputError);
  EXPECT_EQ(glass_absorption_per_mm(read_glass(file, "Flint"), 500.0), 0.0) << "none is stated";
}

TEST(GlassCatalogue, DispersionIsIndexAndAbsorptionOfEachWavelength) {
  const TempDir dir;
  const auto file = written(dir, kCatalogue);
  const CatalogueGlass crown = read_glass(file, "CROWN-7");
  const Dispersion d = dispersion(crown);
  EXPECT_EQ(d.min_nm(), 300.0);
  EXPECT_EQ(d.max_nm(), 2500.0);
  ASSERT_TRUE(d.has_absorption());
  for (const double nm : {400.0, 432.1, 500.0, 587.56, 600.0}) {
    EXPECT_NEAR(d.index(nm), glass_index(crown, nm), 1e-5) << nm;
    EXPECT_NEAR(d.absorption_per_mm(nm), glass_absorption_per_mm(crown, nm), 1e-5) << nm;
  }
  EXPECT_EQ(d.absorption_per_mm(900.0), d.absorption_per_mm(600.0)) << "that of the nearest";
  EXPECT_NEAR(d.absorption_per_mm(300.0), std::log(1e30), 1e-9) << "no light passes";
  EXPECT_FALSE(dispersion(read_glass(file, "Flint")).has_absorption());
}

// A resonance at 0.5 um within the range: below it the formula of this glass has no index.
TEST(GlassCatalogue, DispersionLeavesOutWhereTheFormulaFails) {
  const TempDir dir;
  const auto file =
      written(dir,
              "NM Odd 2 1 2.01207 60\nCD 1.2 0.01 0.5 0.25 0 0\nLD 0.3 1.5\nNM None 1 1 1.5 60\nCD "
              "-2 0 0 0 0 0\nLD 0.4 0.7\n");
  const CatalogueGlass odd = read_glass(file, "Odd");
  const Dispersion d = dispersion(odd);
  EXPECT_GT(d.min_nm(), 500.0);
  EXPECT_LT(d.min_nm(), 560.0) << "where the index falls below 4";
  EXPECT_DOUBLE_EQ(d.max_nm(), 1500.0);
  for (const double nm : {600.0, 587.56, 1200.0}) EXPECT_NEAR(d.index(nm), glass_index(odd, nm), 1e-4) << nm;
  EXPECT_THROW((void)dispersion(read_glass(file, "None")), InputError);
}

TEST(GlassCatalogue, IsReadInUtf16Too) {
  const TempDir dir;
  std::string wide = "\xFF\xFE";
  for (const char* c = kCatalogue; *c != '\0'; ++c) wide += {*c, '\0'};
  EXPECT_NEAR(glass_index(read_glass(written(dir, wide), "CROWN-7"), 587.56), 1.5168, 1e-5);
}

TEST(GlassCatalogue, KeepsToItsRange) {
  const TempDir dir;
  const CatalogueGlass crown = read_glass(written(dir, kCatalogue), "CROWN-7");
  for (const double nm : {299.0, 2501.0, std::nan("")}) {
    try {
      (void)glass_index(crown, nm);
      ADD_FAILURE() << nm;
    } catch (const InputError& e) {
      EXPECT_EQ(e.cause(), ErrorCause::out_of_range);
      EXPECT_THAT(e.what(), AllOf(HasSubstr("'CROWN-7'"), HasSubstr("300 to 2500 nm")));
    }
  }
}

TEST(GlassCatalogue, ErrorsNameTheLineAndWhatWasExpected) {
  struct Case {
    std::string from, to, glass;
    std::vector<std::string> says;
  };
  const std::vector<Case> cases{
      {"NM CROWN-7 2.0", "NM CROWN-7 14", "CROWN-7", {"line 3", "formula 14", "1 to 13"}},
      {"NM CROWN-7 2.0", "NM CROWN-7 2.5", "CROWN-7", {"line 3", "formula 2.5"}},
      {"NM Flint 1", "NM Flint", "Flint", {"line 14", "620364", "1 to 13"}},
      {"2.317923440E-001", "2.31792344OE-001", "CROWN-7", {"line 6", "'2.31792344OE-001'", "a number"}},
      {"   0 0 0 0\r\n", "", "Flint", {"4 coefficients", "expected 6 for formula 1"}},
      {"LD 3.0E-001 2.5E+000\r\n", "", "CROWN-7", {"'CROWN-7' has no range"}},
      {"LD 3.0E-001 2.5E+000", "LD 2.5 0.3", "CROWN-7", {"line 9", "from 2.5 to 0.3 um"}},
      {"LD 3.0E-001 2.5E+000", "LD 2.5", "CROWN-7", {"line 9", "1 numbers after LD, expected 2"}},
      {"IT 0.4 0.81 10", "IT 0.4 81 10", "CROWN-7", {"line 11", "transmittance of 81", "0 to 1"}},
      {"IT 0.4 0.81 10", "IT 0.4 0.81 0", "CROWN-7", {"line 11", "thickness of 0"}},
      {"IT 0.4 0.81 10", "IT -0.4 0.81 10", "CROWN-7", {"line 11", "wavelength of -0.4"}},
      {"IT 0.4 0.81 10", "IT 0.4 0.81", "CROWN-7", {"line 11", "2 numbers after IT, expected 3"}},
      {"1.516800", "1.5", "CROWN-7", {"1.516800 at 587.5618 nm by its formula 2", "1.5 is stated"}},
      {"CC", "CC", "CROWN-8", {"no glass 'CROWN-8'", "'CROWN-7'"}},
  };
  for (const Case& k : cases) {
    const TempDir dir;
    const auto file = written(dir, changed(kCatalogue, k.from, k.to));
    try {
      (void)read_glass(file, k.glass);
      ADD_FAILURE() << k.from << " -> " << k.to;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("made.agf")) << k.to;
      for (const std::string& text : k.says) EXPECT_THAT(e.what(), HasSubstr(text)) << k.to;
    }
    // The other glass is none the worse for it.
    if (k.glass == "CROWN-7") {
      EXPECT_EQ(read_glass(file, "Flint").formula, 1) << k.to;
    }
  }
}

TEST(GlassCatalogue, WithoutGlassesIsRefused) {
  const TempDir dir;
  for (const char* const text : {"", "CC nothing\n", "solid cube\n"}) {
    const auto file = written(dir, text);
    EXPECT_THROW((void)glass_names(file), InputError);
    EXPECT_THROW((void)read_glass(file, "CROWN-7"), InputError);
  }
  EXPECT_THROW((void)glass_names(dir / "absent.agf"), InputError);
}

// Wherever a file is cut, it is refused or the index is right: a coefficient that lost its last digits is
// caught by the index that is stated, or does not matter.
TEST(GlassCatalogue, CutAnywhereIsRefusedOrRight) {
  const std::string whole = kCatalogue;
  const TempDir dir;
  std::size_t right = 0;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const auto file = written(dir, whole.substr(0, size));
    try {
      EXPECT_NEAR(glass_index(read_glass(file, "CROWN-7"), 587.56), 1.5168, 1.01e-3) << size;
      ++right;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(right, 100u) << "the second glass is not needed";
}

}  // namespace
}  // namespace lucerna
