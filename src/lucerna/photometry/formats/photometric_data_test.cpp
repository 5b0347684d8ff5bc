// SPDX-License-Identifier: Apache-2.0
// Real files of makers and laboratories against figures computed by other programs
// (data/photometry/expected_summary.csv).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "lucerna/photometric_metrics.h"
#include "tests/support/data_dir.h"

namespace lucerna {
namespace {

struct Expected {
  std::string file, format, type, symmetry, unit;
  double planes, gammas, peak, peak_h, peak_v, flux;
  std::string nadir_spread;
};

std::vector<Expected> read_expected(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  std::vector<Expected> rows;
  while (std::getline(in, line)) {
    if (line.ends_with('\r')) line.pop_back();
    std::vector<std::string> cells;
    std::istringstream parts(line);
    for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
    while (cells.size() < 13) cells.emplace_back();
    rows.push_back({cells[0], cells[1], cells[2], cells[3], cells[6], std::stod(cells[4]),
                    std::stod(cells[5]), std::stod(cells[7]), std::stod(cells[8]), std::stod(cells[9]),
                    std::stod(cells[10]), cells[12]});
  }
  return rows;
}

/// What the table's figures are in: cd and lm of the file, of 1000 lm of lamps, or of its own radiometric
/// unit.
double table_unit(const PhotometricFile& file, const Expected& row) {
  if (row.unit == "cd/klm") return 1000.0 / file.luminaire.lamps.front().flux_lm;
  return file.distribution.unit == FluxUnit::watt ? 1000.0 : 1.0;  // the one radiometric file is in mW
}

TEST(PhotometricFilesData, AgreeWithTheSummary) {
  LUCERNA_DATA_FILE(table, "photometry/expected_summary.csv");
  const auto rows = read_expected(table);
  ASSERT_EQ(rows.size(), 23u);
  for (const Expected& row : rows) {
    SCOPED_TRACE(row.file);
    const PhotometricFile file = read_photometric_file(table.parent_path() / row.file);
    EXPECT_EQ(grid_fault(file.distribution), "");
    EXPECT_EQ(std::string(1, file.origin.type), row.type);
    EXPECT_EQ(file.origin.symmetry, row.symmetry);
    EXPECT_EQ(file.origin.planes, row.planes);
    EXPECT_EQ(file.origin.gammas, row.gammas);
    const double unit = table_unit(file, row);
    EXPECT_NEAR(total_flux(file.distribution) * unit, row.flux, 0.0051);
    if (row.type == "C") {
      EXPECT_NEAR(peak_intensity(file.distribution).cd * unit, row.peak, 0.0051);
      EXPECT_NEAR(intensity_at(file.distribution, row.peak_h, row.peak_v) * unit, row.peak, 0.0051);
    }
    if (!row.nadir_spread.empty()) {
      EXPECT_NEAR(100.0 * file.origin.nadir_spread, std::stod(row.nadir_spread), 0.051);
    }
  }
}

// AGi32's Photometric Toolbox, to the last digit that it prints.
TEST(PhotometricFilesData, FluxIsTheTradesToTheLastDigit) {
  const std::map<std::string, double> lumens{
      {"cu_1.ies", 9217.18}, {"cu_2.ies", 5834.2}, {"cu_3.ies", 13359.57}, {"cu_4.ies", 5821.76}};
  for (const auto& [name, lm] : lumens) {
    LUCERNA_DATA_FILE(path, "photometry/" + name);
    EXPECT_NEAR(total_flux(read_photometric_file(path).distribution), lm, 0.00501) << name;
  }
}

/// Largest difference between two files over a grid of directions, in percent of the peak.
double difference_percent(const IntensityDistribution& a, const IntensityDistribution& b) {
  double worst = 0.0;
  for (double c = 0.0; c < 360.0; c += 5.0) {
    for (double g = 0.0; g <= 90.0; g += 2.5)
      worst = std::max(worst, std::abs(intensity_at(a, c, g) - intensity_at(b, c, g)));
  }
  return 100.0 * worst / peak_intensity(a).cd;
}

// One lamp in both formats. The Isym 3 pair fixes the order of EULUMDAT's planes: reversed, it does not
// match.
TEST(PhotometricFilesData, PairsOfOneLampAreEqual) {
  for (const char* stem : {"luxpy_Testlamp_Isym1_007cfb11e343e2f42e3b476be4ab684e",
                           "luxpy_Testlamp_Isym3_symmetryOverC90C270axis",
                           "luxpy_Testlamp_Isym4_43cef5d76a391dd85c41d4d09d68600d"}) {
    LUCERNA_DATA_FILE(ldt, std::string("photometry/") + stem + ".ldt");
    LUCERNA_DATA_FILE(ies, std::string("photometry/") + stem + ".ies");
    const PhotometricFile a = read_photometric_file(ldt), b = read_photometric_file(ies);
    EXPECT_LT(difference_percent(a.distribution, b.distribution), 0.02) << stem;
  }
  LUCERNA_DATA_FILE(ldt, "photometry/luxpy_Testlamp_Isym3_symmetryOverC90C270axis.ldt");
  LUCERNA_DATA_FILE(ies, "photometry/luxpy_Testlamp_Isym3_symmetryOverC90C270axis.ies");
  const PhotometricFile a = read_photometric_file(ldt), b = read_photometric_file(ies);
  const PhotometricFile reversed = read_photometric_file(ldt, {.isym3 = Isym3Order::reversed});
  EXPECT_GT(difference_percent(reversed.distribution, b.distribution), 10.0);
  // Sizes swap with H = C: IES 0.3 x 0.2 m is width x length.
  EXPECT_DOUBLE_EQ(a.luminaire.luminous_length_mm, b.luminaire.luminous_length_mm);
  EXPECT_DOUBLE_EQ(a.luminaire.luminous_width_mm, b.luminaire.luminous_width_mm);
}

TEST(PhotometricFilesData, EveryFileSurvivesConversion) {
  LUCERNA_DATA_FILE(table, "photometry/expected_summary.csv");
  for (const Expected& row : read_expected(table)) {
    SCOPED_TRACE(row.file);
    const PhotometricFile file = read_photometric_file(table.parent_path() / row.file);
    for (const PhotometricFormat format :
         {PhotometricFormat::ies_2002, PhotometricFormat::ies_2019, PhotometricFormat::ldt}) {
      if (format == PhotometricFormat::ldt && file.distribution.unit == FluxUnit::watt) continue;
      const std::string text = format == PhotometricFormat::ldt ? ldt_text(file) : ies_text(file, format);
      const PhotometricFile back = format == PhotometricFormat::ldt
                                       ? read_ldt(text, "back", {.strict = true})
                                       : read_ies(text, "back", {.strict = true});
      const double flux = total_flux(file.distribution);
      EXPECT_NEAR(total_flux(back.distribution), flux, 1e-6 * flux);
      EXPECT_LT(difference_percent(file.distribution, back.distribution), 1e-3);
    }
  }
}

TEST(PhotometricFilesData, TypeBKeepsItsBeam) {
  LUCERNA_DATA_FILE(path, "photometry/cu_flood_2.1.ies");
  const PhotometricFile file = read_photometric_file(path);
  EXPECT_NEAR(total_flux(file.distribution), 10680.22, 0.005);
  // V -15, H 19.5: below the axis, to both sides.
  const double v = radians(-15.0), h = radians(19.5);
  const double gamma = degrees(std::acos(std::cos(v) * std::cos(h)));
  const double c = degrees(std::atan2(std::sin(h), std::sin(v) * std::cos(h)));
  EXPECT_NEAR(intensity_at(file.distribution, c, gamma), 5287.0, 60.0);
  EXPECT_NEAR(intensity_at(file.distribution, -c, gamma), 5287.0, 60.0);
}

}  // namespace
}  // namespace lucerna
