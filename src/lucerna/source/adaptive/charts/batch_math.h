// SPDX-License-Identifier: Apache-2.0
// Functions of angles for loops that compilers vectorise: polynomials, no branches, no library calls.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "lucerna/simd/vector_clones.h"

namespace lucerna::batch {

struct SinCos {
  double sine, cosine;
};

inline double clamped(double x, double low, double high) {
  x = x < low ? low : x;
  return x > high ? high : x;
}

/// Taylor polynomials, exact to 2e-14 for |t| <= pi / 2.
inline double sine_of(double t) {
  const double t2 = t * t;
  double s = 1.0 / 355687428096000.0;
  s = s * t2 - 1.0 / 1307674368000.0;
  s = s * t2 + 1.0 / 6227020800.0;
  s = s * t2 - 1.0 / 39916800.0;
  s = s * t2 + 1.0 / 362880.0;
  s = s * t2 - 1.0 / 5040.0;
  s = s * t2 + 1.0 / 120.0;
  s = s * t2 - 1.0 / 6.0;
  return t + t * t2 * s;
}
inline double cosine_of(double t) {
  const double t2 = t * t;
  double c = -1.0 / 6402373705728000.0;
  c = c * t2 + 1.0 / 20922789888000.0;
  c = c * t2 - 1.0 / 87178291200.0;
  c = c * t2 + 1.0 / 479001600.0;
  c = c * t2 - 1.0 / 3628800.0;
  c = c * t2 + 1.0 / 40320.0;
  c = c * t2 - 1.0 / 720.0;
  c = c * t2 + 1.0 / 24.0;
  c = c * t2 - 0.5;
  return 1.0 + t2 * c;
}

/// The nearest integer for |x| < 2^51, by the rounding of additions.
inline double nearest_integer(double x) {
  constexpr double kMagic = 6755399441055744.0;  // 1.5 * 2^52
  return (x + kMagic) - kMagic;
}

/// Any angle: brought to one turn, halved, doubled.
inline SinCos sin_cos(double angle) {
  const double turns = nearest_integer(angle * (0.5 / std::numbers::pi));
  const double half = 0.5 * (angle - turns * (2.0 * std::numbers::pi));
  const double s = sine_of(half), c = cosine_of(half);
  return {2.0 * s * c, 1.0 - 2.0 * s * s};
}

/// Cube root of 0 <= x < 1e100: a third of the exponent, then Halley's method twice (relative error 1e-14).
inline double cube_root(double x) {
  // A third of the high word: 0x55555556 / 2^32; the constant makes the mean error of the first guess small.
  const std::uint64_t high = std::bit_cast<std::uint64_t>(x + 1e-200) >> 32;
  double r = std::bit_cast<double>(((high * 0x55555556u >> 32) + 715094163u) << 32);
  for (int i = 0; i < 2; ++i) {
    const double r3 = r * r * r;
    r *= (r3 + 2.0 * x) / (2.0 * r3 + x);
  }
  return r;
}

/// Half of the t in t - sin(t) = m, 0 <= m <= 2 pi, to 1e-10: t / (6 m)^(1/3) is smooth in (6 m)^(2/3). The
/// coefficients interpolate it at Chebyshev points for m <= pi.
inline double half_kepler_angle(double m) {
  constexpr double kTwoPi = 2.0 * std::numbers::pi;
  const bool upper = m > std::numbers::pi;
  const double s = cube_root(6.0 * (upper ? kTwoPi - m : m)), z = 0.28237695254580647 * s * s - 1.0;
  double p = 6.705042551402584e-07;
  p = p * z + 1.529783887690428e-06;
  p = p * z + 1.342843346492373e-06;
  p = p * z + 3.606747184221603e-06;
  p = p * z + 1.2360461424520965e-05;
  p = p * z + 3.095487539326314e-05;
  p = p * z + 7.768224567485048e-05;
  p = p * z + 0.00020638575438034935;
  p = p * z + 0.0005679191116329108;
  p = p * z + 0.0016391394291695605;
  p = p * z + 0.005102056314352605;
  p = p * z + 0.018085062573878288;
  p = p * z + 0.08446555317759169;
  p = p * z + 1.0702609054648011;
  const double half = 0.5 * s * p;
  return upper ? std::numbers::pi - half : half;
}

/// Arc tangent of a / b for 0 <= a <= b, exact to 2e-16; 0 if both are 0. Beyond tan(pi / 8) it is pi / 4
/// less that of (b - a) / (b + a); the coefficients interpolate atan(t) / t in t^2 at Chebyshev points.
LUCERNA_ALWAYS_INLINE inline double arc_tangent(double a, double b) {
  const bool far = a > 0.41421356237309505 * b;
  const double above = far ? a - b : a, below = far ? a + b : b;
  const double t = above / (below == 0.0 ? 1.0 : below), z = t * t;
  double p = 0.021135373157693243;
  p = p * z - 0.04348052215716462;
  p = p * z + 0.056883492268090106;
  p = p * z - 0.06640233930429408;
  p = p * z + 0.07689953496306857;
  p = p * z - 0.09090773074808414;
  p = p * z + 0.11111106180455946;
  p = p * z - 0.14285714180976467;
  p = p * z + 0.1999999999885511;
  p = p * z - 0.3333333333332844;
  p = p * z + 1.0;
  return t * p + (far ? 0.25 * std::numbers::pi : 0.0);
}

/// std::atan2 for finite numbers but for the sign of zeros: 0 for (0, 0), pi for (0, x < 0).
LUCERNA_ALWAYS_INLINE inline double azimuth(double y, double x) {
  const double across = std::abs(x), up = std::abs(y);
  const bool steep = up > across;
  const double part = arc_tangent(steep ? across : up, steep ? up : across);
  const double quarter = steep ? 0.5 * std::numbers::pi - part : part;
  const double half = x < 0.0 ? std::numbers::pi - quarter : quarter;
  return y < 0.0 ? -half : half;
}

/// Natural logarithm of 1e-300 < x < 1e300, to 2e-15 of 1 + its size: with x = 2^k m, m nearest to 1, the
/// series of ln m = 2 artanh((m - 1) / (m + 1)).
LUCERNA_ALWAYS_INLINE inline double logarithm(double x) {
  // The bits of sqrt(1/2) less those of 1: m lies between it and sqrt(2).
  constexpr std::uint64_t kOne = 0x3FF0000000000000u, kHalfway = 0x3FE6A09E667F3BCDu;
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(x) + (kOne - kHalfway), power = bits >> 52;
  const double m = std::bit_cast<double>((bits & 0x000FFFFFFFFFFFFFu) + kHalfway);
  // An integer as a double: the low bits of 2^52.
  const double k = std::bit_cast<double>(power | 0x4330000000000000u) - (4503599627370496.0 + 1023.0);
  const double s = (m - 1.0) / (m + 1.0), z = s * s;
  double p = 2.0 / 17.0;
  p = p * z + 2.0 / 15.0;
  p = p * z + 2.0 / 13.0;
  p = p * z + 2.0 / 11.0;
  p = p * z + 2.0 / 9.0;
  p = p * z + 2.0 / 7.0;
  p = p * z + 2.0 / 5.0;
  p = p * z + 2.0 / 3.0;
  return k * std::numbers::ln2 + (2.0 * s + s * z * p);
}

}  // namespace lucerna::batch
