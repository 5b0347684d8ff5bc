// SPDX-License-Identifier: Apache-2.0
// Wavelengths of sources, and solids that disperse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/material.h"
#include "lucerna/project.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kDisk = "[[source]]\nkind = 'disk'\nposition_mm = [0, 0, -5]\n";
constexpr const char* kLens =
    "[[body]]\nrole = 'solid'\noutline_mm = [[0, 0], [5, 0], [5, 2], [0, 4]]\nmaterial = 'pmma'\n"
    "dispersion = true\n";

class ProjectColour : public testing::Test {
 protected:
  Project read(const std::string& text) {
    write_file(dir_ / "p.toml", text);
    return read_project(dir_ / "p.toml");
  }
  std::string message(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& e) {
      return e.what();
    }
    return {};
  }

  test::TempDir dir_;
};

TEST_F(ProjectColour, OneWavelengthOrASpectrumBelongsToASource) {
  const Project line = read(std::string(kDisk) + "wavelength_nm = 450\n" + kLens);
  EXPECT_EQ(line.scene.sources.at(0).spectrum, (SpectralTable{{450.0F}, {1.0F}}));
  EXPECT_TRUE(line.warnings.empty());
  ASSERT_NE(line.scene.solids.at(0).dispersion, nullptr);
  EXPECT_NEAR(line.scene.solids[0].dispersion->index(450.0), refractive_index("pmma", 450.0).n, 1e-5);
  EXPECT_EQ(line.scene.solids[0].refractive_index, refractive_index("pmma", 555.0).n);

  write_file(dir_ / "white.csv", "nm, power\n430, 0.1\n455, 1\n600, 0.7\n");
  const Project white = read(std::string(kDisk) + "spectrum = 'white.csv'\n" + kLens);
  EXPECT_EQ(white.scene.sources.at(0).spectrum,
            (SpectralTable{{430.0F, 455.0F, 600.0F}, {0.1F, 1.0F, 0.7F}}));
  EXPECT_THAT(white.inputs, testing::Contains(dir_ / "white.csv"));
  EXPECT_TRUE(white.warnings.empty());
}

TEST_F(ProjectColour, WavelengthsThatAMediumDoesNotKnowAreTold) {
  write_file(dir_ / "near_uv.csv", "320 1\n520 1\n");
  const Project project = read(std::string(kDisk) + "flux_w = 1\nspectrum = 'near_uv.csv'\n" + kLens);
  ASSERT_EQ(project.warnings.size(), 1U);
  EXPECT_THAT(project.warnings[0],
              testing::ContainsRegex("source\\[0\\]: some (49|50|51)[.0-9]* % of its light"));
  EXPECT_THAT(project.warnings[0], HasSubstr("out of 420 to 1620 nm: in 'solid'"));
}

TEST_F(ProjectColour, WhatIsMissingOrMisplacedIsNamed) {
  const auto expect = [&](const std::string& text, const std::string& part) {
    EXPECT_THAT(message(text), HasSubstr(part)) << text;
  };
  const std::string disk = kDisk, lens = kLens;
  expect(disk + lens, "source 1: found no wavelengths, expected a spectrum");
  expect(disk + "wavelength_nm = 450\nspectrum = 'a.csv'\n" + lens,
         "source[0].spectrum: found `wavelength_nm`");
  expect(disk + "wavelength_nm = 0\n" + lens, "source[0].wavelength_nm");
  expect(disk + "spectrum = 'absent.csv'\n" + lens, "absent.csv");
  write_file(dir_ / "a.csv", "400 1 2\n500 1 2\n");
  expect(disk + "spectrum = 'a.csv'\n" + lens, "found 2 lines of 3 numbers, expected lines of two");
  write_file(dir_ / "a.csv", "");
  expect(disk + "spectrum = 'a.csv'\n" + lens, "expected lines of two");
  write_file(dir_ / "a.csv", "500 1\n400 1\n");
  expect(disk + "spectrum = 'a.csv'\n" + lens,
         "a.csv: found 400 nm after 500, expected wavelengths to ascend");
  const std::string plain = "[[body]]\nrole = 'solid'\noutline_mm = [[0, 0], [5, 0], [5, 2], [0, 4]]\n";
  expect(disk + plain + "dispersion = true\n", "body[0].dispersion: belongs to `material` or `catalogue`");
  expect(disk + "[[body]]\nrole = 'glass'\ndiameter_mm = 9\nmaterial = 'bk7'\ndispersion = true\n",
         "body[0].dispersion: belongs to role = \"solid\"");
}

}  // namespace
}  // namespace lucerna
