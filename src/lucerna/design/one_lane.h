// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

#include "lucerna/host_device.h"

namespace lucerna {

/// A vector of one double with the operations of wide.h: the searches of first_hit.h on a GPU, in code that
/// follows one ray at a time, and on processors without vectors.
struct OneLane {
  static constexpr unsigned kLanes = 1;
  struct Mask {
    bool m;
  };
  double v;
  OneLane() = default;
  LUCERNA_HD OneLane(double x) : v(x) {}
  LUCERNA_HD static Mask mask_of(uint32_t b) { return {(b & 1u) != 0}; }
};

LUCERNA_HD inline OneLane::Mask operator&(OneLane::Mask a, OneLane::Mask b) { return {a.m && b.m}; }
LUCERNA_HD inline OneLane::Mask operator|(OneLane::Mask a, OneLane::Mask b) { return {a.m || b.m}; }
LUCERNA_HD inline OneLane::Mask operator~(OneLane::Mask a) { return {!a.m}; }
LUCERNA_HD inline uint32_t bits(OneLane::Mask a) { return a.m ? 1u : 0u; }

LUCERNA_HD inline OneLane operator+(OneLane a, OneLane b) { return a.v + b.v; }
LUCERNA_HD inline OneLane operator-(OneLane a, OneLane b) { return a.v - b.v; }
LUCERNA_HD inline OneLane operator*(OneLane a, OneLane b) { return a.v * b.v; }
LUCERNA_HD inline OneLane operator/(OneLane a, OneLane b) { return a.v / b.v; }
LUCERNA_HD inline OneLane::Mask operator<(OneLane a, OneLane b) { return {a.v < b.v}; }
LUCERNA_HD inline OneLane::Mask operator<=(OneLane a, OneLane b) { return {a.v <= b.v}; }
LUCERNA_HD inline OneLane select(OneLane::Mask m, OneLane a, OneLane b) { return m.m ? a : b; }
LUCERNA_HD inline OneLane min(OneLane a, OneLane b) { return a.v < b.v ? a : b; }
LUCERNA_HD inline OneLane max(OneLane a, OneLane b) { return a.v > b.v ? a : b; }
LUCERNA_HD inline OneLane sqrt(OneLane a) { return __builtin_sqrt(a.v); }
LUCERNA_HD inline OneLane abs(OneLane a) { return __builtin_fabs(a.v); }
LUCERNA_HD inline OneLane floor(OneLane a) { return __builtin_floor(a.v); }
LUCERNA_HD inline void store(double* p, OneLane a) { *p = a.v; }

/// Lanes of `m` take values from p[0] on in turn, others keep those of `old`.
LUCERNA_HD inline OneLane expand(OneLane::Mask m, const double* p, OneLane old) {
  return m.m ? OneLane(*p) : old;
}
/// p[i] of every lane, i a whole number.
LUCERNA_HD inline OneLane gather(const double* p, OneLane i) { return p[static_cast<int32_t>(i.v)]; }
/// out[k] = p[i + k] of every lane, k < 4.
LUCERNA_HD inline void gather4(const double* p, OneLane i, OneLane* out) {
  for (int k = 0; k < 4; ++k) out[k] = p[static_cast<int32_t>(i.v) + k];
}

}  // namespace lucerna
