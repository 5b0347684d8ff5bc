// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_octree.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/core/parallel/parallel_sort.h"

namespace lucerna {

namespace {

constexpr int kOctreeLevels = 21;  // three coordinates of 21 bits fill a 64-bit key
constexpr std::size_t kOctreeBlock = std::size_t{1} << 16;

struct Bounds {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
};

Bounds bounds_of(const RayBlock& rays) {
  const auto parts =
      parallel_map_blocks<Bounds>(rays.size(), kOctreeBlock, [&](std::size_t first, std::size_t last) {
        Bounds b;
        for (std::size_t i = first; i < last; ++i) {
          if (!(rays.weight[i] > 0.0f)) continue;
          const Vec3 p = rays.origin_mm(i);
          b.low = {std::min(b.low.x, p.x), std::min(b.low.y, p.y), std::min(b.low.z, p.z)};
          b.high = {std::max(b.high.x, p.x), std::max(b.high.y, p.y), std::max(b.high.z, p.z)};
        }
        return b;
      });
  Bounds all;
  for (const Bounds& b : parts) {
    all.low = {std::min(all.low.x, b.low.x), std::min(all.low.y, b.low.y), std::min(all.low.z, b.low.z)};
    all.high = {std::max(all.high.x, b.high.x), std::max(all.high.y, b.high.y),
                std::max(all.high.z, b.high.z)};
  }
  return all;
}

/// Bit i goes to bit 3 i.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffull;
  x = (x | x << 16) & 0x1f0000ff0000ffull;
  x = (x | x << 8) & 0x100f00f00f00f00full;
  x = (x | x << 4) & 0x10c30c30c30c30c3ull;
  return (x | x << 2) & 0x1249249249249249ull;
}

struct Keyed {
  std::uint64_t key;
  std::uint32_t ray;
};

/// A cube that was split: its rays, and the leaves that this made out of one, less one.
struct Split {
  std::size_t rays, more;
};

void split(const std::vector<Keyed>& keyed, std::size_t first, std::size_t last, int level,
           std::size_t max_rays, std::vector<std::uint32_t>& begin, std::vector<Split>& splits) {
  if (last - first <= max_rays || level == kOctreeLevels) {
    begin.push_back(static_cast<std::uint32_t>(first));
    return;
  }
  const int shift = 3 * (kOctreeLevels - 1 - level);
  std::size_t children = 0;
  for (std::size_t from = first; from < last; ++children) {
    const std::uint64_t cell = keyed[from].key >> shift;
    const auto end = std::partition_point(keyed.begin() + static_cast<std::ptrdiff_t>(from),
                                          keyed.begin() + static_cast<std::ptrdiff_t>(last),
                                          [&](const Keyed& k) { return k.key >> shift == cell; });
    const auto next = static_cast<std::size_t>(end - keyed.begin());
    split(keyed, from, next, level + 1, max_rays, begin, splits);
    from = next;
  }
  splits.push_back({last - first, children - 1});
}

/// The least number of rays that a leaf may be filled with so that there are at most `max_leaves`.
std::size_t min_fill(std::vector<Split> splits, std::size_t max_leaves) {
  std::sort(splits.begin(), splits.end(), [](const Split& a, const Split& b) { return a.rays > b.rays; });
  std::size_t leaves = 1;
  for (const Split& s : splits) {
    leaves += s.more;
    if (leaves > max_leaves) return s.rays;
  }
  return 0;
}

}  // namespace

PositionOctree build_position_octree(const RayBlock& rays, std::size_t min_rays, std::size_t max_leaves) {
  if (rays.size() >= std::numeric_limits<std::uint32_t>::max()) {
    throw InputError(fmt::format("{} rays; at most {} can be clustered", rays.size(), 0xfffffffeu));
  }
  const Bounds bounds = bounds_of(rays);
  if (bounds.low.x > bounds.high.x) throw InputError("no rays with flux to compress");
  const Vec3 size = bounds.high - bounds.low;
  const double edge = std::max({size.x, size.y, size.z});
  const double scale = edge > 0.0 ? 2097151.0 / edge : 0.0;

  std::vector<Keyed> keyed(rays.size());
  parallel_blocks(rays.size(), kOctreeBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Vec3 p = scale * (rays.origin_mm(i) - bounds.low);
      const auto cell = [](double x) {
        return spread(static_cast<std::uint64_t>(std::clamp(x, 0.0, 2097151.0)));
      };
      keyed[i] = {cell(p.x) | cell(p.y) << 1 | cell(p.z) << 2, static_cast<std::uint32_t>(i)};
    }
  });
  std::erase_if(keyed, [&](const Keyed& k) { return !(rays.weight[k.ray] > 0.0f); });
  parallel_sort(keyed.begin(), keyed.end(), [](const Keyed& a, const Keyed& b) {
    return std::tie(a.key, a.ray) < std::tie(b.key, b.ray);
  });

  PositionOctree tree;
  std::vector<Split> splits;
  const std::size_t max = std::max<std::size_t>(1, max_leaves);
  // Fuller leaves than the mean leaf there must be.
  const std::size_t min = std::max({std::size_t{1}, min_rays, keyed.size() / max});
  split(keyed, 0, keyed.size(), 0, min, tree.begin, splits);
  if (const std::size_t fill = min_fill(splits, max); fill > min) {
    tree.begin.clear();
    split(keyed, 0, keyed.size(), 0, fill, tree.begin, splits);
  }
  tree.begin.push_back(static_cast<std::uint32_t>(keyed.size()));
  tree.order.resize(keyed.size());
  for (std::size_t i = 0; i < keyed.size(); ++i) tree.order[i] = keyed[i].ray;
  return tree;
}

}  // namespace lucerna
