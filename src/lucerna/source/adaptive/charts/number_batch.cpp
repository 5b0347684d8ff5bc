// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/number_batch.h"

#include "lucerna/simd/vector_clones.h"

namespace lucerna {

namespace {

/// philox4x32 (lucerna/random.h) for all points at once.
LUCERNA_VECTOR_CLONES void philox_batch(std::uint64_t key, std::uint64_t first,
                                        std::array<BitColumn, 4>& bits) {
  const auto low = static_cast<std::uint32_t>(first), high = static_cast<std::uint32_t>(first >> 32);
  std::uint32_t* b0 = bits[0].data();
  std::uint32_t* b1 = bits[1].data();
  std::uint32_t* b2 = bits[2].data();
  std::uint32_t* b3 = bits[3].data();
  for (std::uint32_t i = 0; i < kSupportBatch; ++i) {
    std::uint32_t c0 = low + i, c1 = high + (c0 < low ? 1u : 0u), c2 = 0, c3 = 0;
    auto k0 = static_cast<std::uint32_t>(key), k1 = static_cast<std::uint32_t>(key >> 32);
#pragma GCC unroll 10
    for (int round = 0; round < 10; ++round) {
      const std::uint64_t p0 = std::uint64_t{0xD2511F53u} * c0, p1 = std::uint64_t{0xCD9E8D57u} * c2;
      c0 = static_cast<std::uint32_t>(p1 >> 32) ^ c1 ^ k0;
      c1 = static_cast<std::uint32_t>(p1);
      c2 = static_cast<std::uint32_t>(p0 >> 32) ^ c3 ^ k1;
      c3 = static_cast<std::uint32_t>(p0);
      k0 += 0x9E3779B9u;
      k1 += 0xBB67AE85u;
    }
    b0[i] = c0, b1[i] = c1, b2[i] = c2, b3[i] = c3;
  }
}

constexpr std::size_t kLowPoints = kSupportBatch;
static_assert((kLowPoints & (kLowPoints - 1)) == 0);

/// Unscrambled points 0 .. kLowPoints - 1, bit-reversed: Sobol points are linear in the bits of their number.
constexpr std::array<BitColumn, 4> low_points() {
  std::array<BitColumn, 4> points{};
  for (std::size_t d = 0; d < 4; ++d) {
    for (std::uint32_t i = 0; i < kLowPoints; ++i) {
      std::uint32_t x = 0;
      for (std::size_t k = 0; k < 32; ++k) x ^= (i >> k & 1u) != 0 ? detail::kSobolReversed[d][k] : 0u;
      points[d][i] = x;
    }
  }
  return points;
}
constexpr std::array<BitColumn, 4> kLow = low_points();

LUCERNA_VECTOR_CLONES void scrambled(const std::uint32_t* low, std::uint32_t high, std::uint32_t key,
                                     std::size_t n, std::uint32_t* out) {
  for (std::size_t i = 0; i < n; ++i) {
    out[i] = detail::reverse_bits(detail::laine_karras_hash(low[i] ^ high, key));
  }
}

/// owen_sobol_bits (lucerna/random.h): what the low bits of the number give comes from the table, the rest is
/// the same for all points between two multiples of the table's length.
void sobol_batch(std::uint64_t seed, std::uint64_t first, std::array<BitColumn, 4>& bits) {
  for (std::size_t done = 0; done < kSupportBatch;) {
    const std::uint64_t index = first + done, start = index % kLowPoints;
    const std::size_t n = std::min<std::size_t>(kLowPoints - start, kSupportBatch - done);
    for (std::size_t d = 0; d < 4; ++d) {
      std::uint32_t high = 0;
      auto rest = static_cast<std::uint32_t>(index - start);
      for (std::size_t k = 0; rest != 0; rest >>= 1, ++k) {
        high ^= (rest & 1u) != 0 ? detail::kSobolReversed[d][k] : 0u;
      }
      const std::uint64_t key =
          detail::mix_bits(seed + 0x9E3779B97F4A7C15ull * (d + 1)) ^ detail::mix_bits(index >> 32);
      scrambled(kLow[d].data() + start, high, static_cast<std::uint32_t>(key), n, bits[d].data() + done);
    }
    done += n;
  }
}

}  // namespace

void number_batch(const Sequence& sequence, std::uint64_t first, std::array<BitColumn, 4>& bits) {
  if (sequence.kind() == SequenceKind::random)
    philox_batch(sequence.seed(), first, bits);
  else
    sobol_batch(sequence.seed(), first, bits);
}

}  // namespace lucerna
