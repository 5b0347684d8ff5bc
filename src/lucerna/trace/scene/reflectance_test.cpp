// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/material.h"
#include "lucerna/scene.h"

namespace lucerna {
namespace {

TEST(MetalReflectance, IsFresnelsAtEveryAngle) {
  for (const MaterialInfo& m : materials()) {
    if (!m.is_metal) continue;
    for (const double nm : {380.0, 555.0, 780.0}) {
      const Reflectance metal = metal_reflectance(m.name, nm);
      const RefractiveIndex index = refractive_index(m.name, nm);
      for (double deg = 0.0; deg <= 90.0; deg += 0.25) {
        const double cosine = std::cos(radians(deg));
        EXPECT_NEAR(metal.at(cosine), fresnel_reflectance(cosine, index), 1e-3) << m.name << " " << deg;
      }
    }
  }
}

TEST(MetalReflectance, IsOfMetals) {
  EXPECT_THROW((void)metal_reflectance("bk7"), InputError);
  EXPECT_THROW((void)metal_reflectance("gold"), InputError);
  EXPECT_THROW((void)metal_reflectance("silver", 1000.0), InputError);
}

}  // namespace
}  // namespace lucerna
