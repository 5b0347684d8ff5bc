// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/source/clusters/mesh_surface.h"
#include "lucerna/source/clusters/mesh_triangulation.h"

namespace lucerna {

/// A ray as the removal of clusters sees it.
struct ClusterRay {
  float arm_x = 0.0f, arm_y = 0.0f, arm_z = 0.0f;  // start - surface centre, mm
  std::uint32_t code = 0;                          // of its direction (spherical_triangle.h)
  float weight = 0.0f;                             // mean about 1
  std::uint32_t cluster = 0;

  Vec3 radius_vector() const {
    return {static_cast<double>(arm_x), static_cast<double>(arm_y), static_cast<double>(arm_z)};
  }
};

/// What decides whether a cluster stays.
struct RemovalOptions {
  /// Price of a split of a directional distribution into four, in nats of log-likelihood.
  double penalty_nats = 6.0;
  /// Price of a cluster (its point, density and triangles) in splits.
  double cluster_price = 2.5;
  /// Clusters that always stay.
  std::size_t min_clusters = 32;
};

/// What is left when nothing more is removed.
struct RemovalResult {
  /// Numbers of the clusters that stay, ascending.
  std::vector<std::uint32_t> retained;
  std::size_t rounds = 0;
};

/// The iteration of Mas, Martin and Patow on a surface with an area: triangulate the representatives, give
/// every ray to the nearest corner of its triangle, mark the clusters that add no detail, remove them, and
/// begin again, until none is marked.
///
/// A cluster adds no detail when the log-likelihood that its removal costs is below its price: the loss of
/// its directional distribution and its nearest neighbour's against one common distribution (each the best
/// tree at the same penalty), plus the Poisson loss of the density at its point against the linear
/// interpolation of its neighbours', plus, at a rim, the rays in the ear that is cut off. Of marked
/// neighbours only the one that costs least goes in a round, so that every removed cluster's rays find kept
/// neighbours. `points` are all representatives, `rays[i].cluster` starts as an index of them. Same result
/// for any number of threads. Calls `progress` once a round.
RemovalResult remove_clusters(const MeshSurface& surface, const std::vector<Vec3>& points,
                              std::vector<ClusterRay>& rays, std::vector<std::uint32_t> retained,
                              const RemovalOptions& options, Progress& progress);

/// The nearest corner (helpers do not count) of triangle `t` to the point at `radius_vector`; the nearest
/// point of the mesh if all corners are helpers.
std::uint32_t nearest_corner(const Triangulation& mesh, std::uint32_t t, const Vec3& radius_vector);

/// Area of each triangle on the surface, mm^2: once split at the edges' midpoints, which are put back.
std::vector<double> triangle_areas(const MeshSurface& surface, const Triangulation& mesh);

/// Density per point and what is no part of the surface.
struct MeshDensity {
  /// Weight per mm^2 at each point: rays shared out by their barycentric coordinates, over a third of the
  /// area round it.
  std::vector<double> density;
  /// Sum of the weights in each triangle.
  std::vector<double> weight;
  /// Triangles with helpers, and those that are empty where the density round them expects 12 rays or more (a
  /// chance of 6e-6): openings of the surface, gaps between emitters.
  std::vector<bool> hole;
  /// A third of the area of the triangles round each point, mm^2.
  std::vector<double> area;
};

/// `shares` are each point's barycentric sums, `weight` each triangle's.
MeshDensity mesh_density(const Triangulation& mesh, const std::vector<double>& areas,
                         std::vector<double> shares, std::vector<double> weight);

}  // namespace lucerna
