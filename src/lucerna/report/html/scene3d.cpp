// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/scene3d.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "lucerna/optics/shapes/swept_curve.h"
#include "lucerna/report/html/html_text.h"
#include "lucerna/trace/engines/ray_paths.h"

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kRings = 32, kSpokes = 96;

void append(std::vector<double>& out, const Vec3& v) { out.insert(out.end(), {v.x, v.y, v.z}); }

/// Azimuths of the mesh: evenly spaced; of a rectangle the nearest ones go to its corners, so that those are
/// there.
std::vector<double> azimuths(const Aperture& aperture) {
  std::vector<double> phi(kSpokes);
  const double step = 2.0 * std::numbers::pi / kSpokes;
  for (std::size_t i = 0; i < kSpokes; ++i) phi[i] = static_cast<double>(i) * step;
  if (aperture.shape() == ApertureShape::circle) return phi;
  const double corner = std::atan2(aperture.half_y_mm(), aperture.half_x_mm());
  for (const double at :
       {corner, std::numbers::pi - corner, std::numbers::pi + corner, 2.0 * std::numbers::pi - corner}) {
    phi[static_cast<std::size_t>(std::lround(at / step)) % kSpokes] = at;
  }
  return phi;
}

/// Distance of the outer rim from the axis.
double rim_mm(const Aperture& aperture, double phi) {
  if (aperture.shape() == ApertureShape::circle) return aperture.half_x_mm();
  const double c = std::abs(std::cos(phi)), s = std::abs(std::sin(phi));
  return 1.0 / std::max(c / aperture.half_x_mm(), s / aperture.half_y_mm());
}

/// Mean curvature of z = h(x, y), positive where it is hollow towards +z (M. do Carmo, "Differential Geometry
/// of Curves and Surfaces", section 3-3).
double mean_curvature(const HeightSurface& surface, double x, double y, double step) {
  const SurfacePoint at = surface.at(x, y);
  const SurfacePoint east = surface.at(x + step, y), west = surface.at(x - step, y);
  const SurfacePoint north = surface.at(x, y + step), south = surface.at(x, y - step);
  const double hxx = (east.dzdx - west.dzdx) / (2.0 * step), hyy = (north.dzdy - south.dzdy) / (2.0 * step);
  const double hxy = (east.dzdy - west.dzdy + north.dzdx - south.dzdx) / (4.0 * step);
  const double p = at.dzdx, q = at.dzdy, w = 1.0 + p * p + q * q;
  return ((1.0 + q * q) * hxx - 2.0 * p * q * hxy + (1.0 + p * p) * hyy) / (2.0 * w * std::sqrt(w));
}

/// The smallest sphere about a box's centre that holds what is seen.
struct Extent {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};

  void add(const Vec3& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Vec3 centre() const { return 0.5 * (low + high); }
  double radius() const { return std::max(1e-3, 0.5 * length(high - low)); }
};

/// Points of a mirror's mesh, gathered ring after ring.
struct MirrorMesh {
  std::vector<double> position, normal, slope, curvature;

  void add(const Frame& frame, const Vec3& at, const Vec3& n, double mean_curvature_per_mm, Extent& extent) {
    const Vec3 world = frame.point(at);
    extent.add(world);
    append(position, world);
    append(normal, frame.vector(n));
    slope.push_back(degrees(std::atan2(std::hypot(n.x, n.y), n.z)));
    curvature.push_back(mean_curvature_per_mm);
  }
  Json json(const std::string& name, std::size_t rings, std::size_t spokes) const {
    return {{"name", name},
            {"rings", rings},
            {"spokes", spokes},
            {"position", base64_floats(position)},
            {"normal", base64_floats(normal)},
            {"slope_deg", base64_floats(slope)},
            {"curvature_per_mm", base64_floats(curvature)}};
  }
};

Json mirror_json(const PlacedReflector& placed, std::size_t index, Extent& extent) {
  const Aperture& aperture = placed.reflector.aperture;
  const HeightSurface& surface = *placed.reflector.surface;
  const double step = 1e-4 * aperture.outer_radius_mm();
  MirrorMesh mesh;
  const std::vector<double> phi = azimuths(aperture);
  for (std::size_t ring = 0; ring <= kRings; ++ring) {
    const double t = static_cast<double>(ring) / kRings;
    for (const double angle : phi) {
      const double r = aperture.hole_radius_mm() + t * (rim_mm(aperture, angle) - aperture.hole_radius_mm());
      const double x = r * std::cos(angle), y = r * std::sin(angle);
      const SurfacePoint at = surface.at(x, y);
      // Beyond its rims the surface goes on straight: differences are taken just inside them.
      const double inside =
          std::clamp(r, aperture.hole_radius_mm() + 2.0 * step, rim_mm(aperture, angle) - 2.0 * step);
      mesh.add(placed.world_from_reflector, {x, y, at.z_mm}, Direction::from({-at.dzdx, -at.dzdy, 1.0}).vec(),
               mean_curvature(surface, inside * std::cos(angle), inside * std::sin(angle), step), extent);
    }
  }
  return mesh.json(fmt::format("mirror {}", index + 1), kRings + 1, kSpokes);
}

/// Curvature of the profile in its own plane, positive where it is hollow on the reflecting side.
double profile_curvature(const SweptCurve& curve, double u) {
  constexpr double kStep = 1e-5;
  const SweptCurve::Point a = curve.at(std::max(0.0, u - kStep)), b = curve.at(std::min(1.0, u + kStep));
  const SweptCurve::Point n = curve.at(u);
  const double length = std::hypot(b.r_mm - a.r_mm, b.z_mm - a.z_mm);
  // The tangent is the normal, turned by a right angle.
  return ((b.normal_z - a.normal_z) * n.normal_r - (b.normal_r - a.normal_r) * n.normal_z) / length;
}

/// A swept curve with all its sheets: rings along the profile; of a trough each side of x by itself, its
/// spokes going along y and back. A rectangle that cuts a surface of revolution is not drawn.
void add_swept_curve(const PlacedReflector& placed, std::size_t index, Extent& extent, Json& mirrors) {
  constexpr std::size_t kCurveRings = 96;
  const SweptCurve& curve = *placed.reflector.curve;
  const bool trough = curve.sweep() == Sweep::trough;
  const double half_y = placed.reflector.aperture.half_y_mm();
  for (const double side : trough ? std::vector{1.0, -1.0} : std::vector{1.0}) {
    MirrorMesh mesh;
    for (std::size_t ring = 0; ring <= kCurveRings; ++ring) {
      const double u = static_cast<double>(ring) / kCurveRings;
      const SweptCurve::Point p = curve.at(u);
      const double along = profile_curvature(curve, u);
      const double across = trough ? 0.0 : (p.r_mm > 0.0 ? -p.normal_r / p.r_mm : along);
      for (std::size_t spoke = 0; spoke < kSpokes; ++spoke) {
        const double t = static_cast<double>(spoke) / kSpokes, phi = 2.0 * std::numbers::pi * t;
        const double c = trough ? side : std::cos(phi), s = trough ? 0.0 : std::sin(phi);
        const double y = trough ? half_y * (1.0 - 4.0 * std::abs(t - 0.5)) : p.r_mm * s;
        mesh.add(placed.world_from_reflector, {p.r_mm * c, y, p.z_mm},
                 {p.normal_r * c, p.normal_r * s, p.normal_z}, 0.5 * (along + across), extent);
      }
    }
    const std::string name = fmt::format("mirror {}", index + 1);
    mirrors.push_back(
        mesh.json(trough ? name + (side > 0.0 ? " (+x)" : " (-x)") : name, kCurveRings + 1, kSpokes));
  }
}

/// The mesh with all vertices of a cell of a grid joined, `cells` to the longest side of its box; triangles
/// that collapse are gone.
Mesh joined(const Mesh& mesh, double cells) {
  Extent box;
  for (const Vec3& v : mesh.vertices_mm) box.add(v);
  const Vec3 size = box.high - box.low;
  const double step = std::max({size.x, size.y, size.z, 1e-9}) / cells;
  std::map<std::array<long, 3>, std::uint32_t> seen;
  Mesh out;
  std::vector<std::uint32_t> to(mesh.vertices_mm.size());
  for (std::size_t i = 0; i < to.size(); ++i) {
    const Vec3 p = (mesh.vertices_mm[i] - box.low) / step;
    const auto [at, fresh] = seen.try_emplace({std::lround(p.x), std::lround(p.y), std::lround(p.z)},
                                              static_cast<std::uint32_t>(out.vertices_mm.size()));
    if (fresh) out.vertices_mm.push_back(mesh.vertices_mm[i]);
    to[i] = at->second;
  }
  for (const auto& t : mesh.triangles) {
    const std::array<std::uint32_t, 3> n{to[t[0]], to[t[1]], to[t[2]]};
    if (n[0] != n[1] && n[1] != n[2] && n[2] != n[0]) out.triangles.push_back(n);
  }
  return out;
}

Json body_json(const Body& body, Extent& extent) {
  const Mesh* mesh = body.mesh.get();
  Mesh coarse;
  for (double cells = 256.0; mesh->triangles.size() > kMaxBodyTriangles; cells *= 0.7) {
    coarse = joined(*body.mesh, cells);
    mesh = &coarse;
  }
  std::vector<double> position;
  std::vector<std::uint32_t> index;
  for (const Vec3& v : mesh->vertices_mm) {
    const Vec3 world = body.world_from_body.point(v);
    extent.add(world);
    append(position, world);
  }
  for (const auto& t : mesh->triangles) index.insert(index.end(), t.begin(), t.end());
  return {{"name", body.name},
          {"position", base64_floats(position)},
          {"index", base64_counts(index)},
          {"thinned", mesh == &coarse}};
}

Json solid_json(const Solid& solid, Extent& extent) {
  Body body;
  body.name = solid.name;
  body.mesh = surface_mesh(solid);
  body.world_from_body = solid.world_from_solid;
  return body_json(body, extent);
}

/// The plate as a solid: its outline on both faces and what joins them.
Json glass_json(const CoverGlass& glass, Extent& extent) {
  const Aperture& aperture = glass.aperture;
  const bool round = aperture.shape() == ApertureShape::circle;
  const std::uint32_t corners = round ? kSpokes : 4;
  std::vector<double> position;
  const auto add = [&](const Vec3& v) {
    const Vec3 world = glass.world_from_glass.point(v);
    extent.add(world);
    append(position, world);
  };
  for (std::uint32_t i = 0; i < corners; ++i) {
    const double phi = 2.0 * std::numbers::pi * i / corners;
    const double x =
        round ? aperture.half_x_mm() * std::cos(phi) : (i == 0 || i == 3 ? 1.0 : -1.0) * aperture.half_x_mm();
    const double y =
        round ? aperture.half_y_mm() * std::sin(phi) : (i < 2 ? 1.0 : -1.0) * aperture.half_y_mm();
    add({x, y, 0.0});
    add({x, y, glass.thickness_mm});
  }
  std::vector<std::uint32_t> index;
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % corners);
    index.insert(index.end(), {a, b, b + 1, a, b + 1, a + 1});
    if (i > 0 && i + 1 < corners) index.insert(index.end(), {0, b, a, 1, a + 1, b + 1});
  }
  return {{"name", glass.name}, {"position", base64_floats(position)}, {"index", base64_counts(index)}};
}

/// The starts of the run's first rays.
std::vector<double> source_points(const Scene& scene, const Scene3dOptions& options, Extent& extent) {
  // Without mirrors a path is its start alone.
  Scene bare{scene.sources, {}, scene.far_fields};
  std::vector<double> points;
  for (const RayPath& path :
       ray_paths(bare, options.source_points,
                 {.seed = options.seed, .sequence = options.sequence, .first_ray = options.first_ray})) {
    extent.add(path.points_mm.front());
    append(points, path.points_mm.front());
  }
  return points;
}

Json rays_json(const std::vector<RayPath>& paths, double beyond_mm) {
  std::vector<double> position;
  Json bounces = Json::array();
  for (const RayPath& path : paths) {
    std::vector<Vec3> points = path.points_mm;
    if (path.end == RayEnd::out) points.push_back(points.back() + beyond_mm * path.last_direction.vec());
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      append(position, points[i]);
      append(position, points[i + 1]);
      bounces.push_back(path.reflections[i]);
    }
  }
  return {{"count", paths.size()}, {"position", base64_floats(position)}, {"bounces", bounces}};
}

}  // namespace

Json scene3d_json(const Scene& scene, const Scene3dOptions& options) {
  Extent extent;
  Json mirrors = Json::array();
  for (std::size_t i = 0; i < scene.reflectors.size(); ++i) {
    if (scene.reflectors[i].reflector.curve) {
      add_swept_curve(scene.reflectors[i], i, extent, mirrors);
    } else {
      mirrors.push_back(mirror_json(scene.reflectors[i], i, extent));
    }
  }
  Json bodies = Json::array();
  for (const Body& body : scene.bodies) bodies.push_back(body_json(body, extent));
  Json glasses = Json::array();
  for (const CoverGlass& glass : scene.glasses) glasses.push_back(glass_json(glass, extent));
  for (const Solid& solid : scene.solids) glasses.push_back(solid_json(solid, extent));
  const std::vector<double> starts = source_points(scene, options, extent);
  const Vec3 centre = extent.centre();
  const double radius = extent.radius();
  const auto paths =
      ray_paths(scene, options.rays,
                {.seed = options.seed, .sequence = options.sequence, .first_ray = options.first_ray});
  return {{"centre_mm", {centre.x, centre.y, centre.z}},
          {"radius_mm", radius},
          {"mirrors", mirrors},
          {"bodies", bodies},
          {"glasses", glasses},
          {"source", {{"position", base64_floats(starts)}}},
          {"rays", rays_json(paths, 1.2 * radius)}};
}

}  // namespace lucerna
