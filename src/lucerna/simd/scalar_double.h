// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "lucerna/host_device.h"

namespace lucerna {

/// A vector of one double with the operations of simd_double.h: the searches of first_hit.h on a GPU, in code
/// that follows one ray at a time, and on processors without vectors.
struct ScalarDouble {
  static constexpr unsigned kLanes = 1;
  struct Mask {
    bool m;
  };
  double v;
  ScalarDouble() = default;
  LUCERNA_HD ScalarDouble(double x) : v(x) {}
  LUCERNA_HD static Mask mask_of(uint32_t b) { return {(b & 1u) != 0}; }
  LUCERNA_HD static ScalarDouble load(const double* p) { return *p; }
};

LUCERNA_HD inline ScalarDouble::Mask operator&(ScalarDouble::Mask a, ScalarDouble::Mask b) {
  return {a.m && b.m};
}
LUCERNA_HD inline ScalarDouble::Mask operator|(ScalarDouble::Mask a, ScalarDouble::Mask b) {
  return {a.m || b.m};
}
LUCERNA_HD inline ScalarDouble::Mask operator~(ScalarDouble::Mask a) { return {!a.m}; }
LUCERNA_HD inline uint32_t bits(ScalarDouble::Mask a) { return a.m ? 1u : 0u; }

LUCERNA_HD inline ScalarDouble operator+(ScalarDouble a, ScalarDouble b) { return a.v + b.v; }
LUCERNA_HD inline ScalarDouble operator-(ScalarDouble a, ScalarDouble b) { return a.v - b.v; }
LUCERNA_HD inline ScalarDouble operator*(ScalarDouble a, ScalarDouble b) { return a.v * b.v; }
LUCERNA_HD inline ScalarDouble operator/(ScalarDouble a, ScalarDouble b) { return a.v / b.v; }
LUCERNA_HD inline ScalarDouble::Mask operator<(ScalarDouble a, ScalarDouble b) { return {a.v < b.v}; }
LUCERNA_HD inline ScalarDouble::Mask operator<=(ScalarDouble a, ScalarDouble b) { return {a.v <= b.v}; }
LUCERNA_HD inline ScalarDouble select(ScalarDouble::Mask m, ScalarDouble a, ScalarDouble b) {
  return m.m ? a : b;
}
LUCERNA_HD inline ScalarDouble min(ScalarDouble a, ScalarDouble b) { return a.v < b.v ? a : b; }
LUCERNA_HD inline ScalarDouble max(ScalarDouble a, ScalarDouble b) { return a.v > b.v ? a : b; }
LUCERNA_HD inline ScalarDouble sqrt(ScalarDouble a) { return __builtin_sqrt(a.v); }
LUCERNA_HD inline ScalarDouble abs(ScalarDouble a) { return __builtin_fabs(a.v); }
LUCERNA_HD inline ScalarDouble floor(ScalarDouble a) { return __builtin_floor(a.v); }
LUCERNA_HD inline void store(double* p, ScalarDouble a) { *p = a.v; }
/// a b + c, rounded once or twice: for bounds with room for either.
LUCERNA_HD inline float fused(float a, float b, float c) { return a * b + c; }
/// Bit k is the sign of p[k], k < 8.
LUCERNA_HD inline uint32_t signs_of_eight(const int32_t* p) {
  uint32_t out = 0;
  for (uint32_t k = 0; k < 8; ++k) out |= p[k] < 0 ? 1u << k : 0u;
  return out;
}

/// Lanes of `m` take values from p[0] on in turn, others keep those of `old`.
LUCERNA_HD inline ScalarDouble expand(ScalarDouble::Mask m, const double* p, ScalarDouble old) {
  return m.m ? ScalarDouble(*p) : old;
}
/// p[i] of every lane, i a whole number.
LUCERNA_HD inline ScalarDouble gather(const double* p, ScalarDouble i) {
  return p[static_cast<int32_t>(i.v)];
}
/// out[k] = p[i + k] of every lane, k < 4. `i`: a number a lane.
LUCERNA_HD inline void gather4(const double* p, const int32_t* i, ScalarDouble* out) {
  for (int k = 0; k < 4; ++k) out[k] = p[*i + k];
}
LUCERNA_HD inline void gather4(const double* p, ScalarDouble i, ScalarDouble* out) {
  for (int k = 0; k < 4; ++k) out[k] = p[static_cast<int32_t>(i.v) + k];
}

}  // namespace lucerna
