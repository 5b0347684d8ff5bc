// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_build.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/core/parallel/parallel_sort.h"
#include "lucerna/source/clusters/cluster_removal.h"
#include "lucerna/source/clusters/mesh_triangulation.h"

namespace lucerna {

namespace {

constexpr std::size_t kBuildBlock = std::size_t{1} << 16;
/// Points of a plane's rim that are representatives from the start: a disk loses 0.1 % of its radius between
/// them.
constexpr std::size_t kRimPoints = 64;
/// Rounds of the fit of densities; each corrects what the last left to about a third.
constexpr int kFitRounds = 20;

void slide_to(const MeshSurface& surface, RayBlock& rays) {
  const BoundingSurface sphere{SurfaceKind::sphere, surface.world_from_surface, surface.radius_mm, {}};
  parallel_blocks(rays.size(), kBuildBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Ray ray = rays.ray(i);
      if (const auto t = sphere.exit_distance_mm(ray)) rays.set(i, {ray.at(*t), ray.direction});
    }
  });
}

/// The rays in the order of the octree, without those of no flux; weights of mean 1.
RayBlock in_order(const RayBlock& rays, const std::vector<std::uint32_t>& order) {
  RayBlock sorted;
  sorted.resize(order.size(), 0);
  double sum = 0.0;
  for (const std::uint32_t i : order) sum += static_cast<double>(rays.weight[i]);
  const double scale = static_cast<double>(order.size()) / sum;
  parallel_blocks(order.size(), kBuildBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const std::uint32_t i = order[k];
      sorted.x_mm[k] = rays.x_mm[i];
      sorted.y_mm[k] = rays.y_mm[i];
      sorted.z_mm[k] = rays.z_mm[i];
      sorted.kx[k] = rays.kx[i];
      sorted.ky[k] = rays.ky[i];
      sorted.kz[k] = rays.kz[i];
      sorted.weight[k] = static_cast<float>(scale * static_cast<double>(rays.weight[i]));
    }
  });
  return sorted;
}

std::vector<Vec3> leaf_points(const RayBlock& rays, const std::vector<std::uint32_t>& begin) {
  std::vector<Vec3> points(begin.size() - 1);
  parallel_blocks(points.size(), 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t l = first; l < last; ++l) {
      Vec3 mean;
      double sum = 0.0, nearest = std::numeric_limits<double>::infinity();
      for (std::uint32_t i = begin[l]; i < begin[l + 1]; ++i) {
        const double w = static_cast<double>(rays.weight[i]);
        mean += w * rays.origin_mm(i);
        sum += w;
      }
      mean = mean / sum;
      for (std::uint32_t i = begin[l]; i < begin[l + 1]; ++i) {
        const Vec3 d = rays.origin_mm(i) - mean;
        if (dot(d, d) >= nearest) continue;
        nearest = dot(d, d);
        points[l] = rays.origin_mm(i);
      }
    }
  });
  return points;
}

/// The starts farthest out: in kRimPoints directions of a plane, at both ends of a line.
std::vector<Vec3> rim_points(const MeshSurface& surface, const RayBlock& rays) {
  const bool line = surface.kind == MeshSurfaceKind::line;
  const std::size_t n = line ? 2 : kRimPoints;
  std::vector<Vec3> directions(n), points(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double phi = 2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    const Frame& f = surface.world_from_surface;
    directions[k] = std::cos(phi) * f.ex() + (line ? 0.0 : std::sin(phi)) * f.ey();
  }
  using Extremes = std::vector<std::pair<double, std::size_t>>;
  const auto parts =
      parallel_map_blocks<Extremes>(rays.size(), 4 * kBuildBlock, [&](std::size_t first, std::size_t last) {
        Extremes best(n, {-std::numeric_limits<double>::infinity(), 0});
        for (std::size_t i = first; i < last; ++i) {
          const Vec3 p = rays.origin_mm(i) - surface.world_from_surface.origin_mm();
          for (std::size_t k = 0; k < n; ++k) {
            const double x = dot(p, directions[k]);
            if (x > best[k].first) best[k] = {x, i};
          }
        }
        return best;
      });
  for (std::size_t k = 0; k < n; ++k) {
    std::pair<double, std::size_t> best = parts.front()[k];
    for (const Extremes& part : parts) best = part[k].first > best.first ? part[k] : best;
    points[k] = rays.origin_mm(best.second);
  }
  return points;
}

/// Puts the points on a grid of 2^16 steps an axis; one cluster for each place. Returns the cluster of each
/// point.
std::vector<std::uint32_t> to_grid(const std::vector<Vec3>& points, PreparedRays& p) {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const Vec3& x : points) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  p.low_mm = low;
  p.step_mm = (high - low) / 65535.0;
  ClusterData grid;
  grid.surface = p.surface;
  grid.low_mm = p.low_mm;
  grid.step_mm = p.step_mm;
  std::map<std::array<std::uint16_t, 3>, std::uint32_t> seen;
  std::vector<std::uint32_t> cluster;
  for (const Vec3& x : points) {
    const auto cell = [](double offset, double step) {
      return static_cast<std::uint16_t>(step > 0.0 ? std::clamp(std::round(offset / step), 0.0, 65535.0)
                                                   : 0.0);
    };
    const std::array<std::uint16_t, 3> place{cell(x.x - low.x, p.step_mm.x), cell(x.y - low.y, p.step_mm.y),
                                             cell(x.z - low.z, p.step_mm.z)};
    const auto [entry, added] = seen.try_emplace(place, static_cast<std::uint32_t>(p.place.size()));
    if (added) {
      p.place.push_back(place);
      grid.place.push_back(place);
      p.point_mm.push_back(grid.point_mm(p.place.size() - 1));
    }
    cluster.push_back(entry->second);
  }
  return cluster;
}

}  // namespace

PreparedRays prepare_rays(const RayBlock& rays, std::size_t min_rays_per_leaf, std::size_t max_leaves) {
  PreparedRays p;
  if (rays.empty()) throw InputError("no rays to compress");
  const FoundSurface found = find_mesh_surface(rays);
  p.surface = found.surface;
  std::optional<RayBlock> moved;
  if (found.slide) {
    moved = rays;
    slide_to(p.surface, *moved);
  }
  const RayBlock& used = moved ? *moved : rays;
  PositionOctree octree = build_position_octree(used, min_rays_per_leaf, max_leaves);
  p.rays = in_order(used, octree.order);
  p.leaf_begin = std::move(octree.begin);
  p.code.resize(p.rays.size());
  parallel_blocks(p.rays.size(), kBuildBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) p.code[i] = direction_code(p.rays.direction(i));
  });
  std::vector<Vec3> points = leaf_points(p.rays, p.leaf_begin);
  if (p.surface.kind == MeshSurfaceKind::plane || p.surface.kind == MeshSurfaceKind::line) {
    for (const Vec3& x : rim_points(p.surface, p.rays)) points.push_back(x);
  }
  p.leaf_cluster = to_grid(points, p);
  p.leaf_cluster.resize(p.leaf_begin.size() - 1);
  return p;
}

namespace {

/// A ray's cluster with its direction, to be sorted.
struct Member {
  std::uint32_t cluster, code;
  float weight;
};

/// Rays per element of the mesh, and where each goes.
struct Shares {
  std::vector<double> point, element;
};

Shares sum(const std::vector<Shares>& parts, std::size_t points, std::size_t elements) {
  Shares all{std::vector<double>(points, 0.0), std::vector<double>(elements, 0.0)};
  for (const Shares& part : parts) {
    for (std::size_t i = 0; i < points; ++i) all.point[i] += part.point[i];
    for (std::size_t i = 0; i < elements; ++i) all.element[i] += part.element[i];
  }
  return all;
}

/// Triangles, densities and members for surfaces with an area.
std::vector<double> assign_to_triangles(const PreparedRays& p, const std::vector<Vec3>& points,
                                        ClusterData& data, std::vector<Member>& members) {
  const Triangulation mesh = triangulate(p.surface, points);
  const auto parts =
      parallel_map_blocks<Shares>(p.rays.size(), 4 * kBuildBlock, [&](std::size_t first, std::size_t last) {
        Shares s{std::vector<double>(mesh.arms.size(), 0.0), std::vector<double>(mesh.triangles.size(), 0.0)};
        std::uint32_t hint = 0;  // neighbours in the octree are neighbours in the mesh
        for (std::size_t i = first; i < last; ++i) {
          const Vec3 radius_vector = p.rays.origin_mm(i) - p.surface.centre_mm;
          const MeshPlace place = locate(mesh, radius_vector, hint);
          const double w = static_cast<double>(p.rays.weight[i]);
          if (place.triangle != Triangulation::kNoTriangle) {
            hint = place.triangle;
            for (std::size_t k = 0; k < 3; ++k) s.point[mesh.triangles[hint][k]] += w * place.barycentric[k];
            s.element[hint] += w;
          }
          members[i] = {nearest_corner(mesh, place.triangle, radius_vector), p.code[i], p.rays.weight[i]};
        }
        return s;
      });
  Shares all = sum(parts, mesh.arms.size(), mesh.triangles.size());
  const MeshDensity density =
      mesh_density(mesh, triangle_areas(p.surface, mesh), std::move(all.point), std::move(all.element));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!density.hole[t]) data.elements.push_back(mesh.triangles[t]);
  }
  return {density.density.begin(), density.density.begin() + static_cast<std::ptrdiff_t>(points.size())};
}

/// Segments between neighbours on a line; a segment without rays where 12 are expected is a gap.
std::vector<double> assign_to_segments(const PreparedRays& p, const std::vector<Vec3>& points,
                                       ClusterData& data, std::vector<Member>& members) {
  const Vec3 axis = p.surface.world_from_surface.ex();
  std::vector<std::pair<double, std::uint32_t>> order;
  for (std::uint32_t v = 0; v < points.size(); ++v) order.emplace_back(dot(points[v], axis), v);
  std::sort(order.begin(), order.end());
  std::vector<double> weight(order.size() + 1, 0.0), share(points.size(), 0.0), density(points.size(), 0.0);
  for (std::size_t i = 0; i < p.rays.size(); ++i) {
    const double x = dot(p.rays.origin_mm(i), axis), w = static_cast<double>(p.rays.weight[i]);
    const auto right = static_cast<std::size_t>(
        std::upper_bound(order.begin(), order.end(), std::pair(x, ~std::uint32_t{0})) - order.begin());
    const std::size_t b = std::clamp<std::size_t>(right, 1, order.size() - 1), a = b - 1;
    const double t = std::clamp((x - order[a].first) / (order[b].first - order[a].first), 0.0, 1.0);
    share[order[a].second] += w * (1.0 - t);
    share[order[b].second] += w * t;
    weight[a] += w;
    members[i] = {order[t < 0.5 ? a : b].second, p.code[i], p.rays.weight[i]};
  }
  for (std::size_t a = 0; a + 1 < order.size(); ++a) {
    const double expected = 0.25 * (share[order[a].second] + share[order[a + 1].second]);
    if (weight[a] == 0.0 && expected >= 12.0) continue;
    data.elements.push_back({order[a].second, order[a + 1].second, order[a + 1].second});
    const double half = 0.5 * (order[a + 1].first - order[a].first);
    density[order[a].second] += half;
    density[order[a + 1].second] += half;
  }
  for (std::size_t v = 0; v < points.size(); ++v) density[v] = density[v] > 0.0 ? share[v] / density[v] : 0.0;
  return density;
}

/// Clusters that no element carries shine as points.
void add_lone_points(ClusterData& data, const std::vector<double>& energy, std::vector<double>& density) {
  std::vector<bool> carried(data.clusters(), false);
  for (const Triangle& e : data.elements) carried[e[0]] = carried[e[1]] = carried[e[2]] = true;
  for (std::uint32_t v = 0; v < data.clusters(); ++v) {
    if (carried[v]) continue;
    data.elements.push_back({v, v, v});
    density[v] = energy[v];
  }
}

/// How much of each corner's density goes to which cluster, per element: `part[e][a][b]` of corner b to
/// corner a.
using Transfer = std::array<std::array<double, 3>, 3>;

std::vector<Transfer> transfers(const ClusterData& data) {
  std::vector<Vec3> points(data.clusters());
  for (std::size_t v = 0; v < points.size(); ++v) points[v] = data.point_mm(v);
  std::vector<Transfer> result(data.elements.size(), Transfer{});
  for (const MeshPiece& piece : mesh_pieces(data)) {
    const Triangle& e = data.elements[piece.element];
    Transfer& t = result[piece.element];
    if (e[1] == e[2]) {
      // A point keeps all; a segment's halves go to its ends: 3/8 and 1/8 of its length.
      t = e[0] == e[1] ? Transfer{{{1.0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}
                       : Transfer{{{0.375 * piece.measure, 0.125 * piece.measure, 0},
                                   {0.125 * piece.measure, 0.375 * piece.measure, 0},
                                   {0, 0, 0}}};
      continue;
    }
    // Midpoints of 16 equal parts of the piece.
    for (int i = 0; i < 4; ++i) {
      for (int k = 0; k < 7 - 2 * i; ++k) {
        const double u = (i + (k % 2 == 0 ? 1.0 : 2.0) / 3.0) / 4.0,
                     v = (k / 2 + (k % 2 == 0 ? 1.0 : 2.0) / 3.0) / 4.0;
        const std::array<double, 3> x{1.0 - u - v, u, v};
        Vec3 q;
        std::array<double, 3> share{};
        for (std::size_t c = 0; c < 3; ++c) {
          q += x[c] * piece.corner_mm[c];
          for (std::size_t b = 0; b < 3; ++b) share[b] += x[c] * piece.share[c][b];
        }
        q = data.surface.put_back(q);
        std::size_t nearest = 0;
        for (std::size_t a = 1; a < 3; ++a) {
          if (length(points[e[a]] - q) < length(points[e[nearest]] - q)) nearest = a;
        }
        for (std::size_t b = 0; b < 3; ++b) t[nearest][b] += share[b] * piece.measure / 16.0;
      }
    }
  }
  return result;
}

/// Scales the densities until each cluster sends out its own energy: sampling then gives back what was
/// counted, cluster by cluster. Multiplicative, so that they stay >= 0.
void fit_densities(ClusterData& data, const std::vector<double>& energy, std::vector<double> density) {
  add_lone_points(data, energy, density);
  const std::vector<Transfer> transfer = transfers(data);
  for (int round = 0; round < kFitRounds; ++round) {
    std::vector<double> sent(data.clusters(), 0.0);
    for (std::size_t i = 0; i < data.elements.size(); ++i) {
      for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b) {
          sent[data.elements[i][a]] += transfer[i][a][b] * density[data.elements[i][b]];
        }
      }
    }
    for (std::size_t v = 0; v < data.clusters(); ++v) {
      if (sent[v] > 0.0) density[v] *= energy[v] / sent[v];
    }
  }
  const double max = *std::max_element(density.begin(), density.end());
  data.density.resize(data.clusters());
  for (std::size_t v = 0; v < data.clusters(); ++v) data.density[v] = density_level(density[v] / max);
}

}  // namespace

AssignedRays assign_rays(const PreparedRays& p, std::vector<std::uint32_t> retained) {
  for (;;) {
    AssignedRays result;
    ClusterData& data = result.data;
    data.surface = p.surface;
    data.low_mm = p.low_mm;
    data.step_mm = p.step_mm;
    std::vector<Vec3> points;
    for (const std::uint32_t v : retained) {
      data.place.push_back(p.place[v]);
      points.push_back(p.point_mm[v]);
    }
    data.density.assign(points.size(), 0);  // fitted at the end
    std::vector<Member> members(p.rays.size());
    std::vector<double> density(points.size(), 1.0);
    if (p.surface.has_area()) {
      density = assign_to_triangles(p, points, data, members);
    } else if (points.size() > 1) {
      density = assign_to_segments(p, points, data, members);
    } else {
      for (std::size_t i = 0; i < members.size(); ++i) members[i] = {0, p.code[i], p.rays.weight[i]};
    }
    parallel_sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
      return std::tie(a.cluster, a.code, a.weight) < std::tie(b.cluster, b.code, b.weight);
    });
    result.begin.assign(points.size() + 1, 0);
    result.samples.resize(members.size());
    std::vector<double> energy(points.size(), 0.0);
    for (std::size_t i = 0; i < members.size(); ++i) {
      ++result.begin[members[i].cluster + 1];
      energy[members[i].cluster] += static_cast<double>(members[i].weight);
      result.samples[i] = {members[i].code, members[i].weight};
    }
    std::partial_sum(result.begin.begin(), result.begin.end(), result.begin.begin());
    // A cluster that got no rays has no directions: the mesh is made again without it.
    std::vector<std::uint32_t> alive;
    for (std::size_t v = 0; v < retained.size(); ++v) {
      if (energy[v] > 0.0) alive.push_back(retained[v]);
    }
    if (alive.size() == retained.size()) {
      fit_densities(data, energy, std::move(density));
      return result;
    }
    retained = std::move(alive);
  }
}

namespace {

/// The level nearest to a weight of at most 1 among those a multiple of `step` below the top; what shines
/// keeps a level > 0.
std::uint8_t stepped_level(double relative, int step) {
  const int below = 255 - weight_level(relative);
  if (below == 255) return 0;
  const int max = 254 / step * step;
  return static_cast<std::uint8_t>(255 - std::min(max, (below + step / 2) / step * step));
}

}  // namespace

void set_directions(const AssignedRays& assigned, double penalty_nats, int level_step, ClusterData& data) {
  const std::size_t n = data.clusters();
  const auto trees = parallel_map_blocks<std::vector<ClusterLeaf>>(n, 1, [&](std::size_t v, std::size_t) {
    const auto samples =
        std::span(assigned.samples).subspan(assigned.begin[v], assigned.begin[v + 1] - assigned.begin[v]);
    const std::vector<DirectionLeaf> leaves = direction_tree(samples, penalty_nats);
    double max = 0.0;
    for (const DirectionLeaf& leaf : leaves) max = std::max(max, leaf.weight);
    std::vector<ClusterLeaf> stored;
    for (const DirectionLeaf& leaf : leaves) {
      stored.push_back(
          {leaf.code, static_cast<std::uint8_t>(leaf.depth), stepped_level(leaf.weight / max, level_step)});
    }
    return stored;
  });
  data.leaf.clear();
  data.leaf_begin.assign(1, 0);
  for (const auto& tree : trees) {
    data.leaf.insert(data.leaf.end(), tree.begin(), tree.end());
    data.leaf_begin.push_back(static_cast<std::uint32_t>(data.leaf.size()));
  }
}

}  // namespace lucerna
