// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/rays.h"

namespace lucerna {

/// A choice of `count` of `available` rays, spread over their order: ray k of the choice is a random one of
/// the k-th of `count` equal stretches, so that sorted files are thinned evenly too and the choice streams.
/// The same for the same seed. Immutable, thread safe.
class RaySubset {
 public:
  /// 0 <= count <= available; InputError otherwise.
  RaySubset(std::uint64_t available, std::uint64_t count, std::uint64_t seed);

  std::uint64_t count() const { return count_; }
  /// Number in the file of the k-th chosen ray; ascends strictly with k < count.
  std::uint64_t at(std::uint64_t k) const;
  /// The first ray of stretch k; those of stretch `count` begin at the end.
  std::uint64_t begin(std::uint64_t k) const;

  /// Appends to `out` those rays of `block` that are chosen, `first` being the number of the block's first
  /// ray. O(chosen rays).
  void select(const RayBlock& block, std::uint64_t first, RayBlock& out) const;

 private:
  std::uint64_t available_, count_, seed_;
};

}  // namespace lucerna
