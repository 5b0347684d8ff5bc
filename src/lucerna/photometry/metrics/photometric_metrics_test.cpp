// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometric_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "lucerna/core/io/error.h"

namespace lucerna {
namespace {

PhotometricFile lambert() {
  PhotometricFile file;
  file.distribution = uniform_distribution(90.0, 1.0);
  for (std::size_t i = 0; i < file.distribution.cd.size(); ++i) {
    const double g = file.distribution.gamma_deg[i % 181];
    file.distribution.cd[i] = g < 90.0 ? 1000.0 * std::cos(radians(g)) : 0.0;
  }
  return file;
}

// A Lambertian emitter has sin^2 of the half angle of its flux in a cone.
TEST(PhotometricMetrics, LambertianEmitter) {
  PhotometricFile file = lambert();
  file.luminaire.absolute = false;
  file.luminaire.lamps = {{.count = 1, .flux_lm = 4000.0}};
  const PhotometricMetrics f = photometric_metrics(file);
  EXPECT_NEAR(f.beam.flux, 1000.0 * 3.14159265, 0.5);
  EXPECT_NEAR(f.cie_flux_code[0], 100.0 * std::pow(std::sin(radians(41.4)), 2.0), 0.05);
  EXPECT_NEAR(f.cie_flux_code[1], 75.0, 0.05);
  EXPECT_NEAR(f.cie_flux_code[2], 100.0 * std::pow(std::sin(radians(75.5)), 2.0), 0.05);
  EXPECT_NEAR(f.cie_flux_code[3], 100.0, 1e-9);
  EXPECT_NEAR(f.cie_flux_code[4], 78.54, 0.02);
  EXPECT_NEAR(*f.light_output_ratio, 0.7854, 0.0002);
  EXPECT_NEAR(std::accumulate(f.zonal.begin(), f.zonal.end(), 0.0), f.beam.flux, 1e-9);
  EXPECT_NEAR(f.flux_0_60 + f.flux_60_90, f.flux_0_90, 1e-9);
  EXPECT_EQ(f.cut_off_deg, 88.0);  // cos 88 = 3.5 %, cos 89 = 1.7 %
  EXPECT_EQ(f.nema_horizontal, 7);
}

TEST(PhotometricMetrics, NemaTypesByFieldAngle) {
  EXPECT_EQ(nema_type(std::nullopt), 0);
  EXPECT_EQ(nema_type(9.9), 0);
  EXPECT_EQ(nema_type(18.0), 1);
  EXPECT_EQ(nema_type(18.1), 2);
  EXPECT_EQ(nema_type(100.0), 5);
  EXPECT_EQ(nema_type(131.0), 7);
}

TEST(PhotometricMetrics, RefusesABrokenGrid) {
  EXPECT_THROW(photometric_metrics(PhotometricFile{}), InputError);
}

}  // namespace
}  // namespace lucerna
