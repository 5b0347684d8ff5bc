// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lucerna/source/clusters/cluster_view.h"
#include "lucerna/source/clusters/mesh_surface.h"
#include "lucerna/source/clusters/mesh_triangulation.h"
#include "lucerna/source/clusters/spherical_triangle.h"
#include "lucerna/source/file/nfl.h"
#include "lucerna/source_model.h"

namespace lucerna {

inline constexpr NflTag kClusterMethod{'C', 'L', 'U', 'S'};

/// A constant piece of a cluster's directional distribution, as stored: its weight relative to the cluster's
/// heaviest piece is 2^((level - 255) / 16), and nothing at level 0.
struct ClusterLeaf {
  std::uint32_t code = 0;
  std::uint8_t depth = 0, level = 0;
  friend bool operator==(const ClusterLeaf&, const ClusterLeaf&) = default;
};

/// All that a model of clusters stores.
struct ClusterData {
  double flux = 0.0;
  FluxUnit flux_unit = FluxUnit::lumen;
  std::uint64_t training_rays = 0;
  MeshSurface surface;
  /// Representative points, as steps of a grid: low + step * place, put back on the surface.
  Vec3 low_mm, step_mm;
  std::vector<std::array<std::uint16_t, 3>> place;
  /// Density at each point, relative: 2^((level - 65535) / 1024), nothing at level 0. Per mm^2 for triangles,
  /// per mm for segments, as it is for points.
  std::vector<std::uint16_t> density;
  /// Three clusters each: a triangle, or with the last two equal a segment, or with all equal a point.
  std::vector<Triangle> elements;
  /// Leaves of cluster v are leaf[leaf_begin[v]] .. leaf[leaf_begin[v + 1] - 1]: ascending, covering the
  /// sphere, not all of level 0.
  std::vector<std::uint32_t> leaf_begin;
  std::vector<ClusterLeaf> leaf;

  std::size_t clusters() const { return place.size(); }
  Vec3 point_mm(std::size_t v) const;
  double relative_density(std::size_t v) const;

  friend bool operator==(const ClusterData&, const ClusterData&) = default;
};

/// What the stored levels mean, and the level nearest to a relative value (0 for what is not > 0).
double relative_density_of(std::uint16_t level);
std::uint16_t density_level(double relative);
double relative_weight_of(std::uint8_t level);
std::uint8_t weight_level(double relative);

/// The file's sections, and back; `name` is for messages. Every count, index and tree is checked.
NflFile encode_clusters(const ClusterData& data);
ClusterData decode_clusters(const NflFile& file, std::string_view name);

/// The pieces of all elements: triangles are split at their edges' midpoints, put back on the surface, while
/// a midpoint lies off its edge by more than 1 % of it, at most `kMeshSplits` times.
inline constexpr int kMeshSplits = 4;
std::vector<MeshPiece> mesh_pieces(const ClusterData& data);

/// Mas-Martin-Patow clusters as a source: anisotropic point lights on a mesh over the bounding surface. A ray
/// is a triangle (alias table), a point in it (density interpolated linearly between the corners, point put
/// back on the surface), and a direction from the distribution of the triangle's nearest corner (alias table,
/// uniform in a spherical triangle). Takes six numbers of the sequence: 0 piece and corner, 1-2 point, 3
/// leaf, 4-5 direction.
class ClusterModel final : public SourceModel {
 public:
  /// `data` must be as decode_clusters checks it.
  explicit ClusterModel(ClusterData data);
  static std::unique_ptr<ClusterModel> from_nfl(const NflFile& file, std::string_view name);

  double flux() const override { return data_.flux; }
  FluxUnit flux_unit() const override { return data_.flux_unit; }
  void emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const override;

  std::string_view method() const override { return "clusters"; }
  std::size_t layers() const override { return 1; }
  std::size_t leaves() const override { return data_.leaf.size(); }
  std::uint64_t training_rays() const override { return data_.training_rays; }
  /// Looks at every element and at the pieces of one: for tests and weights, not for inner loops.
  double pdf_area(const Vec3& point_mm) const override;
  double pdf_solid_angle(const Vec3& point_mm, const Direction& direction) const override;
  double pdf_etendue(const Ray& ray) const override;
  NflFile to_nfl() const override { return encode_clusters(data_); }

  const ClusterData& data() const { return data_; }
  std::size_t clusters() const { return data_.clusters(); }
  /// Triangles of the mesh (elements with an area).
  std::size_t triangles() const;

  /// Ray of the point `u` of the unit cube.
  Ray sample(const std::array<double, 6>& u) const { return sample_clusters(view(), u); }
  /// What `sample` reads; points into the model.
  ClusterView view() const;

 private:
  void build_directions();
  /// Calls `see(piece, corners from the surface's centre, barycentric coordinates)` for the triangular pieces
  /// that the line along `radius_vector` from the surface's centre meets (several on their borders), until it
  /// is false.
  template <typename See>
  void pieces_along(const Vec3& radius_vector, const See& see) const;

  ClusterData data_;
  std::vector<Vec3> points_;
  std::vector<MeshPiece> pieces_;  // those of element e: element_begin_[e] .. element_begin_[e + 1] - 1
  std::vector<std::size_t> element_begin_;
  double total_ = 0.0;  // sum of all pieces' relative flux
  std::vector<float> piece_probability_;
  std::vector<std::uint32_t> piece_alias_;
  // Per leaf: alias table of its cluster, probability in it, and which of the distinct triangles it is.
  std::vector<float> leaf_probability_;
  std::vector<std::uint32_t> leaf_alias_;
  std::vector<double> leaf_share_;
  std::vector<std::uint32_t> leaf_triangle_;
  std::vector<SphericalTriangleSampler> triangle_;
};

}  // namespace lucerna
