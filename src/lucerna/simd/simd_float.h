// SPDX-License-Identifier: Apache-2.0
#pragma once

// Vectors of float and int32 lanes for the tracing kernels. Included only by the kernel_*.cpp files, each
// compiled for one instruction set, so everything is in an anonymous namespace and nothing here may pull in
// headers of the standard library with inline functions: the linker could keep a copy that uses instructions
// the machine does not have.

#include <stdint.h>

#include "lucerna/host_device.h"

#if defined(LUCERNA_SCALAR) || defined(__CUDACC__)
#include "lucerna/simd/scalar_float.h"
#elif defined(__AVX512F__) || defined(__AVX2__)
#include <immintrin.h>
#endif

namespace lucerna {
namespace {

#if defined(LUCERNA_SCALAR) || defined(__CUDACC__)

// scalar_float.h has them.

#elif defined(__AVX512F__)

inline constexpr int kLanes = 16;
struct Mask {
  __mmask16 m;
};
struct Float {
  __m512 v;
  Float() = default;
  Float(__m512 x) : v(x) {}
  Float(float x) : v(_mm512_set1_ps(x)) {}
};
struct Int {
  __m512i v;
  Int() = default;
  Int(__m512i x) : v(x) {}
  explicit Int(int32_t x) : v(_mm512_set1_epi32(x)) {}
};

inline Mask operator&(Mask a, Mask b) { return {static_cast<__mmask16>(a.m & b.m)}; }
inline Mask operator|(Mask a, Mask b) { return {static_cast<__mmask16>(a.m | b.m)}; }
inline Mask operator~(Mask a) { return {static_cast<__mmask16>(~a.m)}; }
inline uint32_t bits(Mask a) { return a.m; }
inline Mask mask_of(uint32_t b) { return {static_cast<__mmask16>(b)}; }

inline Float operator+(Float a, Float b) { return _mm512_add_ps(a.v, b.v); }
inline Float operator-(Float a, Float b) { return _mm512_sub_ps(a.v, b.v); }
inline Float operator*(Float a, Float b) { return _mm512_mul_ps(a.v, b.v); }
inline Float operator/(Float a, Float b) { return _mm512_div_ps(a.v, b.v); }
inline Float fma(Float a, Float b, Float c) { return _mm512_fmadd_ps(a.v, b.v, c.v); }
inline Float min(Float a, Float b) { return _mm512_min_ps(a.v, b.v); }
inline Float max(Float a, Float b) { return _mm512_max_ps(a.v, b.v); }
inline Float sqrt(Float a) { return _mm512_sqrt_ps(a.v); }
inline Float abs(Float a) { return _mm512_abs_ps(a.v); }
inline Mask operator<(Float a, Float b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ)}; }
inline Mask operator<=(Float a, Float b) { return {_mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ)}; }
inline Float select(Mask m, Float a, Float b) { return _mm512_mask_blend_ps(m.m, b.v, a.v); }
inline Float load(const float* p) { return _mm512_loadu_ps(p); }
inline void store(float* p, Float a) { _mm512_storeu_ps(p, a.v); }
inline Float gather(const float* p, Int i) { return _mm512_i32gather_ps(i.v, p, 4); }
inline Int truncate(Float a) { return _mm512_cvttps_epi32(a.v); }
inline Float to_float(Int a) { return _mm512_cvtepi32_ps(a.v); }

inline Int operator+(Int a, Int b) { return _mm512_add_epi32(a.v, b.v); }
inline Int operator-(Int a, Int b) { return _mm512_sub_epi32(a.v, b.v); }
inline Int operator*(Int a, Int b) { return _mm512_mullo_epi32(a.v, b.v); }
inline Int min(Int a, Int b) { return _mm512_min_epi32(a.v, b.v); }
inline Int max(Int a, Int b) { return _mm512_max_epi32(a.v, b.v); }
inline Int shift_left(Int a, Int n) { return _mm512_sllv_epi32(a.v, n.v); }
inline Int shift_right(Int a, Int n) { return _mm512_srlv_epi32(a.v, n.v); }
inline Mask operator<(Int a, Int b) { return {_mm512_cmplt_epi32_mask(a.v, b.v)}; }
inline Mask operator==(Int a, Int b) { return {_mm512_cmpeq_epi32_mask(a.v, b.v)}; }
inline Int select(Mask m, Int a, Int b) { return _mm512_mask_blend_epi32(m.m, b.v, a.v); }
inline Int load(const int32_t* p) { return _mm512_loadu_si512(p); }
inline void store(int32_t* p, Int a) { _mm512_storeu_si512(p, a.v); }
inline Int gather(const int32_t* p, Int i) { return _mm512_i32gather_epi32(i.v, p, 4); }
inline Int float_bits(Float a) { return _mm512_castps_si512(a.v); }
/// The lanes of `m`, moved together to the front; what follows is anything.
inline Float compress(Mask m, Float a) { return _mm512_maskz_compress_ps(m.m, a.v); }
inline Int compress(Mask m, Int a) { return _mm512_maskz_compress_epi32(m.m, a.v); }

/// Four numbers of every lane, from each of kRows arrays, by whole loads and a transpose: a third of the time
/// of gathers here. `four_at(row, place)` reads them.
template <int kRows, typename Load>
inline void transposed(Int i, Load four_at, Float (&out)[kRows][4]) {
  alignas(64) int32_t k[16];
  _mm512_store_si512(k, i.v);
  // Places go through memory: taken out of the vector one by one they cost more than all that is read there.
  asm("" : "+m"(k));
  __m512 q[kRows][4];
  for (int n = 0; n < 4; ++n) {
    for (int r = 0; r < kRows; ++r) {
      q[r][n] = _mm512_castps128_ps512(four_at(r, k[n]));
      q[r][n] = _mm512_insertf32x4(q[r][n], four_at(r, k[n + 4]), 1);
      q[r][n] = _mm512_insertf32x4(q[r][n], four_at(r, k[n + 8]), 2);
      q[r][n] = _mm512_insertf32x4(q[r][n], four_at(r, k[n + 12]), 3);
    }
  }
  for (int r = 0; r < kRows; ++r) {
    const __m512 l01 = _mm512_unpacklo_ps(q[r][0], q[r][1]), l23 = _mm512_unpacklo_ps(q[r][2], q[r][3]);
    const __m512 h01 = _mm512_unpackhi_ps(q[r][0], q[r][1]), h23 = _mm512_unpackhi_ps(q[r][2], q[r][3]);
    out[r][0] = _mm512_shuffle_ps(l01, l23, 0x44);
    out[r][1] = _mm512_shuffle_ps(l01, l23, 0xEE);
    out[r][2] = _mm512_shuffle_ps(h01, h23, 0x44);
    out[r][3] = _mm512_shuffle_ps(h01, h23, 0xEE);
  }
}
inline __m128 three_at(const float* p) { return _mm_maskz_loadu_ps(7, p); }

#elif defined(__AVX2__)

inline constexpr int kLanes = 8;
struct Mask {
  __m256 m;
};
struct Float {
  __m256 v;
  Float() = default;
  Float(__m256 x) : v(x) {}
  Float(float x) : v(_mm256_set1_ps(x)) {}
};
struct Int {
  __m256i v;
  Int() = default;
  Int(__m256i x) : v(x) {}
  explicit Int(int32_t x) : v(_mm256_set1_epi32(x)) {}
};

inline Mask operator&(Mask a, Mask b) { return {_mm256_and_ps(a.m, b.m)}; }
inline Mask operator|(Mask a, Mask b) { return {_mm256_or_ps(a.m, b.m)}; }
inline Mask operator~(Mask a) { return {_mm256_xor_ps(a.m, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))}; }
inline uint32_t bits(Mask a) { return static_cast<uint32_t>(_mm256_movemask_ps(a.m)); }
inline Mask mask_of(uint32_t b) {
  const __m256i lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  const __m256i set = _mm256_and_si256(_mm256_set1_epi32(static_cast<int32_t>(b)), lane);
  return {_mm256_castsi256_ps(_mm256_cmpeq_epi32(set, lane))};
}

inline Float operator+(Float a, Float b) { return _mm256_add_ps(a.v, b.v); }
inline Float operator-(Float a, Float b) { return _mm256_sub_ps(a.v, b.v); }
inline Float operator*(Float a, Float b) { return _mm256_mul_ps(a.v, b.v); }
inline Float operator/(Float a, Float b) { return _mm256_div_ps(a.v, b.v); }
inline Float fma(Float a, Float b, Float c) { return _mm256_fmadd_ps(a.v, b.v, c.v); }
inline Float min(Float a, Float b) { return _mm256_min_ps(a.v, b.v); }
inline Float max(Float a, Float b) { return _mm256_max_ps(a.v, b.v); }
inline Float sqrt(Float a) { return _mm256_sqrt_ps(a.v); }
inline Float abs(Float a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v); }
inline Mask operator<(Float a, Float b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ)}; }
inline Mask operator<=(Float a, Float b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)}; }
inline Float select(Mask m, Float a, Float b) { return _mm256_blendv_ps(b.v, a.v, m.m); }
inline Float load(const float* p) { return _mm256_loadu_ps(p); }
inline void store(float* p, Float a) { _mm256_storeu_ps(p, a.v); }
inline Float gather(const float* p, Int i) { return _mm256_i32gather_ps(p, i.v, 4); }
inline Int truncate(Float a) { return _mm256_cvttps_epi32(a.v); }
inline Float to_float(Int a) { return _mm256_cvtepi32_ps(a.v); }

inline Int operator+(Int a, Int b) { return _mm256_add_epi32(a.v, b.v); }
inline Int operator-(Int a, Int b) { return _mm256_sub_epi32(a.v, b.v); }
inline Int operator*(Int a, Int b) { return _mm256_mullo_epi32(a.v, b.v); }
inline Int min(Int a, Int b) { return _mm256_min_epi32(a.v, b.v); }
inline Int max(Int a, Int b) { return _mm256_max_epi32(a.v, b.v); }
inline Int shift_left(Int a, Int n) { return _mm256_sllv_epi32(a.v, n.v); }
inline Int shift_right(Int a, Int n) { return _mm256_srlv_epi32(a.v, n.v); }
inline Mask operator<(Int a, Int b) { return {_mm256_castsi256_ps(_mm256_cmpgt_epi32(b.v, a.v))}; }
inline Mask operator==(Int a, Int b) { return {_mm256_castsi256_ps(_mm256_cmpeq_epi32(a.v, b.v))}; }
inline Int select(Mask m, Int a, Int b) { return _mm256_blendv_epi8(b.v, a.v, _mm256_castps_si256(m.m)); }
inline Int load(const int32_t* p) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p)); }
inline void store(int32_t* p, Int a) { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), a.v); }
inline Int gather(const int32_t* p, Int i) { return _mm256_i32gather_epi32(p, i.v, 4); }
inline Int float_bits(Float a) { return _mm256_castps_si256(a.v); }

/// For each set of eight lanes their numbers, a byte each, the lowest first.
struct LaneNumbers {
  uint64_t of[256] = {};
  constexpr LaneNumbers() {
    for (uint32_t m = 0; m < 256; ++m) {
      int at = 0;
      for (uint64_t lane = 0; lane < 8; ++lane) {
        if ((m >> lane & 1u) != 0) of[m] |= lane << 8 * at++;
      }
    }
  }
};
inline constexpr LaneNumbers kLaneNumbers;

inline Float compress(Mask m, Float a) {
  const __m128i lanes = _mm_cvtsi64_si128(static_cast<int64_t>(kLaneNumbers.of[bits(m)]));
  return _mm256_permutevar8x32_ps(a.v, _mm256_cvtepu8_epi32(lanes));
}
inline Int compress(Mask m, Int a) {
  return _mm256_castps_si256(compress(m, Float(_mm256_castsi256_ps(a.v))).v);
}

/// Four numbers of every lane, from each of kRows arrays, by whole loads and a transpose.
template <int kRows, typename Load>
inline void transposed(Int i, Load four_at, Float (&out)[kRows][4]) {
  alignas(32) int32_t k[8];
  _mm256_store_si256(reinterpret_cast<__m256i*>(k), i.v);
  asm("" : "+m"(k));
  __m256 q[kRows][4];
  for (int n = 0; n < 4; ++n) {
    for (int r = 0; r < kRows; ++r) {
      q[r][n] = _mm256_insertf128_ps(_mm256_castps128_ps256(four_at(r, k[n])), four_at(r, k[n + 4]), 1);
    }
  }
  for (int r = 0; r < kRows; ++r) {
    const __m256 l01 = _mm256_unpacklo_ps(q[r][0], q[r][1]), l23 = _mm256_unpacklo_ps(q[r][2], q[r][3]);
    const __m256 h01 = _mm256_unpackhi_ps(q[r][0], q[r][1]), h23 = _mm256_unpackhi_ps(q[r][2], q[r][3]);
    out[r][0] = _mm256_shuffle_ps(l01, l23, 0x44);
    out[r][1] = _mm256_shuffle_ps(l01, l23, 0xEE);
    out[r][2] = _mm256_shuffle_ps(h01, h23, 0x44);
    out[r][3] = _mm256_shuffle_ps(h01, h23, 0xEE);
  }
}
inline __m128 three_at(const float* p) { return _mm_maskload_ps(p, _mm_setr_epi32(-1, -1, -1, 0)); }

#else

inline constexpr int kLanes = 8;
struct Mask {
  int32_t m[kLanes];
};
struct Float {
  float v[kLanes];
  Float() = default;
  Float(float x) {
    for (float& lane : v) lane = x;
  }
};
struct Int {
  int32_t v[kLanes];
  Int() = default;
  explicit Int(int32_t x) {
    for (int32_t& lane : v) lane = x;
  }
};

// Loops of a fixed length that the compiler turns into whatever vectors it has.
template <class R, class F>
inline R lanes(F f) {
  R r;
  for (int i = 0; i < kLanes; ++i) r.v[i] = f(i);
  return r;
}
template <class F>
inline Mask mask_lanes(F f) {
  Mask r;
  for (int i = 0; i < kLanes; ++i) r.m[i] = f(i) ? -1 : 0;
  return r;
}

inline Mask operator&(Mask a, Mask b) {
  return mask_lanes([&](int i) { return (a.m[i] & b.m[i]) != 0; });
}
inline Mask operator|(Mask a, Mask b) {
  return mask_lanes([&](int i) { return (a.m[i] | b.m[i]) != 0; });
}
inline Mask operator~(Mask a) {
  return mask_lanes([&](int i) { return a.m[i] == 0; });
}
inline uint32_t bits(Mask a) {
  uint32_t b = 0;
  for (int i = 0; i < kLanes; ++i) b |= a.m[i] != 0 ? 1u << i : 0u;
  return b;
}
inline Mask mask_of(uint32_t b) {
  return mask_lanes([&](int i) { return ((b >> i) & 1u) != 0; });
}

inline Float operator+(Float a, Float b) {
  return lanes<Float>([&](int i) { return a.v[i] + b.v[i]; });
}
inline Float operator-(Float a, Float b) {
  return lanes<Float>([&](int i) { return a.v[i] - b.v[i]; });
}
inline Float operator*(Float a, Float b) {
  return lanes<Float>([&](int i) { return a.v[i] * b.v[i]; });
}
inline Float operator/(Float a, Float b) {
  return lanes<Float>([&](int i) { return a.v[i] / b.v[i]; });
}
inline Float fma(Float a, Float b, Float c) {
  return lanes<Float>([&](int i) { return a.v[i] * b.v[i] + c.v[i]; });
}
inline Float min(Float a, Float b) {
  return lanes<Float>([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
inline Float max(Float a, Float b) {
  return lanes<Float>([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
inline Float sqrt(Float a) {
  return lanes<Float>([&](int i) { return __builtin_sqrtf(a.v[i]); });
}
inline Float abs(Float a) {
  return lanes<Float>([&](int i) { return __builtin_fabsf(a.v[i]); });
}
inline Mask operator<(Float a, Float b) {
  return mask_lanes([&](int i) { return a.v[i] < b.v[i]; });
}
inline Mask operator<=(Float a, Float b) {
  return mask_lanes([&](int i) { return a.v[i] <= b.v[i]; });
}
inline Float select(Mask m, Float a, Float b) {
  return lanes<Float>([&](int i) { return m.m[i] != 0 ? a.v[i] : b.v[i]; });
}
inline Float load(const float* p) {
  return lanes<Float>([&](int i) { return p[i]; });
}
inline void store(float* p, Float a) {
  for (int i = 0; i < kLanes; ++i) p[i] = a.v[i];
}
inline Float gather(const float* p, Int k) {
  return lanes<Float>([&](int i) { return p[k.v[i]]; });
}
/// Like the vector instructions: what does not fit becomes the least int.
inline Int truncate(Float a) {
  return lanes<Int>([&](int i) {
    return __builtin_fabsf(a.v[i]) < 2147483648.0f ? static_cast<int32_t>(a.v[i]) : INT32_MIN;
  });
}
inline Float to_float(Int a) {
  return lanes<Float>([&](int i) { return static_cast<float>(a.v[i]); });
}

inline Int operator+(Int a, Int b) {
  return lanes<Int>([&](int i) { return a.v[i] + b.v[i]; });
}
inline Int operator-(Int a, Int b) {
  return lanes<Int>([&](int i) { return a.v[i] - b.v[i]; });
}
inline Int operator*(Int a, Int b) {
  return lanes<Int>([&](int i) { return a.v[i] * b.v[i]; });
}
inline Int min(Int a, Int b) {
  return lanes<Int>([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
inline Int max(Int a, Int b) {
  return lanes<Int>([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
inline Int shift_left(Int a, Int n) {
  return lanes<Int>([&](int i) { return static_cast<int32_t>(static_cast<uint32_t>(a.v[i]) << n.v[i]); });
}
inline Int shift_right(Int a, Int n) {
  return lanes<Int>([&](int i) { return static_cast<int32_t>(static_cast<uint32_t>(a.v[i]) >> n.v[i]); });
}
inline Mask operator<(Int a, Int b) {
  return mask_lanes([&](int i) { return a.v[i] < b.v[i]; });
}
inline Mask operator==(Int a, Int b) {
  return mask_lanes([&](int i) { return a.v[i] == b.v[i]; });
}
inline Int select(Mask m, Int a, Int b) {
  return lanes<Int>([&](int i) { return m.m[i] != 0 ? a.v[i] : b.v[i]; });
}
inline Int load(const int32_t* p) {
  return lanes<Int>([&](int i) { return p[i]; });
}
inline void store(int32_t* p, Int a) {
  for (int i = 0; i < kLanes; ++i) p[i] = a.v[i];
}
inline Int gather(const int32_t* p, Int k) {
  return lanes<Int>([&](int i) { return p[k.v[i]]; });
}
template <class V>
inline V compress(Mask m, V a) {
  V r = a;
  int at = 0;
  for (int i = 0; i < kLanes; ++i) {
    r.v[at] = a.v[i];
    at += m.m[i] & 1;
  }
  return r;
}
inline Int float_bits(Float a) {
  return lanes<Int>([&](int i) {
    int32_t b = 0;
    __builtin_memcpy(&b, &a.v[i], sizeof b);
    return b;
  });
}

#endif

#if (defined(__AVX2__) || defined(__AVX512F__)) && !defined(LUCERNA_SCALAR) && !defined(__CUDACC__)
/// p[r][i] .. p[r][i + 3] of every lane, for each r.
template <int kRows>
inline void gather4(const float* const (&p)[kRows], Int i, Float (&out)[kRows][4]) {
  transposed<kRows>(
      i, [&p](int r, int32_t k) { return _mm_loadu_ps(p[r] + k); }, out);
}
/// p[i] .. p[i + 2] of every lane; reads nothing behind them.
inline void gather3(const float* p, Int i, Float& a, Float& b, Float& c) {
  Float out[1][4];
  transposed<1>(
      i, [p](int, int32_t k) { return three_at(p + k); }, out);
  a = out[0][0];
  b = out[0][1];
  c = out[0][2];
}
#else
template <int kRows>
LUCERNA_HD inline void gather4(const float* const (&p)[kRows], Int i, Float (&out)[kRows][4]) {
  for (int r = 0; r < kRows; ++r) {
    for (int c = 0; c < 4; ++c) out[r][c] = gather(p[r] + c, i);
  }
}
LUCERNA_HD inline void gather3(const float* p, Int i, Float& a, Float& b, Float& c) {
  a = gather(p, i);
  b = gather(p + 1, i);
  c = gather(p + 2, i);
}
#endif

/// p[i] .. p[i + 3] of every lane.
LUCERNA_HD inline void gather4(const float* p, Int i, Float& a, Float& b, Float& c, Float& d) {
  const float* const rows[1] = {p};
  Float out[1][4];
  gather4(rows, i, out);
  a = out[0][0];
  b = out[0][1];
  c = out[0][2];
  d = out[0][3];
}

LUCERNA_HD inline bool any(Mask a) { return bits(a) != 0; }

/// Asks for the cache lines of p[i] in the lanes of `m`, which will be read soon. Nothing on a GPU.
LUCERNA_HD inline void prefetch([[maybe_unused]] const float* p, [[maybe_unused]] Int i,
                                [[maybe_unused]] Mask m) {
#if !defined(LUCERNA_SCALAR) && !defined(__CUDACC__)
  alignas(64) int32_t k[kLanes];
  store(k, i);
  asm("" : "+m"(k));
  for (uint32_t left = bits(m); left != 0; left &= left - 1) __builtin_prefetch(p + k[__builtin_ctz(left)]);
#endif
}

}  // namespace
}  // namespace lucerna
