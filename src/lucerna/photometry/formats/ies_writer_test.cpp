// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_file.h"

namespace lucerna {
namespace {

PhotometricFile example() {
  PhotometricFile file;
  file.distribution = zero_distribution({0.0, 90.0, 180.0, 270.0}, {0.0, 45.0, 90.0});
  // Alike to C0 and C180, brighter to C90 than to C270.
  file.distribution.cd = {100.0, 50.0, 0.0, 100.0, 80.0, 0.0, 100.0, 50.0, 0.0, 100.0, 20.0, 0.0};
  file.luminaire.manufacturer = "Lucerna";
  file.luminaire.luminous_length_mm = 1100.0;
  file.luminaire.luminous_width_mm = 100.0;
  file.luminaire.input_watts = 12.5;
  return file;
}

std::string body(const std::string& text) { return text.substr(text.find("TILT=NONE\r\n") + 11); }

TEST(IesWriter, HeadersAndKeywords) {
  const std::string text = ies_text(example(), PhotometricFormat::ies_2019);
  EXPECT_TRUE(
      text.starts_with("IES:LM-63-2019\r\n[TEST] unknown\r\n[TESTLAB] unknown\r\n[ISSUEDATE] unknown\r\n"
                       "[MANUFAC] Lucerna\r\n"));
  const std::string old = ies_text(example(), PhotometricFormat::ies_2002);
  EXPECT_TRUE(old.starts_with("IESNA:LM-63-2002\r\n"));
}

// Measured light must not become simulated by being written again.
TEST(IesWriter, SaysHowTheLightWasFoundOnlyAsItIsTold) {
  PhotometricFile file = example();
  EXPECT_EQ(ies_text(file, PhotometricFormat::ies_2019).find("[FILEGENINFO]"), std::string::npos);
  file.luminaire.generation_type = "1.10100";
  file.luminaire.generation_info = "lumen scaled";
  const std::string text = ies_text(file, PhotometricFormat::ies_2019);
  EXPECT_NE(text.find("[FILEGENINFO] lumen scaled\r\n"), std::string::npos);
  EXPECT_NE(text.find("\r\n1 1.10100 12.5\r\n"), std::string::npos);
  const std::string old = ies_text(file, PhotometricFormat::ies_2002);
  EXPECT_EQ(old.find("[FILEGENINFO]"), std::string::npos);
  EXPECT_NE(old.find("\r\n1 1 12.5\r\n"), std::string::npos);
}

TEST(IesWriter, UnturnedSwapsSizesAndPrintsTheWholeCircle) {
  EXPECT_EQ(body(ies_text(example(), PhotometricFormat::ies_2019)),
            "1 -1 1 3 5 1 2 1.1 0.1 0\r\n1 1.00001 12.5\r\n0 45 90\r\n0 90 180 270 360\r\n"
            "100 50 0\r\n100 80 0\r\n100 50 0\r\n100 20 0\r\n100 50 0\r\n");
}

TEST(IesWriter, TurnedKeepsSizesAndSeesTheMirrorPlane) {
  const std::string text = ies_text(example(), PhotometricFormat::ies_2002, {.ies_turn = IesTurn::minus_90});
  EXPECT_EQ(body(text),
            "1 -1 1 3 3 1 2 0.1 1.1 0\r\n1 1 12.5\r\n0 45 90\r\n0 90 180\r\n"
            "100 80 0\r\n100 50 0\r\n100 20 0\r\n");
}

TEST(IesWriter, RoundIsNegativeAndRelativeNamesTheLamps) {
  PhotometricFile file = example();
  file.luminaire.luminous_length_mm = 200.0;
  file.luminaire.luminous_width_mm = 0.0;
  file.luminaire.absolute = false;
  file.luminaire.lamps = {{.count = 2, .type = "T5", .flux_lm = 3000.0}};
  const std::string text = ies_text(file, PhotometricFormat::ies_2019);
  EXPECT_NE(text.find("[LAMP] T5\r\n"), std::string::npos);
  EXPECT_TRUE(body(text).starts_with("2 1500 1 3 5 1 2 -0.2 -0.2 0\r\n")) << body(text);
}

TEST(IesWriter, LinesStayShort) {
  PhotometricFile file = example();
  file.distribution = uniform_distribution(10.0, 1.0);
  for (std::size_t i = 0; i < file.distribution.cd.size(); ++i)
    file.distribution.cd[i] = std::sqrt(static_cast<double>(i));
  std::string words;
  for (int i = 0; i < 60; ++i) words += "Größe ";
  file.luminaire.keywords = {{"OTHER", words + "\nsecond line"}};
  const std::string text = ies_text(file, PhotometricFormat::ies_2019);
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) EXPECT_LE(line.size(), 132u);
  EXPECT_NE(text.find("[MORE] second line\r\n"), std::string::npos);
  EXPECT_NE(text.find("[OTHER] Größe Größe"), std::string::npos);
}

TEST(IesWriter, RadiometricNamesItsUnit) {
  PhotometricFile file = example();
  file.distribution.unit = FluxUnit::watt;
  EXPECT_NE(ies_text(file, PhotometricFormat::ies_2019).find("[_INTENSITYUNITS] W/sr\r\n"),
            std::string::npos);
}

TEST(IesWriter, RefusesAnglesThatLm63CannotSay) {
  PhotometricFile file = example();
  file.distribution.gamma_deg = {0.0, 45.0, 85.0};
  EXPECT_THROW(ies_text(file, PhotometricFormat::ies_2019), InputError);
}

}  // namespace
}  // namespace lucerna
