// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/mesh_triangulation.h"

#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/source/clusters/mesh_surface.h"

namespace lucerna {

namespace {

/// Qhull with its messages kept: the library never prints.
class Hull {
 public:
  explicit Hull(std::vector<double>& coordinates) {
    messages_ = ::open_memstream(&text_, &length_);
    LUCERNA_CHECK(messages_ != nullptr, "no memory stream");
    qh_zero(&state_, messages_);
    std::string command = "qhull QJ Pp";
    status_ = qh_new_qhull(&state_, 3, static_cast<int>(coordinates.size() / 3), coordinates.data(), False,
                           command.data(), messages_, messages_);
  }
  ~Hull() {
    qh_freeqhull(&state_, !qh_ALL);
    int left = 0, more = 0;
    qh_memfreeshort(&state_, &left, &more);
    std::fclose(messages_);
    std::free(text_);
  }
  Hull(const Hull&) = delete;
  Hull& operator=(const Hull&) = delete;

  /// Throws InputError with Qhull's own words where it found no hull.
  std::vector<Triangle> triangles() {
    if (status_ != 0) {
      std::fflush(messages_);
      const std::string words(text_, length_);
      throw InputError("no convex hull: " + words.substr(0, words.find('\n')));
    }
    std::vector<Triangle> result;
    qhT* qh = &state_;
    for (facetT* facet = qh->facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next) {
      Triangle t{};
      std::size_t k = 0;
      for (void** p = &facet->vertices->e[0].p; *p != nullptr && k < 3; ++p) {
        t[k++] = static_cast<std::uint32_t>(qh_pointid(qh, static_cast<vertexT*>(*p)->point));
      }
      result.push_back(t);
    }
    return result;
  }

 private:
  qhT state_{};
  FILE* messages_ = nullptr;
  char* text_ = nullptr;
  std::size_t length_ = 0;
  int status_ = 0;
};

double orientation(const Vec3& a, const Vec3& b, const Vec3& c) { return dot(a, cross(b, c)); }

/// Directions at which a closed mesh gets a helper when no point lies within 60 degrees: the axes and the
/// octants' centres.
std::vector<Vec3> helper_directions() {
  std::vector<Vec3> d{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const double s = 1.0 / std::sqrt(3.0);
  for (const double x : {-s, s}) {
    for (const double y : {-s, s}) {
      for (const double z : {-s, s}) d.push_back({x, y, z});
    }
  }
  return d;
}
constexpr double kHelperCosine = 0.5;
/// Twice a triangle's area over its longest edge squared, below which the joggle alone can have made it.
constexpr double kSliver = 1e-7;

void add_helpers(std::vector<Vec3>& arms) {
  const std::vector<Vec3> points = arms;
  double reach = 0.0;
  for (const Vec3& a : points) reach = std::max(reach, length(a));
  if (reach == 0.0) reach = 1.0;
  for (const Vec3& d : helper_directions()) {
    const bool near = std::any_of(points.begin(), points.end(),
                                  [&](const Vec3& a) { return dot(a, d) >= kHelperCosine * length(a); });
    if (!near) arms.push_back(reach * d);
  }
}

/// Shares of the edges of all triangles; those with one triangle only are rims.
void find_neighbours(Triangulation& mesh) {
  struct Edge {
    std::uint32_t low, high, triangle, corner;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][(k + 1) % 3], b = mesh.triangles[t][(k + 2) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, k});
      mesh.triangle_of[mesh.triangles[t][k]] = t;
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  mesh.neighbours.assign(mesh.triangles.size(), {Triangulation::kNoTriangle, Triangulation::kNoTriangle,
                                                 Triangulation::kNoTriangle});
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const Edge &a = edges[i], &b = edges[i + 1];
    if (a.low != b.low || a.high != b.high) continue;
    mesh.neighbours[a.triangle][a.corner] = b.triangle;
    mesh.neighbours[b.triangle][b.corner] = a.triangle;
  }
}

void orient(Triangulation& mesh) {
  for (Triangle& t : mesh.triangles) {
    if (orientation(mesh.arms[t[0]], mesh.arms[t[1]], mesh.arms[t[2]]) < 0.0) std::swap(t[1], t[2]);
    // The smallest index first: one form for each triangle.
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  }
  std::sort(mesh.triangles.begin(), mesh.triangles.end());
}

/// The plane's Delaunay triangulation is the hull of the points under stereographic projection, without the
/// facets at the pole (K. Q. Brown, Inf. Proc. Letters 9(5), 1979).
std::vector<Triangle> plane_triangles(const MeshSurface& surface, std::span<const Vec3> points) {
  const Frame inverse = surface.world_from_surface.inverse();
  double reach = 0.0;
  for (const Vec3& p : points) {
    const Vec3 q = inverse.point(p);
    reach = std::max(reach, std::hypot(q.x, q.y));
  }
  if (reach == 0.0) return {};
  std::vector<Vec3> sphere;
  for (const Vec3& p : points) {
    const Vec3 q = inverse.point(p) / reach;
    const double s = q.x * q.x + q.y * q.y;
    sphere.push_back(Vec3{2.0 * q.x, 2.0 * q.y, s - 1.0} / (s + 1.0));
  }
  const auto pole = static_cast<std::uint32_t>(sphere.size());
  sphere.push_back({0, 0, 1});
  std::vector<Triangle> triangles = convex_hull(sphere);
  // Points in line on the rim make facets without an area: nothing can lie in them.
  const auto flat = [&](const Triangle& t) {
    const Vec3 u = points[t[1]] - points[t[0]], v = points[t[2]] - points[t[0]];
    return length(cross(u, v)) <= kSliver * std::max(dot(u, u), dot(v, v));
  };
  std::erase_if(triangles,
                [&](const Triangle& t) { return t[0] == pole || t[1] == pole || t[2] == pole || flat(t); });
  return triangles;
}

}  // namespace

std::vector<Triangle> convex_hull(std::span<const Vec3> points) {
  if (points.size() < 4) throw InputError(fmt::format("no convex hull: {} points", points.size()));
  std::vector<double> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Vec3& p : points) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
  return Hull(coordinates).triangles();
}

Triangulation triangulate(const MeshSurface& surface, std::span<const Vec3> points) {
  LUCERNA_CHECK(surface.has_area(), "a {} has no triangles", to_string(surface.kind));
  Triangulation mesh;
  mesh.points = points.size();
  for (const Vec3& p : points) mesh.arms.push_back(p - surface.centre_mm);
  if (surface.kind == MeshSurfaceKind::plane) {
    if (points.size() >= 3) mesh.triangles = plane_triangles(surface, points);
  } else {
    add_helpers(mesh.arms);
    std::vector<Vec3> sphere;
    for (const Vec3& a : mesh.arms) sphere.push_back(a / length(a));
    mesh.triangles = convex_hull(sphere);
  }
  mesh.triangle_of.assign(mesh.arms.size(), Triangulation::kNoTriangle);
  orient(mesh);
  find_neighbours(mesh);
  return mesh;
}

MeshPlace locate(const Triangulation& mesh, const Vec3& arm, std::uint32_t start) {
  if (mesh.triangles.empty()) return {};
  std::uint32_t t = start < mesh.triangles.size() ? start : 0, from = Triangulation::kNoTriangle;
  std::array<double, 3> part{};
  // A visibility walk ends in a Delaunay mesh; the bound is for rounding at slivers.
  const std::size_t bound = 64 + 4 * mesh.triangles.size();
  for (std::size_t step = 0; step < bound; ++step) {
    const Triangle& v = mesh.triangles[t];
    const Vec3 &a = mesh.arms[v[0]], &b = mesh.arms[v[1]], &c = mesh.arms[v[2]];
    part = {orientation(arm, b, c), orientation(a, arm, c), orientation(a, b, arm)};
    std::uint32_t next = t;
    double worst = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = mesh.neighbours[t][k];
      if (part[k] < worst && other != Triangulation::kNoTriangle && other != from) {
        worst = part[k];
        next = other;
      }
    }
    if (next == t) break;
    from = t;
    t = next;
  }
  double sum = 0.0;
  for (double& x : part) sum += x = std::max(0.0, x);
  if (!(sum > 0.0)) return {t, {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}};
  for (double& x : part) x /= sum;
  return {t, part};
}

}  // namespace lucerna
