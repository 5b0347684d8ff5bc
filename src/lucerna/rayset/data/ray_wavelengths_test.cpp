// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/ray_wavelengths.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

const SpectralTable kBroad{{400.0F, 700.0F}, {1.0F, 1.0F}};

RayBlock block_with(std::vector<float> column) {
  RayBlock rays;
  rays.resize(column.size());
  rays.extra = {std::move(column)};
  return rays;
}

TEST(RayWavelengths, AreTheRaysOwnBeforeAllElse) {
  RaySetHeader header;
  header.columns = {{ColumnKind::wavelength_nm, "nm"}};
  header.spectra = {kBroad};
  header.wavelength_nm = 555.0F;
  const RayWavelengths own(header, FluxUnit::watt);
  EXPECT_EQ(own.of(block_with({450.0F, 620.0F}), 1, 77), 620.0F);
  EXPECT_TRUE(own.are_known() && own.differ_by_ray() && !own.are_drawn());
}

TEST(RayWavelengths, AreUnknownWhereNothingIsSaid) {
  const RayWavelengths unknown(RaySetHeader{}, FluxUnit::lumen, 555.0F);
  EXPECT_FALSE(unknown.are_known() || unknown.differ_by_ray());
  EXPECT_EQ(unknown.of(RayBlock(), 0, 0), 555.0F);
  RaySetHeader one;
  one.wavelength_nm = 632.8F;
  EXPECT_EQ(RayWavelengths(one, FluxUnit::watt).of(RayBlock(), 0, 3), 632.8F);
  RaySetHeader empty;
  empty.spectra = {kBroad, {}};
  EXPECT_FALSE(RayWavelengths(empty, FluxUnit::watt).are_known()) << "one of the tables has no points";
}

TEST(RayWavelengths, WritersAreWarned) {
  RaySetHeader header;
  EXPECT_NE(wavelengths_warning(RayWavelengths(header, FluxUnit::watt)).find("555 nm"), std::string::npos);
  header.spectra = {kBroad};
  EXPECT_NE(wavelengths_warning(RayWavelengths(header, FluxUnit::watt)).find("drawn"), std::string::npos);
  header.columns = {{ColumnKind::wavelength_nm, "nm"}};
  EXPECT_EQ(wavelengths_warning(RayWavelengths(header, FluxUnit::watt)), "");
}

// Rays are often made in the order of the golden angle. Correlation of the wavelength with that angle's
// fraction, and with the number itself: 1e-6 false alarms at 4.9 sigma of 1 / sqrt(n); draws by the golden
// sequence have 1.
TEST(RayWavelengthsStatistical, DoNotGoWithTheOrderOfTheRays) {
  RaySetHeader header;
  header.spectra = {kBroad};
  const RayWavelengths drawn(header, FluxUnit::watt);
  constexpr int kRays = 100'000;
  double with_angle = 0.0, with_number = 0.0, mean = 0.0;
  for (int i = 0; i < kRays; ++i) {
    const double golden = i * 0.6180339887498949, u = golden - std::floor(golden);
    const double w =
        (static_cast<double>(drawn.of(RayBlock(), 0, static_cast<std::uint64_t>(i))) - 550.0) / 150.0;
    mean += w / kRays;
    with_angle += 6.0 * w * (u - 0.5) / kRays;  // 1 for w = 2 u - 1
    with_number += 6.0 * w * (static_cast<double>(i) / kRays - 0.5) / kRays;
  }
  const double sigma = 1.0 / std::sqrt(kRays);
  EXPECT_NEAR(mean, 0.0, 4.9 * sigma / std::sqrt(3.0));
  EXPECT_NEAR(with_angle, 0.0, 4.9 * sigma);
  EXPECT_NEAR(with_number, 0.0, 4.9 * sigma);
}

}  // namespace
}  // namespace lucerna
