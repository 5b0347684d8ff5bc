// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/reflector.h"

namespace lucerna {
namespace {

TEST(Aperture, CircleWithAHole) {
  const Aperture a = Aperture::circle(10.0, 4.0);
  EXPECT_TRUE(a.contains(5.0, 0.0));
  EXPECT_TRUE(a.contains(0.0, -2.0));
  EXPECT_FALSE(a.contains(1.9, 0.0));
  EXPECT_FALSE(a.contains(4.0, 4.0));
  EXPECT_EQ(a.outer_radius_mm(), 5.0);
}

TEST(Aperture, RectangleReachesItsCorners) {
  const Aperture a = Aperture::rectangle(6.0, 8.0, 2.0);
  EXPECT_TRUE(a.contains(3.0, 4.0));
  EXPECT_FALSE(a.contains(3.01, 0.0));
  EXPECT_FALSE(a.contains(0.0, 0.5));
  EXPECT_EQ(a.outer_radius_mm(), 5.0);
}

TEST(Aperture, RefusesWhatCannotBe) {
  EXPECT_THROW(Aperture::circle(0.0), InputError);
  EXPECT_THROW(Aperture::circle(10.0, 10.0), InputError);
  EXPECT_THROW(Aperture::circle(10.0, -1.0), InputError);
  EXPECT_THROW(Aperture::rectangle(10.0, 5.0, 6.0), InputError);
  EXPECT_THROW(Aperture::circle(std::numeric_limits<double>::quiet_NaN()), InputError);
}

// A region that is said to miss the mirror must hold no point of it, and regions about a point of it never
// miss.
TEST(Aperture, MissesOnlyWhatIsOffTheMirror) {
  Rng rng(7, 0);
  int missed = 0;
  for (const Aperture& a : {Aperture::circle(10.0, 4.0), Aperture::rectangle(10.0, 6.0, 4.0)}) {
    for (int i = 0; i < 20000; ++i) {
      const double x = 14.0 * rng.uniform() - 7.0, y = 14.0 * rng.uniform() - 7.0;
      const double w = 2.0 * rng.uniform(), h = 2.0 * rng.uniform();
      const double px = x + w * rng.uniform(), py = y + h * rng.uniform();
      const bool misses = a.misses({x, x + w, y, y + h});
      missed += misses;
      EXPECT_FALSE(misses && a.contains(px, py)) << px << " " << py;
    }
  }
  EXPECT_GT(missed, 1000);
}

}  // namespace
}  // namespace lucerna
