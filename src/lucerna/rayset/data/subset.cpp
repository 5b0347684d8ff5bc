// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/subset.h"

#include "lucerna/core/io/error.h"
#include "lucerna/core/math/int128.h"
#include "lucerna/random.h"

namespace lucerna {

RaySubset::RaySubset(std::uint64_t available, std::uint64_t count, std::uint64_t seed)
    : available_(available), count_(count), seed_(seed) {
  if (count > available) {
    throw InputError(fmt::format("{} rays asked for, there are {}", count, available));
  }
}

std::uint64_t RaySubset::begin(std::uint64_t k) const {
  if (count_ == 0) return available_;
  // k * available / count without overflow: files are far below 2^64 bytes, but the product need not be.
  const std::uint64_t whole = available_ / count_, rest = available_ % count_;
  return k * whole + static_cast<std::uint64_t>(UInt128{k} * rest / count_);
}

std::uint64_t RaySubset::at(std::uint64_t k) const {
  const std::uint64_t first = begin(k), size = begin(k + 1) - first;
  Rng rng(seed_, k);
  const std::uint64_t bits = (std::uint64_t{rng.bits()} << 32) | rng.bits();
  return first + bits % size;
}

void RaySubset::select(const RayBlock& block, std::uint64_t first, RayBlock& out) const {
  if (count_ == 0 || block.empty()) return;
  if (out.empty()) out.extra.resize(block.extra.size());
  if (count_ == available_) return out.append(block);
  // The first stretch that may hold a ray of the block: begin(k + 1) > first.
  auto k = static_cast<std::uint64_t>(UInt128{first} * count_ / available_);
  while (k > 0 && begin(k) > first) --k;
  for (; k < count_; ++k) {
    const std::uint64_t ray = at(k);
    if (ray >= first + block.size()) break;
    if (ray >= first) out.append(block, static_cast<std::size_t>(ray - first));
  }
}

}  // namespace lucerna
