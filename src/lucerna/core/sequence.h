// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "lucerna/core/random.h"
#include "lucerna/core/sobol.h"

namespace lucerna {

/// Where the numbers of a ray come from.
enum class SequenceKind { random, sobol };

/// "random" or "sobol"; throws UsageError on anything else.
SequenceKind sequence_kind(std::string_view name);
std::string_view to_string(SequenceKind kind);

/// Points of the unit hypercube, numbered: `point<D>(i)` is the i-th, the same for the same (kind, seed, i).
/// Random points are independent; Sobol points are Owen-scrambled with `seed` and fill the cube evenly (use
/// runs of 2^k). Every coordinate is in [0, 1). Thread safe, no state.
class Sequence {
 public:
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

  SequenceKind kind() const { return kind_; }
  std::uint64_t seed() const { return seed_; }

 private:
  SequenceKind kind_;
  std::uint64_t seed_;
};

}  // namespace lucerna
