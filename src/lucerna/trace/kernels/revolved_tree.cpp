// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/revolved_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

RevolvedSide side_of(const OutlineSide& s) {
  const double dr = s.to[0] - s.from[0], dz = s.to[1] - s.from[1], length = std::hypot(dr, dz);
  const double nr = dz / length, nz = -dr / length, square = length * length;
  return {s.from[0],
          s.from[1],
          dr / square,
          dz / square,
          nr,
          nz,
          nr * s.from[0] + nz * s.from[1],
          s.from_normal[0],
          s.from_normal[1],
          s.to_normal[0],
          s.to_normal[1]};
}

/// About one side, wider than it by what rounding may move a hit.
RevolvedNode ring_about(const OutlineSide& s) {
  const double slack = 1e-9 * (std::hypot(s.from[0], s.from[1]) + std::hypot(s.to[0], s.to[1]));
  const double low = std::max(std::min(s.from[0], s.to[0]) - slack, 0.0);
  const double high = std::max(s.from[0], s.to[0]) + slack;
  return {low * low, high * high, std::min(s.from[1], s.to[1]) - slack, std::max(s.from[1], s.to[1]) + slack,
          0,         -1};
}

/// About both.
RevolvedNode ring_about(const RevolvedNode& a, const RevolvedNode& b) {
  return {std::min(a.r2_low, b.r2_low),
          std::max(a.r2_high, b.r2_high),
          std::min(a.z_low, b.z_low),
          std::max(a.z_high, b.z_high),
          0,
          -1};
}

/// Appends the tree over the leaves [first, end); returns the ring about them.
RevolvedNode add_nodes(const std::vector<RevolvedNode>& leaves, std::size_t first, std::size_t end,
                       std::vector<RevolvedNode>& nodes) {
  const std::size_t at = nodes.size();
  nodes.push_back(leaves[first]);
  if (end - first == 1) {
    nodes[at].side = static_cast<std::int32_t>(first);
  } else {
    const std::size_t middle = first + (end - first) / 2;
    const RevolvedNode a = add_nodes(leaves, first, middle, nodes), b = add_nodes(leaves, middle, end, nodes);
    nodes[at] = ring_about(a, b);
  }
  nodes[at].skip = static_cast<std::int32_t>(nodes.size());
  return nodes[at];
}

/// What float rounds is below this, over the reach of all rings or its square (solid_lanes.h).
constexpr double kFloatSlack = 2e-6;

std::vector<RingBlock> blocks_of(const std::vector<RevolvedNode>& rings, double centre_z, double reach) {
  const double slack = kFloatSlack * reach;
  std::vector<RingBlock> out;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const std::size_t k = i % kRingBlock;
    if (k == 0) {
      out.emplace_back();
      // Below whatever r^2 is rounded to, also in a body of kilometres.
      std::fill_n(out.back().r2_high, kRingBlock, std::numeric_limits<float>::lowest());
    }
    RingBlock& block = out.back();
    block.r2_low[k] = static_cast<float>(rings[i].r2_low - slack * reach);
    block.r2_high[k] = static_cast<float>(rings[i].r2_high + slack * reach);
    block.z_low[k] = static_cast<float>(rings[i].z_low - centre_z - slack);
    block.z_high[k] = static_cast<float>(rings[i].z_high - centre_z + slack);
  }
  return out;
}

/// Rings about as many as a block has.
std::vector<RevolvedNode> rings_about_blocks(const std::vector<RevolvedNode>& rings) {
  std::vector<RevolvedNode> out;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (i % kRingBlock == 0) {
      out.push_back(rings[i]);
    } else {
      out.back() = ring_about(out.back(), rings[i]);
    }
  }
  return out;
}

}  // namespace

RevolvedBlocks RevolvedTree::blocks() const {
  RevolvedBlocks out{.sides = sides_.data(),
                     .top_blocks = static_cast<std::int32_t>(top_blocks_),
                     .centre_z = centre_z_,
                     .reach = reach_};
  for (const std::vector<RingBlock>& level : levels_) out.levels[out.level_count++] = level.data();
  return out;
}

RevolvedTree::RevolvedTree(const std::vector<OutlineSide>& sides) {
  LUCERNA_CHECK(!sides.empty(), "an outline of {} sides", sides.size());
  std::vector<RevolvedNode> leaves;
  for (const OutlineSide& s : sides) {
    sides_.push_back(side_of(s));
    leaves.push_back(ring_about(s));
  }
  nodes_.reserve(2 * leaves.size());
  add_nodes(leaves, 0, leaves.size(), nodes_);
  centre_z_ = 0.5 * (nodes_[0].z_low + nodes_[0].z_high);
  reach_ = std::hypot(std::sqrt(nodes_[0].r2_high), 0.5 * (nodes_[0].z_high - nodes_[0].z_low));
  // A level of two blocks is tested sooner than one of one, and then two below it.
  do {
    levels_.push_back(blocks_of(leaves, centre_z_, reach_));
    leaves = rings_about_blocks(leaves);
  } while (leaves.size() > 2);
  top_blocks_ = leaves.size();
  LUCERNA_CHECK(levels_.size() <= kMostLevels, "{} levels", levels_.size());
}

}  // namespace lucerna
