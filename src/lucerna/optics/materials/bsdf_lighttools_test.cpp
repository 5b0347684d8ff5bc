// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/materials/bsdf_lighttools.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "lucerna/core/io/error.h"

namespace lucerna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Made up: two incidences, four azimuths all around, three radial angles; the values of azimuth 270, where a
/// mirror sends the light to, begin with 4.
constexpr const char* kFull =
    "# a made-up sample\r\n"
    "Symmetry Asymmetric\r\n"
    "SpectralContent Monochrome\r\n"
    "ScatterAzimuth 4\r\n0 90 180 270\r\n"
    "ScatterRadial 3\r\n0 30 90\r\n"
    "DataBegin\r\n"
    "AOI 40\r\nPOI 0\r\nSide Front\r\nWavelength 550\r\nScatterType BRDF\r\n"
    "TIS 0.6\r\n1 .1 .2\r\n2 .3 .4\r\n3 .5 .6\r\n4 .7 .8\r\n"
    "AOI 0\r\nPOI 0\r\nSide Front\r\nWavelength 550\r\nScatterType BTDF\r\n"
    "TIS 0\r\n0 0 0\r\n0 0 0\r\n0 0 0\r\n0 0 0\r\n"
    "AOI 0\r\nPOI 0\r\nSide Front\r\nWavelength 550\r\nScatterType BRDF\r\n"
    "TIS 0.5\r\n1 1 1\r\n1 1 1\r\n1 1 1\r\n1 1 1\r\n"
    "AOI 0\r\nPOI 0\r\nSide Back\r\nWavelength 550\r\nScatterType BRDF\r\n"
    "TIS 0.2\r\n9 9 9\r\n9 9 9\r\n9 9 9\r\n9 9 9\r\n"
    "DataEnd\r\n";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

BsdfTable parsed(const std::string& text) { return parse_bsdf(text, "made.bsdf"); }

std::string lighttools_fault(const std::string& text) {
  try {
    static_cast<void>(parsed(text));
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// The values at a radial angle of an incidence, azimuth by azimuth.
std::vector<double> around(const BsdfTable& t, std::size_t incidence, std::size_t radial) {
  std::vector<double> out;
  for (std::size_t a = 0; a < t.azimuth_deg.size(); ++a) out.push_back(t.brdf[t.row(incidence, a) + radial]);
  return out;
}

TEST(LightToolsBsdf, BeginsAtTheMirroredDirection) {
  const BsdfTable t = parsed(kFull);
  EXPECT_TRUE(t.is_about_normal);
  EXPECT_FALSE(t.is_symmetrical());
  EXPECT_THAT(t.incidence_deg, ElementsAre(0.0, 40.0));
  EXPECT_THAT(t.total, ElementsAre(0.5, 0.6));
  EXPECT_THAT(t.azimuth_deg, ElementsAre(0.0, 90.0, 180.0, 270.0, 360.0));
  EXPECT_THAT(t.radial_deg, ElementsAre(0.0, 30.0, 90.0));
  EXPECT_THAT(around(t, 1, 0), ElementsAre(4.0, 1.0, 2.0, 3.0, 4.0));
  EXPECT_THAT(around(t, 0, 2), testing::Each(1.0)) << "neither the back's nor what goes through";
}

// Between columns the mirrored direction is linear between its neighbours, and 0 and 360 are one.
TEST(LightToolsBsdf, ColumnsMayBeAnywhere) {
  const BsdfTable t = parsed(with(kFull, "0 90 180 270", "-60 60 180 300"));
  EXPECT_THAT(t.azimuth_deg, ElementsAre(0.0, 30.0, 150.0, 270.0, 360.0));
  EXPECT_THAT(around(t, 1, 0), ElementsAre(1.5, 1.0, 2.0, 3.0, 1.5)) << "-60 and 300 degrees are one";
}

TEST(LightToolsBsdf, HalfACircleStandsForBothSides) {
  std::string half = with(kFull, "Asymmetric", "PlaneSymmetrical");
  const BsdfTable later = parsed(with(half, "0 90 180 270", "-90 -60 40 90"));
  EXPECT_TRUE(later.is_symmetrical());
  EXPECT_THAT(later.azimuth_deg, ElementsAre(0.0, 30.0, 130.0, 180.0));
  EXPECT_THAT(around(later, 1, 0), ElementsAre(1.0, 2.0, 3.0, 4.0));
  const BsdfTable earlier = parsed(with(half, "0 90 180 270", "90 120 200 270"));
  EXPECT_TRUE(earlier.is_symmetrical());
  EXPECT_THAT(earlier.azimuth_deg, ElementsAre(0.0, 70.0, 150.0, 180.0));
  EXPECT_THAT(around(earlier, 1, 0), ElementsAre(4.0, 3.0, 2.0, 1.0));
  EXPECT_FALSE(parsed(half).is_symmetrical()) << "all around is all around";
  EXPECT_THAT(lighttools_fault(with(half, "0 90 180 270", "90 120 200 250")),
              HasSubstr("expected half a circle"));
  EXPECT_THAT(lighttools_fault(with(kFull, "0 90 180 270", "0 20 40 60")),
              HasSubstr("expected the whole circle"));
  EXPECT_THAT(lighttools_fault(with(kFull, "0 90 180 270", "0 20 40 60")), HasSubstr("made.bsdf: line 4: "))
      << "where the azimuths are";
}

TEST(LightToolsBsdf, OfTristimulusValuesYIsTaken) {
  std::string text = with(kFull, "Monochrome", "XYZ");
  text = with(text, "ScatterType BRDF\r\nTIS 0.6", "ScatterType BRDF\r\nTristimulusValue TrisX\r\nTIS 0.6");
  EXPECT_THAT(parsed(text).incidence_deg, ElementsAre(0.0));
  EXPECT_THAT(parsed(with(text, "TrisX", "TrisY")).incidence_deg, ElementsAre(0.0, 40.0));
}

TEST(LightToolsBsdf, OfSeveralWavelengthsTheNearestIsTaken) {
  const std::string two = with(kFull, "Wavelength 550", "Wavelength 450");
  const BsdfTable green = parsed(two), blue = parse_bsdf(two, "made.bsdf", 480.0);
  EXPECT_THAT(green.incidence_deg, ElementsAre(0.0));
  EXPECT_EQ(green.wavelength_nm, 550.0);
  EXPECT_THAT(blue.incidence_deg, ElementsAre(40.0));
  EXPECT_EQ(blue.wavelength_nm, 450.0);
  EXPECT_EQ(parsed(kFull).wavelength_nm, 0.0) << "one";
}

TEST(LightToolsBsdf, LinesThatAreNotNeededArePassedOver) {
  const BsdfTable t =
      parsed(with(kFull, "Symmetry Asym", "Model made up here\r\nComment 12 \"a b\"\r\nSymmetry Asym"));
  EXPECT_EQ(t.brdf, parsed(kFull).brdf);
}

TEST(LightToolsBsdf, FaultsAreNamedWithTheirLine) {
  const auto fault = [](const char* from, const char* to) { return lighttools_fault(with(kFull, from, to)); };
  EXPECT_THAT(fault("AOI 40", "AOI 90"), HasSubstr("made.bsdf: line 14: found an incidence of 90 degrees"));
  EXPECT_THAT(fault("AOI 40", "AOI 0"), HasSubstr("found the incidence of 0 degrees twice"));
  EXPECT_THAT(fault("POI 0", "POI 45"), HasSubstr("planes of incidence at 45 and 0"));
  EXPECT_THAT(fault("Side Front", "Side Top"), HasSubstr("found 'Top', expected Front"));
  EXPECT_THAT(fault("TIS 0.6", "TIS 60"), HasSubstr("found a total (TIS) of 60"));
  EXPECT_THAT(fault("1 .1 .2", "1 .1 x"), HasSubstr("line 15: found 'x', expected a value"));
  EXPECT_THAT(fault("1 .1 .2", "1 .1"), HasSubstr("found 'AOI', expected a value"));
  EXPECT_THAT(fault("0 30 90", "0 30 95"), HasSubstr("found an angle of 95 degrees for ScatterRadial"));
  EXPECT_THAT(fault("0 30 90", "10 30 90"), HasSubstr("line 7: found radial angles that begin at 10"));
  EXPECT_THAT(fault("ScatterRadial 3\r\n0 30 90", "ScatterRadial 1\r\n0"),
              HasSubstr("found one radial angle"));
  EXPECT_THAT(fault("Asymmetric", "Skew"), HasSubstr("found symmetry 'Skew'"));
  EXPECT_THAT(fault("ScatterRadial 3\r\n0 30 90\r\n", ""), HasSubstr("line 6: found no ScatterRadial"));
  EXPECT_THAT(fault("DataEnd\r\n", "DataEnd 1\r\n"), HasSubstr("after DataEnd"));
  std::string through = kFull;
  for (std::size_t at = 0; (at = through.find("BRDF")) != std::string::npos;) through.replace(at, 4, "BTDF");
  EXPECT_THAT(lighttools_fault(through), HasSubstr("no BRDF of the front"));
}

TEST(LightToolsBsdf, EveryTruncationIsRefused) {
  const std::string whole = kFull, end = "DataEnd";
  const std::size_t complete = whole.rfind(end) + end.size();
  for (std::size_t n = 0; n < complete; ++n)
    EXPECT_THAT(lighttools_fault(whole.substr(0, n)), HasSubstr("made.bsdf: ")) << n;
  EXPECT_EQ(lighttools_fault(whole.substr(0, complete)), "");
  EXPECT_THAT(lighttools_fault(whole.substr(0, whole.find("DataBegin"))),
              HasSubstr("expected a line of the header, or DataBegin"))
      << "as a file of LightTools, not of Zemax";
}

}  // namespace
}  // namespace lucerna
