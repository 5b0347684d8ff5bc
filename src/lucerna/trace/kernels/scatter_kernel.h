// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/random.h"
#include "lucerna/scatter.h"
#include "lucerna/trace/kernels/bsdf_kernel.h"
#include "lucerna/trace/kernels/kernel.h"
#include "lucerna/trace/kernels/slope_error.h"

namespace lucerna {

/// What turns light aside at a mirror, as a kernel reads it.
struct SurfaceFinish {
  double slope_error_rad = 0.0;
  const ScatterLobe* lobes = nullptr;
  std::uint32_t lobe_count = 0;
  /// In their place, if not null.
  const BsdfView* measured = nullptr;

  LUCERNA_HD bool scatters() const { return lobe_count > 0 || measured != nullptr; }
};

/// A direction in another frame.
LUCERNA_HD inline Direction turned(const FrameView& k, const Direction& d) {
  const auto row = [&](int i) {
    return static_cast<double>(k.m[i]) * d.x() + static_cast<double>(k.m[i + 1]) * d.y() +
           static_cast<double>(k.m[i + 2]) * d.z();
  };
  return Direction::from({row(0), row(3), row(6)});
}

/// An offset d <= kLargestScatterOffset with a density of d / (b + d^g): by the larger density min(d, d^(1 -
/// g)) in units of b^(1/g), of which more than half is accepted.
LUCERNA_HD inline double abg_offset(double b, double g, Rng& rng) {
  const double unit = std::pow(b, 1.0 / g), end = kLargestScatterOffset / unit, power = 2.0 - g;
  const bool logarithmic = std::abs(power) < 1e-6;
  const double inner = end < 1.0 ? 0.5 * end * end : 0.5;
  const double outer = end < 1.0 ? 0.0 : logarithmic ? std::log(end) : (std::pow(end, power) - 1.0) / power;
  for (;;) {
    const double u = rng.uniform() * (inner + outer);
    const double beyond = u - inner;
    const double x = beyond < 0.0  ? std::sqrt(2.0 * u)
                     : logarithmic ? std::exp(beyond)
                                   : std::pow(1.0 + power * beyond, 1.0 / power);
    const double accepted = beyond < 0.0 ? 1.0 / (1.0 + std::pow(x, g)) : 1.0 / (1.0 + std::pow(x, -g));
    if (rng.uniform() < accepted) return x < end ? x * unit : kLargestScatterOffset;
  }
}

/// How far a lobe that is no Lambert's moves the cosines.
LUCERNA_HD inline double drawn_offset(const ScatterLobe& lobe, Rng& rng) {
  if (lobe.kind == ScatterKind::gaussian) return lobe.sigma * std::sqrt(-2.0 * std::log(1.0 - rng.uniform()));
  return abg_offset(lobe.b, lobe.g, rng);
}

/// Where light goes that a smooth surface of `normal` would send to `smooth`: there, or by one of the lobes.
/// Both directions on the normal's side. `index` of the medium there: offsets are those of air, which it
/// makes smaller.
LUCERNA_HD inline Direction scattered(const SurfaceFinish& finish, const Direction& normal,
                                      const Direction& smooth, double index, Rng& rng) {
  double left = rng.uniform();
  std::uint32_t k = 0;
  while (k < finish.lobe_count && left >= finish.lobes[k].share) left -= finish.lobes[k++].share;
  if (k == finish.lobe_count) return smooth;
  const ScatterLobe& lobe = finish.lobes[k];
  const bool lambert = lobe.kind == ScatterKind::lambert;
  const double offset = lambert ? std::sqrt(rng.uniform()) : drawn_offset(lobe, rng) / index;
  const double angle = 2.0 * std::numbers::pi * rng.uniform();
  const Frame tangent = Frame::from_z(normal);
  const double x = (lambert ? 0.0 : dot(smooth, tangent.ex())) + offset * std::cos(angle);
  const double y = (lambert ? 0.0 : dot(smooth, tangent.ey())) + offset * std::sin(angle);
  const double z2 = 1.0 - x * x - y * y;
  if (!(z2 > 0.0)) return smooth;
  return Direction::from(x * tangent.ex() + y * tangent.ey() + std::sqrt(z2) * normal.vec());
}

/// The same of a mirror in air, with a random stream of its own.
LUCERNA_HD inline Direction scattered(const SurfaceFinish& finish, const Direction& normal,
                                      const Direction& mirrored, const ReflectionKey& key) {
  // Streams from 2^16 on belong to slope errors, from 2^17 on to glass.
  Rng rng(key.sequence_seed, key.ray, 0x30000u + static_cast<std::uint32_t>(key.bounce));
  if (finish.measured != nullptr) return scattered_by(*finish.measured, normal, mirrored, rng);
  return scattered(finish, normal, mirrored, 1.0, rng);
}

}  // namespace lucerna
