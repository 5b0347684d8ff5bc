// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "lucerna/host_device.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Philox4x32-10: 128 random bits for every (key, counter), no state (Salmon, Moraes, Dror, Shaw, "Parallel
/// random numbers: as easy as 1, 2, 3", SC 2011). Passes BigCrush; a few ns per call.
LUCERNA_HD inline std::array<std::uint32_t, 4> philox4x32(std::uint64_t key, std::uint64_t counter_low,
                                                          std::uint64_t counter_high) {
  std::uint32_t c0 = static_cast<std::uint32_t>(counter_low),
                c1 = static_cast<std::uint32_t>(counter_low >> 32);
  std::uint32_t c2 = static_cast<std::uint32_t>(counter_high),
                c3 = static_cast<std::uint32_t>(counter_high >> 32);
  std::uint32_t k0 = static_cast<std::uint32_t>(key), k1 = static_cast<std::uint32_t>(key >> 32);
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53u} * c0;
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57u} * c2;
    c0 = static_cast<std::uint32_t>(p1 >> 32) ^ c1 ^ k0;
    c1 = static_cast<std::uint32_t>(p1);
    c2 = static_cast<std::uint32_t>(p0 >> 32) ^ c3 ^ k1;
    c3 = static_cast<std::uint32_t>(p0);
    k0 += 0x9E3779B9u;
    k1 += 0xBB67AE85u;
  }
  return {c0, c1, c2, c3};
}

/// 32 random bits to a double in [0, 1): multiples of 2^-32, never 1.
LUCERNA_HD constexpr double unit_from_bits(std::uint32_t bits) { return bits * 0x1p-32; }

/// The random numbers of one item (ray, sample, cell): a stream keyed by (seed, index), so that item `index`
/// draws the same numbers on any thread, in any order, on any machine. `stream` keeps uses of one seed apart
/// (emission, scatter). Cheap to make; not to be shared between threads.
class Rng {
 public:
  /// The stream of item `index` under `seed`, for the use `stream`.
  LUCERNA_HD Rng(std::uint64_t seed, std::uint64_t index, std::uint32_t stream = 0)
      : seed_(seed), index_(index), high_(std::uint64_t{stream} << 32) {}

  /// The next 32 random bits.
  LUCERNA_HD std::uint32_t bits() {
    if (used_ == 4) {
      block_ = philox4x32(seed_, index_, high_++);
      used_ = 0;
    }
    return block_[static_cast<std::size_t>(used_++)];
  }

  /// The next uniform number in [0, 1).
  LUCERNA_HD double uniform() { return unit_from_bits(bits()); }

 private:
  std::uint64_t seed_, index_, high_;
  std::array<std::uint32_t, 4> block_{};
  int used_ = 4;
};

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

/// Where the numbers of a ray come from.
enum class SequenceKind { random, sobol };

/// The kind of the name "random" or "sobol". Throws UsageError on anything else.
SequenceKind sequence_kind(std::string_view name);
/// "random" or "sobol".
std::string_view to_string(SequenceKind kind);

/// Points of the unit hypercube, numbered: `point<D>(i)` is the i-th, the same for the same (kind, seed, i).
/// Random points are independent; Sobol points are Owen-scrambled with `seed` and fill the cube evenly (use
/// runs of 2^k). Every coordinate is in [0, 1). Thread safe, no state.
class Sequence {
 public:
  /// The sequence of a kind under `seed`.
  LUCERNA_HD Sequence(SequenceKind kind, std::uint64_t seed) : kind_(kind), seed_(seed) {}

  /// The i-th point of dimension D <= kSobolDimensions. Coordinates 0.. are the best spread over: spend them
  /// on what matters most.
  template <std::size_t D>
  LUCERNA_HD std::array<double, D> point(std::uint64_t i) const {
    static_assert(D <= kSobolDimensions);
    std::array<double, D> u;
    if (kind_ == SequenceKind::random) {
      Rng rng(seed_, i);
      for (double& x : u) x = rng.uniform();
    } else {
      for (std::size_t d = 0; d < D; ++d)
        u[d] = unit_from_bits(owen_sobol_bits(i, static_cast<std::uint32_t>(d), seed_));
    }
    return u;
  }

  /// As it was made with.
  SequenceKind kind() const { return kind_; }
  /// As it was made with.
  std::uint64_t seed() const { return seed_; }

 private:
  SequenceKind kind_;
  std::uint64_t seed_;
};

}  // namespace lucerna
#pragma GCC visibility pop
