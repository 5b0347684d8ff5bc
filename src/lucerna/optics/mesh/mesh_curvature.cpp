// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/mesh/mesh_curvature.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace lucerna {

namespace {

using CubicTerms = Eigen::Matrix<double, 10, 1>;  // the terms of a cubic

constexpr std::size_t kMaxCorners = std::size_t{1} << 16;
constexpr std::size_t kMinPoints = 16;
constexpr int kMostNeighbourRings = 6;
/// Reciprocal of the condition number of the normal equations below which a cubic is not taken.
constexpr double kMinCondition = 1e-9;

/// Which corners are joined by edges, and the normal at each (not of unit length).
struct Corners {
  std::vector<std::size_t> first;  // of each corner's neighbours
  std::vector<std::uint32_t> neighbours;
  std::vector<Vec3> normals;
};

Corners corners_of(const Mesh& mesh) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  Corners out;
  out.normals.resize(mesh.vertices_mm.size());
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.vertices_mm[t[0]];
    const Vec3 normal = cross(mesh.vertices_mm[t[1]] - a, mesh.vertices_mm[t[2]] - a);
    for (std::size_t k = 0; k < 3; ++k) {
      edges.emplace_back(t[k], t[(k + 1) % 3]);
      edges.emplace_back(t[(k + 1) % 3], t[k]);
      out.normals[t[k]] += normal;
    }
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  out.first.assign(mesh.vertices_mm.size() + 1, edges.size());
  for (std::size_t i = edges.size(); i-- > 0;) out.first[edges[i].first] = i;
  for (std::size_t i = mesh.vertices_mm.size(); i-- > 0;)
    out.first[i] = std::min(out.first[i], out.first[i + 1]);
  for (const auto& [from, to] : edges) out.neighbours.push_back(to);
  return out;
}

/// Takes in those that are joined with the ones from `begin` on. Returns where the new ones begin.
std::size_t add_ring(const Corners& corners, std::vector<std::uint32_t>& points, std::size_t begin) {
  const std::size_t end = points.size();
  for (std::size_t i = begin; i < end; ++i) {
    for (std::size_t k = corners.first[points[i]]; k < corners.first[points[i] + 1]; ++k) {
      if (std::ranges::find(points, corners.neighbours[k]) == points.end())
        points.push_back(corners.neighbours[k]);
    }
  }
  return end;
}

/// Of the cubic through the points, at the first of them; empty where they do not determine one.
std::optional<double> curvature_at(const Mesh& mesh, const Vec3& normal,
                                   const std::vector<std::uint32_t>& points) {
  const Vec3& middle = mesh.vertices_mm[points.front()];
  double size = 0.0;
  for (const std::uint32_t p : points) size = std::max(size, length(mesh.vertices_mm[p] - middle));
  const Frame frame = Frame::from_z(Direction::from(normal));
  Eigen::Matrix<double, 10, 10> normal_matrix = Eigen::Matrix<double, 10, 10>::Zero();
  CubicTerms right = CubicTerms::Zero();
  for (const std::uint32_t p : points) {
    const Vec3 d = (mesh.vertices_mm[p] - middle) / size;
    const double x = dot(d, frame.ex()), y = dot(d, frame.ey());
    CubicTerms terms;
    terms << 1.0, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
    normal_matrix += terms * terms.transpose();
    right += dot(d, frame.ez()) * terms;
  }
  const Eigen::LDLT<Eigen::Matrix<double, 10, 10>> solver(normal_matrix);
  if (!(solver.rcond() > kMinCondition)) return {};
  const CubicTerms c = solver.solve(right);
  // The fundamental forms: curvatures are the eigenvalues of the second by the first.
  Eigen::Matrix2d first, second;
  first << 1.0 + c[1] * c[1], c[1] * c[2], c[1] * c[2], 1.0 + c[2] * c[2];
  second << 2.0 * c[3], c[4], c[4], 2.0 * c[5];
  second /= size * std::sqrt(1.0 + c[1] * c[1] + c[2] * c[2]);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> both(second, first, Eigen::EigenvaluesOnly);
  return both.eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace

double max_curvature_per_mm(const Mesh& mesh) {
  const Corners corners = corners_of(mesh);
  const std::size_t step = mesh.vertices_mm.size() / kMaxCorners + 1;
  double max = 0.0;
  std::vector<std::uint32_t> points;
  for (std::size_t i = 0; i < mesh.vertices_mm.size(); i += step) {
    if (!(length(corners.normals[i]) > 0.0)) continue;
    points.assign(1, static_cast<std::uint32_t>(i));
    std::optional<double> found;
    std::size_t begin = 0;
    for (int ring = 0; ring < kMostNeighbourRings && !found; ++ring) {
      begin = add_ring(corners, points, begin);
      if (points.size() >= kMinPoints) found = curvature_at(mesh, corners.normals[i], points);
    }
    max = std::max(max, found.value_or(0.0));
  }
  return max;
}

}  // namespace lucerna
