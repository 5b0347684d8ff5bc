// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/rays.h"
#include "lucerna/source/clusters/cluster_directions.h"
#include "lucerna/source/clusters/cluster_model.h"
#include "lucerna/source/clusters/cluster_octree.h"

namespace lucerna {

/// Rays ready to be clustered: on their surface, with weights of mean 1 (0 stays 0) and direction codes.
struct PreparedRays {
  MeshSurface surface;
  RayBlock rays;  // in the order of the octree
  std::vector<std::uint32_t> code;
  /// Rays of leaf l of the octree: leaf_begin[l] .. leaf_begin[l + 1] - 1; and its first cluster.
  std::vector<std::uint32_t> leaf_begin, leaf_cluster;
  /// The first clusters' points: of each leaf the start nearest to its centre of weight, on the grid of the
  /// file and put back on the surface.
  std::vector<Vec3> point_mm;
  std::vector<std::array<std::uint16_t, 3>> place;
  Vec3 low_mm, step_mm;
};

/// Finds the surface, slides rays to it where they must, and makes the first clusters: one per octree leaf,
/// leaves with the same point on the grid counted once, and in a plane 64 points of the rim so that the mesh
/// reaches it.
PreparedRays prepare_rays(const RayBlock& rays, std::size_t min_rays_per_leaf, std::size_t max_leaves);

/// All rays, given to the kept clusters.
struct AssignedRays {
  /// Points, elements and densities are set; directions are not.
  ClusterData data;
  /// Samples of each cluster, codes ascending.
  std::vector<DirectionSample> samples;
  std::vector<std::uint32_t> begin;
};

/// Triangulates the points `retained` (numbers of clusters), gives each ray to the nearest corner of its
/// triangle, drops the holes of the mesh and fits the densities so that each cluster sends out the weight of
/// its rays.
AssignedRays assign_rays(const PreparedRays& prepared, std::vector<std::uint32_t> retained);

/// Sets the directional distributions, and stores them as levels, multiples of `level_step` below the top.
void set_directions(const AssignedRays& assigned, double penalty_nats, int level_step, ClusterData& data);

}  // namespace lucerna
