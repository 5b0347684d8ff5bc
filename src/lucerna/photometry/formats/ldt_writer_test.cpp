// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_file.h"

namespace lucerna {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    EXPECT_EQ(line.back(), '\r');
    line.pop_back();
    lines.push_back(line);
  }
  return lines;
}

PhotometricFile ldt_example() {
  PhotometricFile file;
  file.distribution = zero_distribution({0.0, 90.0, 180.0, 270.0}, {0.0, 45.0, 90.0});
  // Brighter to C90 than to C270, alike to both sides: Isym 3.
  file.distribution.cd = {100.0, 50.0, 0.0, 100.0, 80.0, 0.0, 100.0, 50.0, 0.0, 100.0, 20.0, 0.0};
  file.luminaire.manufacturer = "A\r\nB";
  file.luminaire.length_mm = 1200.0;
  file.luminaire.width_mm = 150.5;
  file.luminaire.luminous_length_mm = 1100.0;
  file.luminaire.luminous_width_mm = 100.0;
  return file;
}

TEST(LdtWriter, PutsEveryFieldOnItsLine) {
  const auto lines = lines_of(ldt_text(ldt_example()));
  // 25 lines, lamp count, 6 of the lamp, 10 ratios, 4 planes, 3 gammas, 3 stored planes of 3.
  ASSERT_EQ(lines.size(), 25u + 1 + 6 + 10 + 4 + 3 + 9);
  EXPECT_EQ(lines[0], "A  B");
  EXPECT_EQ(lines[2], "3");
  EXPECT_EQ(lines[3], "4");
  EXPECT_EQ(lines[4], "90");
  EXPECT_EQ(lines[5], "3");
  EXPECT_EQ(lines[6], "45");
  EXPECT_EQ(lines[12], "1200");
  EXPECT_EQ(lines[13], "150.5");
  EXPECT_EQ(lines[21], "100");  // all flux downward
  EXPECT_EQ(lines[22], "100");  // absolute: LORL 100
  EXPECT_EQ(lines[26], "-1");
  // Isym 3 is stored from C270 over C0 to C90.
  const double flux = std::stod(lines[28]);
  EXPECT_NEAR(std::stod(lines[50]) * flux / 1000.0, 20.0, 1e-4);
  EXPECT_NEAR(std::stod(lines[53]) * flux / 1000.0, 50.0, 1e-4);
  EXPECT_NEAR(std::stod(lines[56]) * flux / 1000.0, 80.0, 1e-4);
}

TEST(LdtWriter, RelativeValuesReferToTheFirstLampSet) {
  PhotometricFile file = ldt_example();
  file.luminaire.absolute = false;
  file.luminaire.lamps = {{.count = 2, .type = "T5", .flux_lm = 500.0}};
  const auto lines = lines_of(ldt_text(file));
  EXPECT_EQ(lines[26], "2");
  EXPECT_EQ(lines[28], "500");
  EXPECT_EQ(lines[49], "200");  // 100 cd for 500 lm
  file.luminaire.lamps.clear();
  EXPECT_THROW(ldt_text(file), InputError);
}

TEST(LdtWriter, OnePlaneIsIsym1) {
  PhotometricFile file;
  file.distribution = zero_distribution({0.0}, {0.0, 90.0});
  file.distribution.cd = {10.0, 5.0};
  const auto lines = lines_of(ldt_text(file));
  EXPECT_EQ(lines[1], "1");
  EXPECT_EQ(lines[2], "1");
  EXPECT_EQ(lines[3], "24");
  EXPECT_EQ(lines.size(), 25u + 1 + 6 + 10 + 24 + 2 + 2);
}

TEST(LdtWriter, RefusesWatts) {
  PhotometricFile file = ldt_example();
  file.distribution.unit = FluxUnit::watt;
  EXPECT_THROW(ldt_text(file), InputError);
}

}  // namespace
}  // namespace lucerna
