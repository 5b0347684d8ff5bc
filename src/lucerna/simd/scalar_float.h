// SPDX-License-Identifier: Apache-2.0
#pragma once

// Vectors of one lane with the operations of simd_float.h: what the tracing kernels are on a GPU, where every
// thread follows one ray, and on the CPU as the instruction set "scalar" that the tests run in its place.
// Both compile the same kernels from the same headers.

#include <stdint.h>

#include "lucerna/host_device.h"

namespace lucerna {
namespace {

inline constexpr int kLanes = 1;
struct Mask {
  bool m;
};
struct Float {
  float v;
  Float() = default;
  LUCERNA_HD Float(float x) : v(x) {}
};
struct Int {
  int32_t v;
  Int() = default;
  LUCERNA_HD explicit Int(int32_t x) : v(x) {}
};

LUCERNA_HD inline Mask operator&(Mask a, Mask b) { return {a.m && b.m}; }
LUCERNA_HD inline Mask operator|(Mask a, Mask b) { return {a.m || b.m}; }
LUCERNA_HD inline Mask operator~(Mask a) { return {!a.m}; }
LUCERNA_HD inline uint32_t bits(Mask a) { return a.m ? 1u : 0u; }
LUCERNA_HD inline Mask mask_of(uint32_t b) { return {(b & 1u) != 0}; }

LUCERNA_HD inline Float operator+(Float a, Float b) { return a.v + b.v; }
LUCERNA_HD inline Float operator-(Float a, Float b) { return a.v - b.v; }
LUCERNA_HD inline Float operator*(Float a, Float b) { return a.v * b.v; }
LUCERNA_HD inline Float operator/(Float a, Float b) { return a.v / b.v; }
/// Fused on a GPU, as with AVX2 and AVX-512; not in a plain CPU build, as "portable" is not.
LUCERNA_HD inline Float fma(Float a, Float b, Float c) {
#if defined(__CUDA_ARCH__) || defined(__FMA__)
  return __builtin_fmaf(a.v, b.v, c.v);
#else
  return a.v * b.v + c.v;
#endif
}
LUCERNA_HD inline Float min(Float a, Float b) { return a.v < b.v ? a.v : b.v; }
LUCERNA_HD inline Float max(Float a, Float b) { return a.v > b.v ? a.v : b.v; }
LUCERNA_HD inline Float sqrt(Float a) { return __builtin_sqrtf(a.v); }
LUCERNA_HD inline Float abs(Float a) { return __builtin_fabsf(a.v); }
LUCERNA_HD inline Mask operator<(Float a, Float b) { return {a.v < b.v}; }
LUCERNA_HD inline Mask operator<=(Float a, Float b) { return {a.v <= b.v}; }
LUCERNA_HD inline Float select(Mask m, Float a, Float b) { return m.m ? a.v : b.v; }
LUCERNA_HD inline Float load(const float* p) { return *p; }
LUCERNA_HD inline void store(float* p, Float a) { *p = a.v; }
/// From arrays that no kernel writes: on a GPU through the read-only cache.
LUCERNA_HD inline Float gather(const float* p, Int i) {
#if defined(__CUDA_ARCH__)
  return __ldg(p + i.v);
#else
  return p[i.v];
#endif
}
/// What does not fit becomes the least int, as with the vector instructions.
LUCERNA_HD inline Int truncate(Float a) {
  return Int(__builtin_fabsf(a.v) < 2147483648.0f ? static_cast<int32_t>(a.v) : INT32_MIN);
}
LUCERNA_HD inline Float to_float(Int a) { return static_cast<float>(a.v); }

LUCERNA_HD inline Int operator+(Int a, Int b) { return Int(a.v + b.v); }
LUCERNA_HD inline Int operator-(Int a, Int b) { return Int(a.v - b.v); }
LUCERNA_HD inline Int operator*(Int a, Int b) { return Int(a.v * b.v); }
LUCERNA_HD inline Int min(Int a, Int b) { return a.v < b.v ? a : b; }
LUCERNA_HD inline Int max(Int a, Int b) { return a.v > b.v ? a : b; }
LUCERNA_HD inline Int shift_left(Int a, Int n) {
  return Int(static_cast<int32_t>(static_cast<uint32_t>(a.v) << n.v));
}
LUCERNA_HD inline Int shift_right(Int a, Int n) {
  return Int(static_cast<int32_t>(static_cast<uint32_t>(a.v) >> n.v));
}
LUCERNA_HD inline Mask operator<(Int a, Int b) { return {a.v < b.v}; }
LUCERNA_HD inline Mask operator==(Int a, Int b) { return {a.v == b.v}; }
LUCERNA_HD inline Int select(Mask m, Int a, Int b) { return m.m ? a : b; }
LUCERNA_HD inline Int load(const int32_t* p) { return Int(*p); }
LUCERNA_HD inline void store(int32_t* p, Int a) { *p = a.v; }
LUCERNA_HD inline Int gather(const int32_t* p, Int i) {
#if defined(__CUDA_ARCH__)
  return Int(__ldg(p + i.v));
#else
  return Int(p[i.v]);
#endif
}
LUCERNA_HD inline Float compress(Mask, Float a) { return a; }
LUCERNA_HD inline Int compress(Mask, Int a) { return a; }
LUCERNA_HD inline Int float_bits(Float a) {
#if defined(__CUDA_ARCH__)
  return Int(__float_as_int(a.v));
#else
  int32_t b = 0;
  __builtin_memcpy(&b, &a.v, sizeof b);
  return Int(b);
#endif
}

}  // namespace
}  // namespace lucerna
