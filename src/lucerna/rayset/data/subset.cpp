// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/subset.h"

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {

RaySubset::RaySubset(std::uint64_t available, std::uint64_t wanted, std::uint64_t seed)
    : available_(available), wanted_(wanted), seed_(seed) {
  if (wanted > available) {
    throw InputError(fmt::format("{} rays asked for, there are {}", wanted, available));
  }
}

std::uint64_t RaySubset::begin(std::uint64_t k) const {
  // k * available / wanted without overflow: files are far below 2^64 bytes, but the product need not be.
  const std::uint64_t whole = available_ / wanted_, rest = available_ % wanted_;
  __extension__ using Wide = unsigned __int128;
  return k * whole + static_cast<std::uint64_t>(Wide{k} * rest / wanted_);
}

std::uint64_t RaySubset::at(std::uint64_t k) const {
  const std::uint64_t first = begin(k), size = begin(k + 1) - first;
  Rng rng(seed_, k);
  const std::uint64_t bits = (std::uint64_t{rng.bits()} << 32) | rng.bits();
  return first + bits % size;
}

void RaySubset::select(const RayBlock& block, std::uint64_t first, RayBlock& out) const {
  if (wanted_ == 0 || block.empty()) return;
  if (out.empty()) out.extra.resize(block.extra.size());
  // The first stretch that may hold a ray of the block: begin(k + 1) > first.
  __extension__ using Wide = unsigned __int128;
  auto k = static_cast<std::uint64_t>(Wide{first} * wanted_ / available_);
  while (k > 0 && begin(k) > first) --k;
  for (; k < wanted_; ++k) {
    const std::uint64_t ray = at(k);
    if (ray >= first + block.size()) break;
    if (ray >= first) out.append(block, static_cast<std::size_t>(ray - first));
  }
}

}  // namespace lucerna
