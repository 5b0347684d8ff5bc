// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/ray_numbering.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "lucerna/core/io/error.h"
#include "lucerna/core/math/int128.h"

namespace lucerna {

namespace {

/// round(n * part / whole), exact.
std::uint64_t rounded_share(std::uint64_t n, std::uint64_t part, std::uint64_t whole) {
  return static_cast<std::uint64_t>((static_cast<UInt128>(n) * part + whole / 2) / whole);
}

std::vector<std::uint64_t> source_shares(const std::vector<PlacedSource>& sources) {
  constexpr double kSampledRays = 0x1p20;
  double sampled_flux = 0.0;
  for (const PlacedSource& s : sources) sampled_flux += s.rays->ray_count() ? 0.0 : s.total_flux();
  std::vector<std::uint64_t> shares;
  for (const PlacedSource& s : sources) {
    const double drawn = kSampledRays * s.total_flux() / sampled_flux;
    shares.push_back(s.rays->ray_count() ? *s.rays->ray_count()
                                         : static_cast<std::uint64_t>(std::max(1.0, drawn)));
  }
  return shares;
}

}  // namespace

SourceInterleaving::SourceInterleaving(const std::vector<std::uint64_t>& shares) {
  // Huffman's order joins the two least shares first, so large ones sit near the root, where rounding is
  // least.
  using Entry = std::pair<std::uint64_t, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (const std::uint64_t share : shares) {
    LUCERNA_CHECK(share > 0 && share < (std::uint64_t{1} << 62), "share = {}", share);
    open.emplace(share, nodes_.size());
    nodes_.push_back({share, 0, false, 0});
  }
  LUCERNA_CHECK(!open.empty(), "no sources");
  while (open.size() > 1) {
    const Entry a = open.top();
    open.pop();
    const Entry b = open.top();
    open.pop();
    const std::size_t parent = nodes_.size();
    nodes_[a.second].parent = nodes_[b.second].parent = parent;
    nodes_[a.second].is_left = true;
    nodes_.push_back({a.first + b.first, parent, false, a.first});
    open.emplace(a.first + b.first, parent);
  }
}

std::uint64_t SourceInterleaving::count(std::size_t source, std::uint64_t n) const {
  if (source + 1 == nodes_.size()) return n;
  const Node& node = nodes_[source];
  const Node& parent = nodes_[node.parent];
  const std::uint64_t m = count(node.parent, n);
  const std::uint64_t left = rounded_share(m, parent.left_total, parent.total);
  return node.is_left ? left : m - left;
}

RayNumbering::RayNumbering(const std::vector<PlacedSource>& sources, std::uint64_t seed)
    : word_(source_shares(sources)), seed_(seed) {
  const double flux = total_flux(sources);
  for (std::size_t s = 0; s < sources.size(); ++s) {
    const double per_block = static_cast<double>(kBlockRays) * static_cast<double>(word_.share(s)) /
                             static_cast<double>(word_.total());
    // The word deviates by less than 1 + log2(sources) at either end of a block.
    const double spread = 2.0 * (1.0 + std::log2(static_cast<double>(sources.size())));
    const std::uint64_t max = static_cast<std::uint64_t>(std::ceil(per_block + spread));
    const double share = per_block / static_cast<double>(kBlockRays);
    streams_.push_back({sources[s].rays->ray_count().has_value(), std::min(kBlockRays, max),
                        sources[s].total_flux() / flux / share});
  }
}

std::uint64_t RayNumbering::last_ray(std::optional<std::uint64_t> asked) const {
  const std::uint64_t wanted = asked.value_or(default_count());
  const bool has_file = std::ranges::any_of(streams_, [](const Stream& s) { return s.finite; });
  return has_file ? std::min(wanted, default_count()) : wanted;
}

std::vector<SourceRun> RayNumbering::runs(std::uint64_t first, std::uint64_t last) const {
  const std::uint64_t block = first / kBlockRays;
  std::vector<SourceRun> result;
  for (std::size_t s = 0; s < streams_.size(); ++s) {
    const std::uint64_t begin = word_.count(s, first), end = word_.count(s, last);
    if (begin == end) continue;
    std::uint64_t seed = detail::mix_bits(seed_ + 0x9E3779B97F4A7C15ull * (s + 1));
    std::uint64_t index = begin;
    if (!streams_[s].finite) {
      seed = detail::mix_bits(seed + 0xD1B54A32D192ED03ull * (block % kReplicates + 1));
      index = block / kReplicates * streams_[s].slot + (begin - word_.count(s, block * kBlockRays));
    }
    result.push_back({s, index, end - begin, seed});
  }
  return result;
}

}  // namespace lucerna
