// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "lucerna/core/host_device.h"

namespace lucerna {

/// Dimensions for which direction numbers are kept.
inline constexpr std::size_t kSobolDimensions = 12;

namespace detail {

/// A primitive polynomial over GF(2) of degree `s` with inner coefficients `a`, and its initial numbers `m`:
/// the first rows of S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional
/// projections", SIAM J. Sci. Comput. 30 (2008).
struct SobolRow {
  std::uint32_t s, a;
  std::array<std::uint32_t, 6> m;
};

inline constexpr std::array<SobolRow, kSobolDimensions - 1> kSobolRows{{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
}};

using SobolMatrix = std::array<std::uint32_t, 32>;

/// Direction numbers as 32-bit binary fractions, bit-reversed (see `owen_sobol_bits`).
constexpr std::array<SobolMatrix, kSobolDimensions> sobol_matrices_reversed() {
  std::array<SobolMatrix, kSobolDimensions> v{};
  for (std::uint32_t k = 0; k < 32; ++k) v[0][k] = 1u << (31 - k);
  for (std::size_t d = 1; d < kSobolDimensions; ++d) {
    const SobolRow& row = kSobolRows[d - 1];
    for (std::uint32_t k = 0; k < 32; ++k) {
      if (k < row.s) {
        v[d][k] = row.m[k] << (31 - k);
        continue;
      }
      v[d][k] = v[d][k - row.s] ^ (v[d][k - row.s] >> row.s);
      for (std::uint32_t j = 1; j < row.s; ++j) {
        if ((row.a >> (row.s - 1 - j)) & 1u) v[d][k] ^= v[d][k - j];
      }
    }
  }
  for (SobolMatrix& matrix : v) {
    for (std::uint32_t& column : matrix) {
      std::uint32_t reversed = 0;
      for (int bit = 0; bit < 32; ++bit) reversed |= ((column >> bit) & 1u) << (31 - bit);
      column = reversed;
    }
  }
  return v;
}

inline constexpr std::array<SobolMatrix, kSobolDimensions> kSobolReversed = sobol_matrices_reversed();
#if defined(__CUDACC__)
/// The same where threads of a GPU read it; they step through its columns together.
static __constant__ std::array<SobolMatrix, kSobolDimensions> kSobolOnDevice = sobol_matrices_reversed();
#endif

LUCERNA_HD constexpr std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0F0F0F0Fu) | ((x & 0x0F0F0F0Fu) << 4);
  x = ((x >> 8) & 0x00FF00FFu) | ((x & 0x00FF00FFu) << 8);
  return (x >> 16) | (x << 16);
}

/// A hash in which bit k of the result depends on bits 0..k of `x` only: on bit-reversed numbers it is a
/// nested uniform (Owen) scrambling. Form of S. Laine and T. Karras, "Stratified sampling for stochastic
/// transparency", EGSR 2011; constants of N. Vegdahl, "Building a better LK hash", 2021.
LUCERNA_HD constexpr std::uint32_t laine_karras_hash(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Finaliser of MurmurHash3 (A. Appleby), 64 bit: spreads (seed, dimension) over all bits.
LUCERNA_HD constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x ^= x >> 33;
  x *= 0xff51afd7ed558ccdull;
  x ^= x >> 33;
  x *= 0xc4ceb9fe1a85ec53ull;
  x ^= x >> 33;
  return x;
}

}  // namespace detail

/// Coordinate `dimension` (< kSobolDimensions) of point `index` of the Sobol sequence, Owen-scrambled with
/// `seed`, as a 32-bit binary fraction. Points 2^32 and beyond start further independent scramblings. No
/// state, thread safe. A. B. Owen, "Randomly permuted (t,m,s)-nets", 1995; B. Burley, "Practical hash-based
/// Owen scrambling", JCGT 9(4), 2020.
LUCERNA_HD inline std::uint32_t owen_sobol_bits(std::uint64_t index, std::uint32_t dimension,
                                                std::uint64_t seed) {
  std::uint32_t x = 0;
#if defined(__CUDA_ARCH__)
  const detail::SobolMatrix& matrix = detail::kSobolOnDevice[dimension];
#else
  const detail::SobolMatrix& matrix = detail::kSobolReversed[dimension];
#endif
  std::uint32_t i = static_cast<std::uint32_t>(index);
  for (std::size_t k = 0; i != 0; i >>= 1, ++k) x ^= (i & 1u) ? matrix[k] : 0u;
  const std::uint64_t key =
      detail::mix_bits(seed + 0x9E3779B97F4A7C15ull * (dimension + 1)) ^ detail::mix_bits(index >> 32);
  x = detail::laine_karras_hash(x, static_cast<std::uint32_t>(key));
  return detail::reverse_bits(x);
}

}  // namespace lucerna
