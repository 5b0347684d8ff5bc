// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "lucerna/bsdf.h"
#include "lucerna/core/io/error.h"

namespace lucerna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Made up: two incidences, three azimuths, four radial angles.
constexpr const char* kTable =
    "# a made-up sample\r\n"
    "Source  Measured\r\n"
    "Symmetry\tPlaneSymmetrical\r\n"
    "SpectralContent  Monochrome\r\n"
    "ScatterType  BRDF\r\n"
    "SampleRotation  1\r\n0\r\n"
    "AngleOfIncidence  2\r\n10\t40\r\n"
    "ScatterAzimuth 3\r\n0 90 180\r\n"
    "ScatterRadial 4\r\n0 5 20 80\r\n\r\n"
    "Monochrome\r\nDataBegin\r\n"
    "TIS 0.5\r\n1.0E+00 5E-1 2e-1 0\r\n1 0.5 0.3 0\r\n1 0.5 0.4 0\r\n"
    "TIS 0.6\r\n2 1 0.4 0\r\n# between\r\n2 1 0.6 0\r\n2 1 0.8 0.1\r\n"
    "DataEnd\r\n";

std::string changed_table(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string bsdf_fault(const std::string& text) {
  try {
    static_cast<void>(parse_bsdf(text, "made.bsdf"));
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(BsdfFile, HasAnglesAndValues) {
  const BsdfTable t = parse_bsdf(kTable, "made.bsdf");
  EXPECT_THAT(t.incidence_deg, ElementsAre(10.0, 40.0));
  EXPECT_THAT(t.azimuth_deg, ElementsAre(0.0, 90.0, 180.0));
  EXPECT_THAT(t.radial_deg, ElementsAre(0.0, 5.0, 20.0, 80.0));
  EXPECT_THAT(t.total, ElementsAre(0.5, 0.6));
  ASSERT_EQ(t.brdf.size(), 24u);
  EXPECT_EQ(t.brdf[t.row(0, 1) + 2], 0.3);
  EXPECT_EQ(t.brdf[t.row(1, 2) + 3], 0.1);
  EXPECT_TRUE(t.is_symmetrical());
}

TEST(BsdfFile, OfTristimulusValuesYIsTaken) {
  std::string text = changed_table(kTable, "SpectralContent  Monochrome", "SpectralContent XYZ");
  const std::string head = text.substr(0, text.find("Monochrome\r\nDataBegin"));
  const std::string block = text.substr(text.find("DataBegin"));
  const std::string all = head + "TristimulusX\r\n" + block + "TristimulusY\r\n" +
                          changed_table(block, "0.3 0", "0.35 0") + "TristimulusZ\r\n" + block;
  const BsdfTable t = parse_bsdf(all, "made.bsdf");
  EXPECT_EQ(t.brdf[t.row(0, 1) + 2], 0.35);
  EXPECT_THAT(bsdf_fault(head + "TristimulusX\r\n" + block), HasSubstr("expected TristimulusY"));
}

TEST(BsdfFile, AzimuthsAreClosed) {
  const std::string open =
      changed_table(changed_table(kTable, "PlaneSymmetrical", "Asymmetrical"), "0 90 180", "0 120 240");
  const BsdfTable t = parse_bsdf(open, "made.bsdf");
  EXPECT_THAT(t.azimuth_deg, ElementsAre(0.0, 120.0, 240.0, 360.0));
  EXPECT_EQ(t.brdf[t.row(1, 3) + 2], t.brdf[t.row(1, 0) + 2]);
  EXPECT_FALSE(t.is_symmetrical());
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "0 90 180", "0 45 90")),
              HasSubstr("found azimuths to 90 degrees"));
  EXPECT_THAT(bsdf_fault(changed_table(changed_table(kTable, "PlaneSymmetrical", "Asymmetrical"), "0 90 180",
                                       "0 45 90")),
              HasSubstr("expected them to go to 360"));
}

TEST(BsdfFile, FaultsAreNamedWithTheirLine) {
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "0 90 180", "0 190 180")),
              HasSubstr("made.bsdf: line 11: found an angle of 180"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "0 5 20 80", "1 5 20 80")),
              HasSubstr("begin at 0 and 1, expected 0"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "TIS 0.5", "TIS 50")),
              HasSubstr("line 17: found a total (TIS) of 50"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "1 0.5 0.3 0", "1 0.5 -0.3 0")),
              HasSubstr("line 19: found a BRDF of -0.3"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "1 0.5 0.3 0", "1 0.5 x 0")),
              HasSubstr("found 'x', expected a value"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "1 0.5 0.3 0", "1 0.5 0.3")),
              HasSubstr("found 'TIS', expected a value"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "ScatterRadial 4", "ScatterRadial 1e12")),
              HasSubstr("expected 1 to 10000"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "10\t40", "10\t90")), HasSubstr("incidence of 90 degrees"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "ScatterType  BRDF", "ScatterType  BTDF")),
              HasSubstr("goes through"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "SampleRotation  1\r\n0", "SampleRotation  2\r\n0 90")),
              HasSubstr("several rotations"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "PlaneSymmetrical", "Asymmetric")),
              HasSubstr("found symmetry 'Asymmetric'"));
  EXPECT_THAT(bsdf_fault(changed_table(kTable, "Source", "Quelle")), HasSubstr("found 'Quelle'"));
  EXPECT_THAT(bsdf_fault(std::string(kTable) + "1"), HasSubstr("after the last value"));
}

// Every beginning of the file is refused by name, but those that lack its last line end.
TEST(BsdfFile, EveryTruncationIsRefused) {
  const std::string whole = kTable, end = "DataEnd";
  const std::size_t complete = whole.rfind(end) + end.size();
  for (std::size_t n = 0; n < complete; ++n)
    EXPECT_THAT(bsdf_fault(whole.substr(0, n)), HasSubstr("made.bsdf: ")) << n;
  EXPECT_EQ(bsdf_fault(whole.substr(0, complete)), "");
  EXPECT_THAT(bsdf_fault(whole.substr(0, whole.find("ScatterAzimuth"))), HasSubstr("ends in its header"))
      << "as a file of Zemax, not of LightTools";
}

}  // namespace
}  // namespace lucerna
