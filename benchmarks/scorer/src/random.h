// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace bench {

/// Random numbers of one ray: Philox4x32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy
/// as 1, 2, 3", SC11), keyed by the seed, counted by ray and draw. So ray i has the same numbers whichever
/// thread traces it. Not the generator of any program that makes source files.
class RayRandom {
 public:
  RayRandom(std::uint64_t seed, std::uint64_t ray) : seed_(seed), ray_(ray) {}

  /// In [0, 1), 53 bits.
  double uniform() {
    if (used_ == 2) refill();
    return 0x1p-53 * static_cast<double>(bits_[used_++] >> 11);
  }

 private:
  using Words = std::array<std::uint32_t, 4>;

  static Words round(const Words& c, std::uint32_t k0, std::uint32_t k1) {
    const std::uint64_t a = std::uint64_t{0xD2511F53u} * c[0], b = std::uint64_t{0xCD9E8D57u} * c[2];
    return {static_cast<std::uint32_t>(b >> 32) ^ c[1] ^ k0, static_cast<std::uint32_t>(b),
            static_cast<std::uint32_t>(a >> 32) ^ c[3] ^ k1, static_cast<std::uint32_t>(a)};
  }
  void refill() {
    Words c{static_cast<std::uint32_t>(ray_), static_cast<std::uint32_t>(ray_ >> 32), block_++, 0};
    auto k0 = static_cast<std::uint32_t>(seed_), k1 = static_cast<std::uint32_t>(seed_ >> 32);
    for (int r = 0; r < 10; ++r, k0 += 0x9E3779B9u, k1 += 0xBB67AE85u) c = round(c, k0, k1);
    bits_ = {std::uint64_t{c[1]} << 32 | c[0], std::uint64_t{c[3]} << 32 | c[2]};
    used_ = 0;
  }

  std::uint64_t seed_, ray_;
  std::uint32_t block_ = 0;
  std::array<std::uint64_t, 2> bits_{};
  unsigned used_ = 2;
};

}  // namespace bench
