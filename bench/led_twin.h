// SPDX-License-Identifier: Apache-2.0
// A synthetic twin of the measured LED whose truth is known: a die with weak stripes and a bright rim in a
// dim package, all in the plane z = 0. What a model of few rays flattens is seen against the exact
// illuminance.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lucerna/geometry.h"
#include "lucerna/source/emitters/warp.h"

namespace lucerna::bench::twin {

/// Shares of the flux: package, rim; the die has the rest.
inline constexpr double kPackage = 0.06, kRim = 0.09;
/// Half sides in mm of the package, of the rim about the die, of the die.
inline constexpr double kPackageHalf = 2.0, kRimHalf = 1.08, kDieHalf = 1.02;
/// Stripes of the die along x: their amplitude, relative, and period in mm.
inline constexpr double kContrast = 0.05, kPeriod = 0.48;
/// Where rays are caught.
inline constexpr double kCaughtRadius = 5.0;

/// Integral of 1 + kContrast sin(2 pi y / kPeriod) from -kDieHalf to y, over that to kDieHalf. The sine is
/// odd.
inline double stripes_below(double y) {
  constexpr double kWave = 2.0 * std::numbers::pi / kPeriod;
  const double t = std::clamp(y, -kDieHalf, kDieHalf);
  const double wave = kContrast / kWave * (std::cos(kWave * kDieHalf) - std::cos(kWave * t));
  return (t + kDieHalf + wave) / (2.0 * kDieHalf);
}

/// The y below which the share u of the die's light lies: Newton's steps, the density being nearly even.
inline double stripes_at(double u) {
  constexpr double kWave = 2.0 * std::numbers::pi / kPeriod;
  double y = kDieHalf * (2.0 * u - 1.0);
  for (int i = 0; i < 6; ++i) {
    y -= (stripes_below(y) - u) * 2.0 * kDieHalf / (1.0 + kContrast * std::sin(kWave * y));
    y = std::clamp(y, -kDieHalf, kDieHalf);
  }
  return y;
}

/// The share of an even square of half side `half` that has coordinates below x and y.
inline double square_below(double half, double x, double y) {
  const auto below = [half](double t) { return std::clamp((t + half) / (2.0 * half), 0.0, 1.0); };
  return below(x) * below(y);
}

/// The share of the flux that crosses z = 0 at coordinates below x and y.
inline double share_below(double x, double y) {
  constexpr double kOuter = kRimHalf * kRimHalf, kInner = kDieHalf * kDieHalf;
  const double rim =
      (kOuter * square_below(kRimHalf, x, y) - kInner * square_below(kDieHalf, x, y)) / (kOuter - kInner);
  const double die = std::clamp((x + kDieHalf) / (2.0 * kDieHalf), 0.0, 1.0) * stripes_below(y);
  return kPackage * square_below(kPackageHalf, x, y) + kRim * rim + (1.0 - kPackage - kRim) * die;
}

/// A place on the rim: a square frame, cut into four rectangles that go round.
inline Vec3 rim_place(double u, double v) {
  constexpr double kWidth = kRimHalf - kDieHalf, kLength = kRimHalf + kDieHalf;
  const double side = std::floor(4.0 * u), along = kLength * (4.0 * u - side) - kRimHalf;
  const double across = kDieHalf + kWidth * v;
  if (side == 0.0) return {along, -across, 0.0};
  if (side == 1.0) return {across, along, 0.0};
  return side == 2.0 ? Vec3{-along, across, 0.0} : Vec3{-across, -along, 0.0};
}

/// Die and rim shine as cos^1.8 (radiance falls to the side), the package as a Lambertian.
inline Ray ray(const std::array<double, 5>& u) {
  const bool package = u[4] < kPackage, rim = !package && u[4] < kPackage + kRim;
  const double exponent = package ? 1.0 : 1.8;
  const double cosine = std::pow(1.0 - u[0], 1.0 / (exponent + 1.0)), sine = std::sqrt(1.0 - cosine * cosine);
  const double phi = 2.0 * std::numbers::pi * u[1];
  Vec3 at{kPackageHalf * (2.0 * u[2] - 1.0), kPackageHalf * (2.0 * u[3] - 1.0), 0.0};
  if (rim) at = rim_place(u[2], u[3]);
  if (!package && !rim) at = {kDieHalf * (2.0 * u[2] - 1.0), stripes_at(u[3]), 0.0};
  return {at, Direction::from({sine * std::cos(phi), sine * std::sin(phi), cosine})};
}

}  // namespace lucerna::bench::twin
