// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "lucerna/core/host_device.h"

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

}  // namespace lucerna
