// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/data/symmetry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {
namespace {

IntensityDistribution filled_planes(const std::function<double(double, double)>& cd, double c_step = 15.0) {
  IntensityDistribution d = uniform_distribution(c_step, 10.0);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      d.at(c, g) = cd(radians(d.c_deg[c]), radians(d.gamma_deg[g]));
    }
  }
  return d;
}

TEST(Symmetry, IsFound) {
  const double tolerance = 1e-9;
  EXPECT_EQ(find_symmetry(filled_planes([](double, double g) { return 2.0 + std::cos(g); }), tolerance),
            Symmetry::rotational);
  EXPECT_EQ(find_symmetry(filled_planes([](double c, double g) { return 3.0 + std::sin(g) * std::cos(c); }),
                          tolerance),
            Symmetry::plane_c0_c180);
  EXPECT_EQ(find_symmetry(filled_planes([](double c, double g) { return 3.0 + std::sin(g) * std::sin(c); }),
                          tolerance),
            Symmetry::plane_c90_c270);
  EXPECT_EQ(
      find_symmetry(filled_planes([](double c, double g) { return 3.0 + std::sin(g) * std::cos(2.0 * c); }),
                    tolerance),
      Symmetry::both_planes);
  EXPECT_EQ(
      find_symmetry(filled_planes([](double c, double g) { return 3.0 + std::sin(g) * std::cos(c - 0.3); }),
                    tolerance),
      Symmetry::none);
}

TEST(Symmetry, NeedsItsMirrorPlanesOnTheGrid) {
  // Planes 0, 40, ..., 320 mirror onto each other about C0 but 180 is not among them.
  const auto d = filled_planes([](double c, double g) { return 3.0 + std::sin(g) * std::cos(c); }, 40.0);
  EXPECT_EQ(find_symmetry(d, 1e-9), Symmetry::none);
}

TEST(Symmetry, TurningKeepsEveryIntensityAndTheFlux) {
  const auto d = filled_planes([](double c, double g) { return 3.0 + std::sin(g) * std::cos(c - 0.3); });
  for (const double origin : {90.0, -90.0, 37.5, 359.0}) {
    const IntensityDistribution t = turned(d, origin);
    EXPECT_EQ(grid_fault(t), "");
    EXPECT_NEAR(total_flux(t), total_flux(d), 1e-12 * total_flux(d));
    for (double c = 0.0; c < 360.0; c += 7.0) {
      EXPECT_NEAR(intensity_at(t, c - origin, 55.0), intensity_at(d, c, 55.0), 1e-12) << c;
    }
  }
  const IntensityDistribution back = turned(turned(d, 90.0), -90.0);
  EXPECT_EQ(back.c_deg, d.c_deg);
  EXPECT_EQ(back.cd, d.cd);
}

TEST(Symmetry, SymmetrisingKeepsTheFlux) {
  const auto d = filled_planes([](double c, double g) { return 3.0 + std::sin(g) * std::cos(c - 0.3); });
  for (const Symmetry s :
       {Symmetry::rotational, Symmetry::plane_c0_c180, Symmetry::plane_c90_c270, Symmetry::both_planes}) {
    const IntensityDistribution even = symmetrised(d, s);
    EXPECT_NEAR(total_flux(even), total_flux(d), 1e-12 * total_flux(d));
    const Symmetry found = find_symmetry(even, 1e-12);
    // cos(C - 0.3) averaged over both planes is a constant.
    EXPECT_EQ(found, s == Symmetry::both_planes ? Symmetry::rotational : s);
  }
  EXPECT_THROW(symmetrised(zero_distribution({0.0, 10.0}, {0.0, 90.0}), Symmetry::plane_c0_c180), InputError);
}

}  // namespace
}  // namespace lucerna
