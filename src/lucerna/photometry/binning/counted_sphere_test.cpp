// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/binning/counted_sphere.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lucerna/core/io/error.h"
#include "tests/support/random_rays.h"

namespace lucerna {
namespace {

constexpr std::size_t kCountedPlanes = 72, kCountedGammas = 181, kCountedReplicates = 6;

/// 100 cd in every direction, of which replicate r counts r times as much as the first. Cells are centred on
/// whole degrees of gamma.
JackknifedFlux even_light() {
  const double step = std::numbers::pi / (kCountedGammas - 1.0), all = 1.0 + 2.0 + 3.0 + 4.0 + 5.0 + 6.0;
  JackknifedFlux flux(kCountedPlanes * kCountedGammas, kCountedReplicates);
  for (std::size_t i = 0; i < flux.cells(); ++i) {
    const double gamma = step * static_cast<double>(i % kCountedGammas);
    const double solid_angle_sr = 2.0 * std::numbers::pi / kCountedPlanes *
                                  (std::cos(std::max(0.0, gamma - 0.5 * step)) -
                                   std::cos(std::min(std::numbers::pi, gamma + 0.5 * step)));
    flux.row(i)[0] = 100.0 * solid_angle_sr;
    for (std::size_t r = 1; r <= kCountedReplicates; ++r)
      flux.row(i)[r] = 100.0 * solid_angle_sr * (all - static_cast<double>(r)) / all * 6.0 / 5.0;
  }
  return flux;
}

const CountedSphere& even_sphere() {
  static const CountedSphere sphere(kCountedPlanes, kCountedGammas, FluxUnit::lumen, even_light());
  return sphere;
}

TEST(CountedSphere, EvenLightIsEvenAtThePolesToo) {
  for (const double gamma_deg : {0.0, 0.3, 2.0, 45.0, 90.0, 178.9, 180.0}) {
    for (const double radius_deg : {1.5, 4.0, 24.0}) {
      const Direction d = direction_from_type_c({radians(17.0), radians(gamma_deg)});
      EXPECT_NEAR(even_sphere().mean_of_all_cd(d, Kernel(radius_deg)), 100.0, 0.2) << gamma_deg;
      EXPECT_NEAR(even_sphere().fit(d, Kernel(radius_deg)).coefficients[0].all(), 100.0, 0.2) << gamma_deg;
    }
  }
  EXPECT_NEAR(even_sphere().zone_flux(0.0, 180.0).all(), 400.0 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(even_sphere().half_zone_flux(0.0, 180.0, 30.0).all(), 200.0 * std::numbers::pi, 1e-9);
}

// Replicates 1, 3 and 5 have 9 of 21 parts, the others 12.
TEST(CountedSphere, HalvesHaveTheFluxOfTheirReplicates) {
  const std::vector<double> odd = even_sphere().half_of_flux(true), even = even_sphere().half_of_flux(false);
  const Direction d = direction_from_type_c({1.0, 1.0});
  EXPECT_NEAR(even_sphere().mean_cd_of(odd, d, Kernel(5.0)), 200.0 * 9.0 / 21.0, 0.2);
  EXPECT_NEAR(even_sphere().mean_cd_of(even, d, Kernel(5.0)), 200.0 * 12.0 / 21.0, 0.2);
}

TEST(CountedSphere, CellsAreOfAGrid) {
  EXPECT_EQ(test::message_of<InputError>([] { CountedSphere(4, 3, FluxUnit::lumen, JackknifedFlux(11, 2)); }),
            "11 cells, expected 4 planes of 3 gammas, at least 3");
}

}  // namespace
}  // namespace lucerna
