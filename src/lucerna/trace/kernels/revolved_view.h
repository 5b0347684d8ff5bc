// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdint.h>

namespace lucerna {

// A surface of revolution about z, made of cones, as kernels read it: plain data only, as in kernel.h.

/// A ring about consecutive sides: r^2 and z within bounds. Nodes stand in depth-first order: a ray that
/// misses a ring goes on at `skip`, else at the next node.
struct RevolvedNode {
  double r2_low, r2_high, z_low, z_high;
  int32_t skip;
  int32_t side;  ///< of a leaf; -1 within the tree
};

/// A straight side of the outline: part of the cone nr r + nz z = offset, (nr, nz) unit and outward.
struct RevolvedSide {
  double r, z;              ///< where it begins
  double along_r, along_z;  ///< (to - from) / |to - from|^2: a point's share of the way
  double nr, nz, offset;
  double from_nr, from_nz, to_nr, to_nz;  ///< normals of the curve that it stands for, at its ends
};

/// A point on the border of two sides belongs to both: none slips through between them. Share of a side.
inline constexpr double kSideBorder = 1e-9;

struct RevolvedView {
  const RevolvedNode* nodes = nullptr;
  const RevolvedSide* sides = nullptr;
  int32_t node_count = 0;
};

/// Rings that vectors test at once.
inline constexpr int32_t kRingBlock = 8;

/// The bounds of eight rings in float, wider than in RevolvedNode by what float rounds; `r2_high` is
/// the lowest number where there is none. z is counted from the centre of RevolvedBlocks.
struct RingBlock {
  alignas(32) float r2_low[kRingBlock];
  float r2_high[kRingBlock], z_low[kRingBlock], z_high[kRingBlock];
};

/// Levels of RevolvedBlocks at most: 8^8 sides.
inline constexpr int32_t kMostLevels = 8;

/// A tree of rings, eight to a block: block i of a level has those about blocks 8 i, 8 i + 1, ... of the
/// level below, or about these sides.
struct RevolvedBlocks {
  const RevolvedSide* sides = nullptr;
  const RingBlock* levels[kMostLevels] = {};
  int32_t level_count = 0;
  int32_t top_blocks = 0;              ///< of the last level, one or two
  double centre_z = 0.0, reach = 0.0;  ///< of a ball about all
};

}  // namespace lucerna
