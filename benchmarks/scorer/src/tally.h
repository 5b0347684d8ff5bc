// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "target.h"

namespace bench {

/// Independent parts of a trace, from whose scatter all errors are found.
inline constexpr std::size_t kReplicates = 16;

/// Ends of light; whole numbers of quanta, so that sums do not depend on their order.
struct Sums {
  std::uint64_t emitted = 0, left = 0, left_direct = 0;
  std::uint64_t window = 0, window_lossless = 0, rectangle = 0, rectangle_direct = 0;
  std::uint64_t mirror = 0, mirror_back = 0, absorber = 0, bulk = 0, interface = 0, source = 0;
  /// Rays that came to an interface from the wrong side, and those of too many hits.
  std::uint64_t wrong_side = 0, too_many_hits = 0;
};

/// Of one replicate.
struct Replicate {
  Sums sums;
  std::vector<std::uint64_t> box, cell, road;
};

/// What a trace counts. A ray's weight 1 is 2^30 quanta: 2^33 rays fit.
class Tally {
 public:
  explicit Tally(const Target& target);
  static std::uint64_t quanta(double weight) {
    return static_cast<std::uint64_t>(std::llround(0x1p30 * weight));
  }
  /// Light on its last leg; `lossless` is what it would be without losses.
  void leaves(std::size_t replicate, const Landing& landing, double weight, double lossless, bool direct);
  Replicate& operator[](std::size_t replicate) { return replicates_[replicate]; }
  const std::array<Replicate, kReplicates>& replicates() const { return replicates_; }
  Tally& operator+=(const Tally& other);

 private:
  std::array<Replicate, kReplicates> replicates_;
};

}  // namespace bench
