// SPDX-License-Identifier: Apache-2.0
#pragma once

// Vectors of doubles for the searches of first_hit.h and the kernels of solid_lanes.h. Included only by the
// hit_kernels_*.cpp and solid_kernels_*.cpp files, each compiled for one instruction set, so everything is in
// an anonymous namespace and nothing here may pull in headers of the standard library with inline functions:
// the linker could keep a copy that uses instructions the machine does not have. Products and sums are never
// fused: every instruction set finds the same bits.

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>

namespace lucerna {
namespace {

/// a b + c, rounded once or twice: for bounds with room for either.
inline float fused(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
/// Bit k is the sign of p[k], k < 8; `p` is on a multiple of 32 bytes.
inline uint32_t signs_of_eight(const int32_t* p) {
  const __m256i eight = _mm256_load_si256(reinterpret_cast<const __m256i*>(p));
  return static_cast<uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(eight)));
}

#if defined(__AVX512F__)

struct SimdDouble {
  static constexpr unsigned kLanes = 8;
  struct Mask {
    __mmask8 m;
  };
  __m512d v;
  SimdDouble() = default;
  SimdDouble(__m512d x) : v(x) {}
  SimdDouble(double x) : v(_mm512_set1_pd(x)) {}
  static Mask mask_of(uint32_t b) { return {static_cast<__mmask8>(b)}; }
  static SimdDouble load(const double* p) { return _mm512_loadu_pd(p); }
};

inline SimdDouble::Mask operator&(SimdDouble::Mask a, SimdDouble::Mask b) {
  return {static_cast<__mmask8>(a.m & b.m)};
}
inline SimdDouble::Mask operator|(SimdDouble::Mask a, SimdDouble::Mask b) {
  return {static_cast<__mmask8>(a.m | b.m)};
}
inline SimdDouble::Mask operator~(SimdDouble::Mask a) { return {static_cast<__mmask8>(~a.m)}; }
inline uint32_t bits(SimdDouble::Mask a) { return a.m; }

inline SimdDouble operator+(SimdDouble a, SimdDouble b) { return _mm512_add_pd(a.v, b.v); }
inline SimdDouble operator-(SimdDouble a, SimdDouble b) { return _mm512_sub_pd(a.v, b.v); }
inline SimdDouble operator*(SimdDouble a, SimdDouble b) { return _mm512_mul_pd(a.v, b.v); }
inline SimdDouble operator/(SimdDouble a, SimdDouble b) { return _mm512_div_pd(a.v, b.v); }
inline SimdDouble::Mask operator<(SimdDouble a, SimdDouble b) {
  return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ)};
}
inline SimdDouble::Mask operator<=(SimdDouble a, SimdDouble b) {
  return {_mm512_cmp_pd_mask(a.v, b.v, _CMP_LE_OQ)};
}
inline SimdDouble select(SimdDouble::Mask m, SimdDouble a, SimdDouble b) {
  return _mm512_mask_blend_pd(m.m, b.v, a.v);
}
inline SimdDouble min(SimdDouble a, SimdDouble b) { return _mm512_min_pd(a.v, b.v); }
inline SimdDouble max(SimdDouble a, SimdDouble b) { return _mm512_max_pd(a.v, b.v); }
inline SimdDouble sqrt(SimdDouble a) { return _mm512_sqrt_pd(a.v); }
inline SimdDouble abs(SimdDouble a) { return _mm512_abs_pd(a.v); }
inline SimdDouble floor(SimdDouble a) { return _mm512_floor_pd(a.v); }
inline void store(double* p, SimdDouble a) { _mm512_storeu_pd(p, a.v); }
inline SimdDouble expand(SimdDouble::Mask m, const double* p, SimdDouble old) {
  return _mm512_mask_expand_pd(old.v, m.m, _mm512_loadu_pd(p));
}
inline SimdDouble gather(const double* p, SimdDouble i) {
  return _mm512_i32gather_pd(_mm512_cvttpd_epi32(i.v), p, 8);
}
/// By whole loads and a transpose, which is faster than four gathers.
inline void gather4(const double* p, const int32_t* k, SimdDouble* out) {
  const auto rows = [&](int n) {
    return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(p + k[n])),
                              _mm256_loadu_pd(p + k[n + 4]), 1);
  };
  const __m512d q0 = rows(0), q1 = rows(1), q2 = rows(2), q3 = rows(3);
  const __m512d l01 = _mm512_unpacklo_pd(q0, q1), h01 = _mm512_unpackhi_pd(q0, q1);
  const __m512d l23 = _mm512_unpacklo_pd(q2, q3), h23 = _mm512_unpackhi_pd(q2, q3);
  const __m512i even = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  const __m512i odd = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  out[0] = _mm512_permutex2var_pd(l01, even, l23);
  out[1] = _mm512_permutex2var_pd(h01, even, h23);
  out[2] = _mm512_permutex2var_pd(l01, odd, l23);
  out[3] = _mm512_permutex2var_pd(h01, odd, h23);
}
inline void gather4(const double* p, SimdDouble i, SimdDouble* out) {
  alignas(32) int32_t k[8];
  _mm256_store_si256(reinterpret_cast<__m256i*>(k), _mm512_cvttpd_epi32(i.v));
  gather4(p, k, out);
}

#elif defined(__AVX2__)

struct SimdDouble {
  static constexpr unsigned kLanes = 4;
  struct Mask {
    __m256d m;
  };
  __m256d v;
  SimdDouble() = default;
  SimdDouble(__m256d x) : v(x) {}
  SimdDouble(double x) : v(_mm256_set1_pd(x)) {}
  static Mask mask_of(uint32_t b) {
    const __m256i lane = _mm256_setr_epi64x(1, 2, 4, 8);
    const __m256i set = _mm256_and_si256(_mm256_set1_epi64x(b), lane);
    return {_mm256_castsi256_pd(_mm256_cmpeq_epi64(set, lane))};
  }
  static SimdDouble load(const double* p) { return _mm256_loadu_pd(p); }
};

inline SimdDouble::Mask operator&(SimdDouble::Mask a, SimdDouble::Mask b) {
  return {_mm256_and_pd(a.m, b.m)};
}
inline SimdDouble::Mask operator|(SimdDouble::Mask a, SimdDouble::Mask b) { return {_mm256_or_pd(a.m, b.m)}; }
inline SimdDouble::Mask operator~(SimdDouble::Mask a) {
  return {_mm256_xor_pd(a.m, _mm256_castsi256_pd(_mm256_set1_epi64x(-1)))};
}
inline uint32_t bits(SimdDouble::Mask a) { return static_cast<uint32_t>(_mm256_movemask_pd(a.m)); }

inline SimdDouble operator+(SimdDouble a, SimdDouble b) { return _mm256_add_pd(a.v, b.v); }
inline SimdDouble operator-(SimdDouble a, SimdDouble b) { return _mm256_sub_pd(a.v, b.v); }
inline SimdDouble operator*(SimdDouble a, SimdDouble b) { return _mm256_mul_pd(a.v, b.v); }
inline SimdDouble operator/(SimdDouble a, SimdDouble b) { return _mm256_div_pd(a.v, b.v); }
inline SimdDouble::Mask operator<(SimdDouble a, SimdDouble b) {
  return {_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)};
}
inline SimdDouble::Mask operator<=(SimdDouble a, SimdDouble b) {
  return {_mm256_cmp_pd(a.v, b.v, _CMP_LE_OQ)};
}
inline SimdDouble select(SimdDouble::Mask m, SimdDouble a, SimdDouble b) {
  return _mm256_blendv_pd(b.v, a.v, m.m);
}
inline SimdDouble min(SimdDouble a, SimdDouble b) { return _mm256_min_pd(a.v, b.v); }
inline SimdDouble max(SimdDouble a, SimdDouble b) { return _mm256_max_pd(a.v, b.v); }
inline SimdDouble sqrt(SimdDouble a) { return _mm256_sqrt_pd(a.v); }
inline SimdDouble abs(SimdDouble a) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v); }
inline SimdDouble floor(SimdDouble a) { return _mm256_floor_pd(a.v); }
inline void store(double* p, SimdDouble a) { _mm256_storeu_pd(p, a.v); }
/// Halves of doubles: lane k takes as many doubles on as lanes before it are set.
struct ExpandedLanes {
  alignas(32) int32_t of[16][8];
  constexpr ExpandedLanes() : of() {
    for (unsigned set = 0; set < 16; ++set) {
      int32_t next = 0;
      for (size_t lane = 0; lane < 4; ++lane) {
        of[set][2 * lane] = 2 * next;
        of[set][2 * lane + 1] = 2 * next + 1;
        next += (set >> lane & 1U) != 0 ? 1 : 0;
      }
    }
  }
};
inline constexpr ExpandedLanes kExpandedLanes;
inline SimdDouble expand(SimdDouble::Mask m, const double* p, SimdDouble old) {
  const auto* const lanes = reinterpret_cast<const __m256i*>(kExpandedLanes.of[bits(m)]);
  const __m256 all = _mm256_castpd_ps(_mm256_loadu_pd(p));
  return _mm256_blendv_pd(old.v, _mm256_castps_pd(_mm256_permutevar8x32_ps(all, _mm256_load_si256(lanes))),
                          m.m);
}
inline SimdDouble gather(const double* p, SimdDouble i) {
  const __m256d all = _mm256_castsi256_pd(_mm256_set1_epi64x(-1));
  return _mm256_mask_i32gather_pd(_mm256_setzero_pd(), p, _mm256_cvttpd_epi32(i.v), all, 8);
}
inline void gather4(const double* p, const int32_t* k, SimdDouble* out) {
  const __m256d r0 = _mm256_loadu_pd(p + k[0]), r1 = _mm256_loadu_pd(p + k[1]);
  const __m256d r2 = _mm256_loadu_pd(p + k[2]), r3 = _mm256_loadu_pd(p + k[3]);
  const __m256d l01 = _mm256_unpacklo_pd(r0, r1), h01 = _mm256_unpackhi_pd(r0, r1);
  const __m256d l23 = _mm256_unpacklo_pd(r2, r3), h23 = _mm256_unpackhi_pd(r2, r3);
  out[0] = _mm256_permute2f128_pd(l01, l23, 0x20);
  out[1] = _mm256_permute2f128_pd(h01, h23, 0x20);
  out[2] = _mm256_permute2f128_pd(l01, l23, 0x31);
  out[3] = _mm256_permute2f128_pd(h01, h23, 0x31);
}
inline void gather4(const double* p, SimdDouble i, SimdDouble* out) {
  alignas(16) int32_t k[4];
  _mm_store_si128(reinterpret_cast<__m128i*>(k), _mm256_cvttpd_epi32(i.v));
  gather4(p, k, out);
}

#endif

}  // namespace
}  // namespace lucerna
