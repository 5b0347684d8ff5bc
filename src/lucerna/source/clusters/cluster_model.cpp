// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source/clusters/alias_table.h"

namespace lucerna {

namespace {

constexpr double kFlatEnough = 0.01;
/// Fine meshes are split less, so that no model takes more memory than this.
constexpr std::size_t kMaxPieces = std::size_t{1} << 22;

double triangle_area(const std::array<Vec3, 3>& p) { return 0.5 * length(cross(p[1] - p[0], p[2] - p[0])); }

std::array<double, 3> middle_of(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
}

void split(const MeshSurface& surface, const MeshPiece& piece, int splits, std::vector<MeshPiece>& out) {
  std::array<Vec3, 3> middle;
  std::array<std::array<double, 3>, 3> share;
  double deviation = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
    const Vec3 flat = 0.5 * (piece.corner_mm[a] + piece.corner_mm[b]);
    middle[k] = surface.put_back(flat);
    share[k] = middle_of(piece.share[a], piece.share[b]);
    const double edge = length(piece.corner_mm[a] - piece.corner_mm[b]);
    if (edge > 0.0) deviation = std::max(deviation, length(middle[k] - flat) / edge);
  }
  if (splits == 0 || deviation <= kFlatEnough) {
    out.push_back(piece);
    out.back().measure = triangle_area(piece.corner_mm);
    return;
  }
  const auto& p = piece.corner_mm;
  const auto& s = piece.share;
  const auto part = [&](const std::array<Vec3, 3>& corner,
                        const std::array<std::array<double, 3>, 3>& shares) {
    split(surface, {corner, shares, {}, piece.element, 0.0}, splits - 1, out);
  };
  part({p[0], middle[2], middle[1]}, {s[0], share[2], share[1]});
  part({middle[2], p[1], middle[0]}, {share[2], s[1], share[0]});
  part({middle[1], middle[0], p[2]}, {share[1], share[0], s[2]});
  part(middle, share);
}

}  // namespace

double relative_density_of(std::uint16_t level) {
  return level == 0 ? 0.0 : std::exp2((level - 65535) / 1024.0);
}

std::uint16_t density_level(double relative) {
  if (!(relative > 0.0)) return 0;
  return static_cast<std::uint16_t>(
      std::clamp(std::round(65535.0 + 1024.0 * std::log2(relative)), 1.0, 65535.0));
}

double relative_weight_of(std::uint8_t level) { return level == 0 ? 0.0 : std::exp2((level - 255) / 16.0); }

std::uint8_t weight_level(double relative) {
  if (!(relative > 0.0)) return 0;
  return static_cast<std::uint8_t>(std::clamp(std::round(255.0 + 16.0 * std::log2(relative)), 1.0, 255.0));
}

Vec3 ClusterData::point_mm(std::size_t v) const {
  const auto& p = place[v];
  return surface.put_back(
      {low_mm.x + step_mm.x * p[0], low_mm.y + step_mm.y * p[1], low_mm.z + step_mm.z * p[2]});
}

double ClusterData::relative_density(std::size_t v) const { return relative_density_of(density[v]); }

std::vector<MeshPiece> mesh_pieces(const ClusterData& data) {
  std::vector<Vec3> points(data.clusters());
  for (std::size_t v = 0; v < points.size(); ++v) points[v] = data.point_mm(v);
  int splits = kMeshSplits;
  while (splits > 0 && data.elements.size() << (2 * splits) > kMaxPieces) --splits;
  std::vector<MeshPiece> pieces;
  for (std::uint32_t e = 0; e < data.elements.size(); ++e) {
    MeshPiece piece;
    piece.element = e;
    piece.share = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
    for (std::size_t k = 0; k < 3; ++k) piece.corner_mm[k] = points[data.elements[e][k]];
    const int shape = mesh_corners(data.elements[e]);
    if (shape == 3) {
      split(data.surface, piece, splits, pieces);
    } else {
      piece.measure = shape == 2 ? length(piece.corner_mm[1] - piece.corner_mm[0]) : 1.0;
      pieces.push_back(piece);
    }
  }
  for (MeshPiece& piece : pieces) {
    const Triangle& element = data.elements[piece.element];
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c)
        piece.density[k] += piece.share[k][c] * data.relative_density(element[c]);
    }
  }
  return pieces;
}

ClusterModel::ClusterModel(ClusterData data) : data_(std::move(data)), pieces_(mesh_pieces(data_)) {
  points_.resize(data_.clusters());
  for (std::size_t v = 0; v < points_.size(); ++v) points_[v] = data_.point_mm(v);
  element_begin_.assign(data_.elements.size() + 1, 0);
  for (const MeshPiece& piece : pieces_) ++element_begin_[piece.element + 1];
  std::partial_sum(element_begin_.begin(), element_begin_.end(), element_begin_.begin());
  // One item per corner of a piece: the part of its density that is that corner's.
  std::vector<double> weights(3 * pieces_.size(), 0.0);
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const int shape = mesh_corners(data_.elements[pieces_[i].element]);
    for (std::size_t k = 0; k < static_cast<std::size_t>(shape); ++k) {
      weights[3 * i + k] = pieces_[i].measure * pieces_[i].density[k] / shape;
      total_ += weights[3 * i + k];
    }
  }
  piece_probability_.resize(weights.size());
  piece_alias_.resize(weights.size());
  build_alias(weights, piece_probability_, piece_alias_);
  build_directions();
}

void ClusterModel::build_directions() {
  std::map<std::pair<std::uint32_t, std::uint8_t>, std::uint32_t> distinct;
  leaf_triangle_.resize(data_.leaf.size());
  for (std::size_t i = 0; i < data_.leaf.size(); ++i) {
    const ClusterLeaf& leaf = data_.leaf[i];
    const auto [place, added] =
        distinct.try_emplace({leaf.code, leaf.depth}, static_cast<std::uint32_t>(triangle_.size()));
    if (added) triangle_.emplace_back(direction_triangle(leaf.code, leaf.depth));
    leaf_triangle_[i] = place->second;
  }
  leaf_probability_.resize(data_.leaf.size());
  leaf_alias_.resize(data_.leaf.size());
  leaf_share_.resize(data_.leaf.size());
  for (std::size_t v = 0; v < data_.clusters(); ++v) {
    const std::size_t first = data_.leaf_begin[v], n = data_.leaf_begin[v + 1] - first;
    std::vector<double> weights(n);
    double sum = 0.0;
    for (std::size_t i = 0; i < n; ++i) sum += weights[i] = relative_weight_of(data_.leaf[first + i].level);
    for (std::size_t i = 0; i < n; ++i) leaf_share_[first + i] = weights[i] / sum;
    build_alias(weights, std::span(leaf_probability_).subspan(first, n),
                std::span(leaf_alias_).subspan(first, n));
  }
}

std::unique_ptr<ClusterModel> ClusterModel::from_nfl(const NflFile& file, std::string_view name) {
  return std::make_unique<ClusterModel>(decode_clusters(file, name));
}

std::size_t ClusterModel::triangles() const {
  return static_cast<std::size_t>(std::count_if(data_.elements.begin(), data_.elements.end(),
                                                [](const Triangle& e) { return mesh_corners(e) == 3; }));
}

ClusterView ClusterModel::view() const {
  return {pieces_.data(),        data_.elements.data(),   points_.data(),           piece_probability_.data(),
          piece_alias_.data(),   data_.leaf_begin.data(), leaf_probability_.data(), leaf_alias_.data(),
          leaf_triangle_.data(), triangle_.data(),        pieces_.size(),           data_.elements.size(),
          points_.size(),        data_.leaf.size(),       triangle_.size(),         data_.surface};
}

void ClusterModel::emit(const Sequence& sequence, std::uint64_t first, RayBlock& out) const {
  out.resize(out.size(), 0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out.set(i, sample(sequence.point<6>(first + i)));
    out.weight[i] = 1.0f;
  }
}

namespace {

/// Barycentric coordinates of where the line from the origin along `radius_vector` hits the triangle; nothing
/// if it misses it by more than the share `tolerance` of its size.
std::optional<std::array<double, 3>> cast(const std::array<Vec3, 3>& corner, const Vec3& radius_vector,
                                          double tolerance) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c) { return dot(a, cross(b, c)); };
  const double whole = volume(corner[0], corner[1], corner[2]);
  std::array<double, 3> part{volume(radius_vector, corner[1], corner[2]),
                             volume(corner[0], radius_vector, corner[2]),
                             volume(corner[0], corner[1], radius_vector)};
  double sum = 0.0;
  for (double& x : part) sum += x = whole < 0.0 ? -x : x;
  if (!(sum > 0.0)) return std::nullopt;
  for (double& x : part) {
    x /= sum;
    if (!(x >= -tolerance)) return std::nullopt;
  }
  return part;
}

/// Elements are looked through before their pieces; a border that rounding moved is still theirs.
constexpr double kBorderTolerance = 1e-9;

/// Starts are float32 and representatives rounded: this far off the surface is still on it, in shares of the
/// arm.
constexpr double kOnSurface = 1e-5;

}  // namespace

// The pieces of an element tile its cone: their corners are put back along lines from the same centre.
template <typename See>
void ClusterModel::pieces_along(const Vec3& radius_vector, const See& see) const {
  const auto from_centre = [&](std::array<Vec3, 3> corner) {
    for (Vec3& c : corner) c = c - data_.surface.centre_mm;
    return corner;
  };
  for (std::size_t e = 0; e < data_.elements.size(); ++e) {
    const Triangle& v = data_.elements[e];
    if (mesh_corners(v) != 3) continue;
    if (!cast(from_centre({points_[v[0]], points_[v[1]], points_[v[2]]}), radius_vector, kBorderTolerance))
      continue;
    for (std::size_t i = element_begin_[e]; i < element_begin_[e + 1]; ++i) {
      const std::array<Vec3, 3> corner = from_centre(pieces_[i].corner_mm);
      const auto part = cast(corner, radius_vector, 0.0);
      if (part && !see(pieces_[i], corner, *part)) return;
    }
  }
}

double ClusterModel::pdf_area(const Vec3& point_mm) const {
  if (!data_.surface.has_area()) {
    throw InputError(
        fmt::format("pdf_area does not exist: all rays start on one {}", to_string(data_.surface.kind)));
  }
  const Vec3 radius_vector = point_mm - data_.surface.centre_mm;
  const bool open = data_.surface.kind == MeshSurfaceKind::hull;
  if (!open && length(data_.surface.put_back(point_mm) - point_mm) > kOnSurface * length(radius_vector))
    return 0.0;
  double pdf = 0.0;
  pieces_along(radius_vector, [&](const MeshPiece& piece, const std::array<Vec3, 3>& corner,
                                  const std::array<double, 3>& part) {
    Vec3 q;
    double density = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      q += part[k] * corner[k];
      density += part[k] * piece.density[k];
    }
    if (open && length(q - radius_vector) > kOnSurface * length(radius_vector)) return true;
    double stretch = 1.0;  // flat area per surface area, along the line from the centre
    if (data_.surface.kind > MeshSurfaceKind::plane && !open) {
      const Vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
      const double far = length(radius_vector), near = length(q);
      const double surface_cosine = std::abs(dot(data_.surface.normal(point_mm), radius_vector)) / far;
      const double flat_cosine = std::abs(dot(normal, q)) / (length(normal) * near);
      stretch = surface_cosine / (far * far) * (near * near) / flat_cosine;
    }
    pdf = std::max(pdf, density / total_ * stretch);  // on a border two pieces agree
    return true;
  });
  return pdf;
}

double ClusterModel::pdf_solid_angle(const Vec3& point_mm, const Direction& direction) const {
  // The element that holds the point; where none does, the one whose corner is nearest.
  std::uint32_t v = 0;
  bool found = false;
  const Vec3 radius_vector = point_mm - data_.surface.centre_mm;
  pieces_along(radius_vector, [&](const MeshPiece& piece, const auto&, const auto&) {
    v = nearest_cluster(data_.elements[piece.element], points_.data(), point_mm);
    found = true;
    return false;
  });
  for (std::uint32_t w = 0; !found && w < points_.size(); ++w) {
    if (length(points_[w] - point_mm) < length(points_[v] - point_mm)) v = w;
  }
  const auto begin = data_.leaf.begin() + data_.leaf_begin[v],
             end = data_.leaf.begin() + data_.leaf_begin[v + 1];
  const auto after = std::upper_bound(begin, end, direction_code(direction),
                                      [](std::uint32_t code, const ClusterLeaf& l) { return code < l.code; });
  const auto leaf = static_cast<std::size_t>(after - 1 - data_.leaf.begin());
  return leaf_share_[leaf] / triangle_[leaf_triangle_[leaf]].solid_angle_sr();
}

double ClusterModel::pdf_etendue(const Ray& ray) const {
  const double area = pdf_area(ray.origin_mm);
  if (area == 0.0) return 0.0;
  const double solid_angle = pdf_solid_angle(ray.origin_mm, ray.direction);
  if (solid_angle == 0.0) return 0.0;
  const double cosine = std::abs(dot(data_.surface.normal(ray.origin_mm), ray.direction));
  return area * solid_angle / cosine;
}

}  // namespace lucerna
