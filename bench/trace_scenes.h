// SPDX-License-Identifier: Apache-2.0
#pragma once

// The scenes that light tracing is measured on.

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "lucerna/core/parallel.h"
#include "lucerna/core/random.h"
#include "lucerna/source/ray_set_source.h"
#include "lucerna/trace/scene.h"

namespace bench {

using namespace lucerna;

/// A paraboloid, with pillows of so much height on it.
class Mirror final : public HeightSurface {
 public:
  Mirror(double focal_mm, double pillow_mm) : f_(4.0 * focal_mm), p_(pillow_mm) {}
  SurfacePoint at(double x, double y) const override {
    const double cx = std::cos(k_ * x), cy = std::cos(k_ * y), sx = std::sin(k_ * x), sy = std::sin(k_ * y);
    return {(x * x + y * y) / f_ + p_ * cx * cy, 2.0 * x / f_ - p_ * k_ * sx * cy,
            2.0 * y / f_ - p_ * k_ * cx * sy};
  }
  HeightRange range(const Rectangle& r) const override {
    const RadiusRange q = radius_range(r);
    return {q.least_mm * q.least_mm / f_ - p_, q.greatest_mm * q.greatest_mm / f_ + p_};
  }

 private:
  double f_, p_, k_ = 2.0 * std::numbers::pi / 8.0;
};

/// The three mirrors of the bars.
struct Case {
  std::string name;
  double focal_mm, pillow_mm;
};
inline const std::array<Case, 3> kCases{Case{"para", 15.0, 0.0}, Case{"wavy", 15.0, 0.4},
                                        Case{"deep", 5.0, 0.4}};

/// `n` rays from the mantle of a cylinder of radius 1 mm and length 6 mm in all directions, in random order.
inline std::shared_ptr<RaySet> cylinder(std::size_t n) {
  auto set = std::make_shared<RaySet>();
  set->header.set_flux(1000.0);
  set->rays.resize(n, 0);
  parallel_blocks(n, 4096, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      Rng rng(1, i);
      const double a = 2.0 * std::numbers::pi * rng.uniform(), c = 2.0 * rng.uniform() - 1.0;
      const double b = 2.0 * std::numbers::pi * rng.uniform(), s = std::sqrt(1.0 - c * c);
      set->rays.set(i, {{std::cos(a), std::sin(a), 6.0 * rng.uniform() - 3.0},
                        Direction::from_unit({s * std::cos(b), s * std::sin(b), c})});
      set->rays.weight[i] = 1.0F;
    }
  });
  return set;
}

/// The mirror of 100 mm x 100 mm with the source at its focus, reflectance 0.9, a far field of 1 degree.
inline Scene scene_of(const Case& c, const std::shared_ptr<RaySet>& rays) {
  const Reflector mirror{std::make_shared<Mirror>(c.focal_mm, c.pillow_mm),
                         Aperture::rectangle(100.0, 100.0)};
  PlacedSource source{std::make_shared<RaySetSource>(rays, "cylinder"),
                      Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, c.focal_mm}), std::nullopt};
  return {{source}, {{mirror, Frame(), Reflectance(0.9)}}, {{"far", 1.0, 1.0}}};
}

}  // namespace bench
