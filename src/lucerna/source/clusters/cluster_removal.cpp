// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_removal.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/core/parallel/parallel_sort.h"
#include "lucerna/source/clusters/cluster_directions.h"

namespace lucerna {

namespace {

constexpr std::size_t kRemovalBlock = std::size_t{1} << 16;
/// Expected rays from which an empty triangle is an opening.
constexpr double kHoleRays = 12.0;

/// Points joined by the edges of triangles that are no holes; `rim` where some triangle round a point is
/// missing.
struct Neighbourhood {
  std::vector<std::uint32_t> begin, neighbour;
  std::vector<bool> rim;
};

Neighbourhood neighbourhood(const Triangulation& mesh, const std::vector<bool>& hole) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  Neighbourhood result;
  result.rim.assign(mesh.points, false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
      if (mesh.is_helper(a) || mesh.is_helper(b)) continue;
      edges.emplace_back(a, b);
      edges.emplace_back(b, a);
      if (hole[t] || mesh.neighbours[t][k] == Triangulation::kNoTriangle)
        result.rim[a] = result.rim[b] = true;
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  result.begin.assign(mesh.points + 1, 0);
  for (const auto& edge : edges) ++result.begin[edge.first + 1];
  std::partial_sum(result.begin.begin(), result.begin.end(), result.begin.begin());
  for (const auto& edge : edges) result.neighbour.push_back(edge.second);
  return result;
}

/// The density at point v as a linear function fitted to its neighbours in the tangent plane; >= 0.
double interpolated_density(const Triangulation& mesh, const MeshDensity& d, const Neighbourhood& near,
                            std::uint32_t v) {
  const Frame tangent = Frame::from_z(Direction::from(mesh.arms[v]));
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double mean = 0.0, weights = 0.0, scale = 0.0;
  for (std::uint32_t i = near.begin[v]; i < near.begin[v + 1]; ++i) {
    scale = std::max(scale, length(mesh.arms[near.neighbour[i]] - mesh.arms[v]));
  }
  for (std::uint32_t i = near.begin[v]; i < near.begin[v + 1]; ++i) {
    const std::uint32_t u = near.neighbour[i];
    const Vec3 e = (mesh.arms[u] - mesh.arms[v]) / scale;
    const double w = 1.0 / std::max(1e-6, dot(e, e));
    const Eigen::Vector3d row(1.0, dot(e, tangent.ex()), dot(e, tangent.ey()));
    matrix += w * row * row.transpose();
    right += w * d.density[u] * row;
    mean += w * d.density[u];
    weights += w;
  }
  if (weights == 0.0) return 0.0;
  // Neighbours on one line fix no gradient across it: a little of the flat answer makes the system regular.
  matrix(1, 1) += 1e-6 * weights;
  matrix(2, 2) += 1e-6 * weights;
  const double linear = (matrix.ldlt().solve(right))[0];
  const double low = 0.0, high = 4.0 * mean / weights;
  return std::clamp(std::isfinite(linear) ? linear : mean / weights, low, high);
}

/// Nats lost when `found` counts are taken for `predicted`, less the 1/2 that noise alone costs.
double poisson_loss(double found, double predicted) {
  const double min = 0.5;  // half a ray: keeps the logarithm finite where nothing is expected
  const double p = std::max(predicted, min), f = std::max(found, 0.0);
  return std::max(0.0, (f > 0.0 ? f * std::log(f / p) : 0.0) - f + p - 0.5);
}

/// Weight in the ear that the rim loses with v: between v and the two rim neighbours that it is joined to.
double ear_weight(const Triangulation& mesh, const MeshDensity& d, const Neighbourhood& near,
                  std::uint32_t v) {
  std::vector<std::uint32_t> ends;
  for (std::uint32_t i = near.begin[v]; i < near.begin[v + 1]; ++i) {
    if (near.rim[near.neighbour[i]]) ends.push_back(near.neighbour[i]);
  }
  // The widest ear: rim neighbours across the surface make it no smaller.
  double widest = 0.0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t k = i + 1; k < ends.size(); ++k) {
      const Vec3 a = mesh.arms[ends[i]] - mesh.arms[v], b = mesh.arms[ends[k]] - mesh.arms[v];
      if (dot(a, b) < 0.0) widest = std::max(widest, 0.5 * length(cross(a, b)));
    }
  }
  return d.density[v] * widest;
}

std::vector<DirectionSample> merged(std::span<const DirectionSample> a, std::span<const DirectionSample> b) {
  std::vector<DirectionSample> both(a.size() + b.size());
  std::merge(a.begin(), a.end(), b.begin(), b.end(), both.begin(),
             [](const DirectionSample& x, const DirectionSample& y) { return x.code < y.code; });
  return both;
}

/// One round's view of the clusters that are left.
struct Round {
  Triangulation mesh;
  MeshDensity density;
  Neighbourhood near;
  std::vector<DirectionSample> samples;  // cluster after cluster, codes ascending
  std::vector<std::uint32_t> begin;      // of each cluster's samples
  std::span<const DirectionSample> of(std::uint32_t v) const {
    return std::span(samples).subspan(begin[v], begin[v + 1] - begin[v]);
  }
};

struct Splat {
  std::vector<double> shares, weight;
};

/// Gives every ray to the nearest corner of its triangle (`cluster` becomes an index of the mesh's points)
/// and measures.
Round measure(const MeshSurface& surface, const std::vector<Vec3>& points, std::vector<ClusterRay>& rays,
              const std::vector<std::uint32_t>& start) {
  Round round;
  round.mesh = triangulate(surface, points);
  const auto parts =
      parallel_map_blocks<Splat>(rays.size(), 4 * kRemovalBlock, [&](std::size_t first, std::size_t last) {
        Splat s{std::vector<double>(round.mesh.arms.size(), 0.0),
                std::vector<double>(round.mesh.triangles.size(), 0.0)};
        for (std::size_t i = first; i < last; ++i) {
          const Vec3 radius_vector = rays[i].radius_vector();
          const MeshPlace place =
              locate(round.mesh, radius_vector, round.mesh.triangle_of[start[rays[i].cluster]]);
          const double w = static_cast<double>(rays[i].weight);
          if (place.triangle != Triangulation::kNoTriangle) {
            for (std::size_t k = 0; k < 3; ++k)
              s.shares[round.mesh.triangles[place.triangle][k]] += w * place.barycentric[k];
            s.weight[place.triangle] += w;
          }
          rays[i].cluster = nearest_corner(round.mesh, place.triangle, radius_vector);
        }
        return s;
      });
  Splat all{std::vector<double>(round.mesh.arms.size(), 0.0),
            std::vector<double>(round.mesh.triangles.size(), 0.0)};
  for (const Splat& s : parts) {
    for (std::size_t k = 0; k < all.shares.size(); ++k) all.shares[k] += s.shares[k];
    for (std::size_t k = 0; k < all.weight.size(); ++k) all.weight[k] += s.weight[k];
  }
  round.density = mesh_density(round.mesh, triangle_areas(surface, round.mesh), std::move(all.shares),
                               std::move(all.weight));
  round.near = neighbourhood(round.mesh, round.density.hole);
  parallel_sort(rays.begin(), rays.end(), [](const ClusterRay& a, const ClusterRay& b) {
    return std::tie(a.cluster, a.code, a.arm_x, a.arm_y, a.arm_z, a.weight) <
           std::tie(b.cluster, b.code, b.arm_x, b.arm_y, b.arm_z, b.weight);
  });
  round.begin.assign(points.size() + 1, 0);
  round.samples.resize(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ++round.begin[rays[i].cluster + 1];
    round.samples[i] = {rays[i].code, rays[i].weight};
  }
  std::partial_sum(round.begin.begin(), round.begin.end(), round.begin.begin());
  return round;
}

/// What the removal of each cluster costs, and the neighbour that would take its rays.
struct Cost {
  double nats = std::numeric_limits<double>::infinity();
  std::uint32_t cluster = 0, heir = 0;
};

std::vector<Cost> costs_of(const Round& round, const RemovalOptions& options) {
  const std::size_t n = round.mesh.points;
  std::vector<double> own(n);
  parallel_blocks(n, 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t v = first; v < last; ++v) {
      own[v] = direction_gain_nats(round.of(static_cast<std::uint32_t>(v)), options.penalty_nats);
    }
  });
  std::vector<Cost> costs(n);
  parallel_blocks(n, 64, [&](std::size_t first, std::size_t last) {
    for (auto v = static_cast<std::uint32_t>(first); v < last; ++v) {
      costs[v].cluster = v;
      double nearest = std::numeric_limits<double>::infinity();
      for (std::uint32_t i = round.near.begin[v]; i < round.near.begin[v + 1]; ++i) {
        const std::uint32_t u = round.near.neighbour[i];
        const Vec3 e = round.mesh.arms[u] - round.mesh.arms[v];
        if (dot(e, e) < nearest) {
          nearest = dot(e, e);
          costs[v].heir = u;
        }
      }
      if (!std::isfinite(nearest)) continue;
      const double area = round.density.area[v];
      double nats = poisson_loss(round.density.density[v] * area,
                                 area * interpolated_density(round.mesh, round.density, round.near, v));
      if (round.near.rim[v]) nats += ear_weight(round.mesh, round.density, round.near, v);
      // Two trees of octants become one: that saves nothing that is counted.
      const double price = options.cluster_price * options.penalty_nats;
      if (nats < price) {
        const auto both = merged(round.of(v), round.of(costs[v].heir));
        nats += std::max(0.0, own[v] + own[costs[v].heir] - direction_gain_nats(both, options.penalty_nats));
      }
      costs[v].nats = nats;
    }
  });
  return costs;
}

/// The cheapest clusters below the price, no two of them neighbours.
std::vector<bool> marked(const Round& round, std::vector<Cost> costs, const RemovalOptions& options) {
  const double price = options.cluster_price * options.penalty_nats;
  std::erase_if(costs, [&](const Cost& c) { return !(c.nats < price); });
  std::sort(costs.begin(), costs.end(), [](const Cost& a, const Cost& b) {
    return std::tie(a.nats, a.cluster) < std::tie(b.nats, b.cluster);
  });
  std::vector<bool> gone(round.mesh.points, false), stays(round.mesh.points, false);
  std::size_t left = round.mesh.points;
  for (const Cost& c : costs) {
    if (stays[c.cluster] || left <= options.min_clusters) continue;
    gone[c.cluster] = true;
    --left;
    for (std::uint32_t i = round.near.begin[c.cluster]; i < round.near.begin[c.cluster + 1]; ++i) {
      stays[round.near.neighbour[i]] = true;
    }
  }
  return gone;
}

}  // namespace

std::uint32_t nearest_corner(const Triangulation& mesh, std::uint32_t t, const Vec3& radius_vector) {
  double nearest = std::numeric_limits<double>::infinity();
  std::uint32_t best = 0;
  const auto consider = [&](std::uint32_t v) {
    const Vec3 e = mesh.arms[v] - radius_vector;
    if (dot(e, e) < nearest) {
      nearest = dot(e, e);
      best = v;
    }
  };
  if (t != Triangulation::kNoTriangle) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (!mesh.is_helper(v)) consider(v);
    }
  }
  if (std::isfinite(nearest)) return best;
  for (std::uint32_t v = 0; v < mesh.points; ++v) consider(v);
  return best;
}

std::vector<double> triangle_areas(const MeshSurface& surface, const Triangulation& mesh) {
  std::vector<double> areas(mesh.triangles.size());
  const auto area = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return 0.5 * length(cross(b - a, c - a));
  };
  parallel_blocks(areas.size(), 1024, [&](std::size_t first, std::size_t last) {
    for (std::size_t t = first; t < last; ++t) {
      const Vec3 a = mesh.arms[mesh.triangles[t][0]], b = mesh.arms[mesh.triangles[t][1]],
                 c = mesh.arms[mesh.triangles[t][2]];
      const auto middle = [&](const Vec3& p, const Vec3& q) {
        return surface.put_back(surface.centre_mm + 0.5 * (p + q)) - surface.centre_mm;
      };
      const Vec3 ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      areas[t] = area(a, ab, ca) + area(ab, b, bc) + area(ca, bc, c) + area(ab, bc, ca);
    }
  });
  return areas;
}

MeshDensity mesh_density(const Triangulation& mesh, const std::vector<double>& areas,
                         std::vector<double> shares, std::vector<double> weight) {
  MeshDensity d;
  d.weight = std::move(weight);
  d.hole.assign(mesh.triangles.size(), false);
  const auto spread = [&] {
    d.area.assign(mesh.arms.size(), 0.0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (d.hole[t]) continue;
      for (const std::uint32_t v : mesh.triangles[t]) d.area[v] += areas[t] / 3.0;
    }
    d.density.assign(mesh.arms.size(), 0.0);
    for (std::size_t v = 0; v < mesh.arms.size(); ++v) {
      if (d.area[v] > 0.0) d.density[v] = shares[v] / d.area[v];
    }
  };
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) d.hole[t] = mesh.has_helper(mesh.triangles[t]);
  spread();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (d.hole[t] || d.weight[t] > 0.0) continue;
    double expected = 0.0;
    for (const std::uint32_t v : mesh.triangles[t]) expected += d.density[v] * areas[t] / 3.0;
    if (expected >= kHoleRays) d.hole[t] = true;
  }
  spread();
  return d;
}

RemovalResult remove_clusters(const MeshSurface& surface, const std::vector<Vec3>& points,
                              std::vector<ClusterRay>& rays, std::vector<std::uint32_t> retained,
                              const RemovalOptions& options, Progress& progress) {
  RemovalResult result;
  // Where each ray's search starts, as an index of the points of the next mesh; rays start as numbers of all
  // points.
  std::vector<std::uint32_t> start(points.size(), 0);
  for (std::uint32_t i = 0; i < retained.size(); ++i) start[retained[i]] = i;
  for (;; ++result.rounds) {
    progress.step("compress: remove clusters", result.rounds, 0);
    if (retained.size() <= options.min_clusters) break;
    std::vector<Vec3> left;
    for (const std::uint32_t v : retained) left.push_back(points[v]);
    const Round round = measure(surface, left, rays, start);
    const std::vector<Cost> costs = costs_of(round, options);
    const std::vector<bool> gone = marked(round, costs, options);
    start.assign(retained.size(), 0);
    std::vector<std::uint32_t> next;
    for (std::uint32_t v = 0; v < retained.size(); ++v) {
      if (gone[v]) continue;
      start[v] = static_cast<std::uint32_t>(next.size());
      next.push_back(retained[v]);
    }
    for (std::uint32_t v = 0; v < retained.size(); ++v) {
      if (gone[v]) start[v] = start[costs[v].heir];
    }
    const bool done = next.size() == retained.size();
    retained = std::move(next);
    if (done) break;
  }
  // Back to numbers of all points: where the rays ended up.
  if (result.rounds > 0 || retained.size() > options.min_clusters) {
    for (ClusterRay& ray : rays)
      ray.cluster = retained[std::min<std::size_t>(start[ray.cluster], retained.size() - 1)];
  }
  result.retained = std::move(retained);
  return result;
}

}  // namespace lucerna
