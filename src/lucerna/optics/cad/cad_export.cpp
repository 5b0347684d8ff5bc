// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

#include "lucerna/cad.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/geometry.h"
#include "lucerna/optics/shapes/faceted_surface.h"

namespace lucerna {

namespace {

constexpr std::size_t kMaxTriangles = std::size_t{1} << 22;
static_assert(std::endian::native == std::endian::little, "STL is little-endian");

/// Places of a grid of (nu + 1) x (nv + 1) points over an aperture: spokes from the hole's rim or the axis to
/// the outline, or rows and columns.
struct Grid {
  const Reflector& reflector;
  std::size_t nu, nv;
  bool spokes;

  Vec3 vertex(std::size_t i, std::size_t j) const { return sample(i, j).point; }

  /// A vertex with the surface's normal there, of any length.
  struct Sample {
    Vec3 point, normal;
  };
  Sample sample(std::size_t i, std::size_t j) const {
    const Aperture& a = reflector.aperture;
    const double share = static_cast<double>(i) / static_cast<double>(nu);
    double x = 0.0, y = 0.0;
    if (spokes) {
      const auto [out_x, out_y] = outline(static_cast<double>(j % nv) / static_cast<double>(nv));
      const double in = a.hole_radius_mm() / std::hypot(out_x, out_y);
      x = out_x * (in + (1.0 - in) * share);
      y = out_y * (in + (1.0 - in) * share);
    } else {
      x = a.half_x_mm() * (2.0 * share - 1.0);
      y = a.half_y_mm() * (2.0 * static_cast<double>(j) / static_cast<double>(nv) - 1.0);
    }
    const SurfacePoint s = reflector.surface->at(x, y);
    return {{x, y, s.z_mm}, {-s.dzdx, -s.dzdy, 1.0}};
  }

  /// Once around, t in [0, 1): by angle, or from corner to corner of a rectangle (at 0, 1/4, ...).
  std::array<double, 2> outline(double t) const {
    const Aperture& a = reflector.aperture;
    if (a.shape() == ApertureShape::circle) {
      const double angle = 2.0 * std::numbers::pi * t;
      return {a.half_x_mm() * std::cos(angle), a.half_x_mm() * std::sin(angle)};
    }
    const int side = static_cast<int>(4.0 * t);
    const double along = 2.0 * (4.0 * t - side) - 1.0;
    const double u = side == 0 ? 1.0 : (side == 1 ? -along : (side == 2 ? -1.0 : along));
    const double v = side == 0 ? along : (side == 1 ? 1.0 : (side == 2 ? -along : -1.0));
    return {u * a.half_x_mm(), v * a.half_y_mm()};
  }

  /// How far chords of the round rims are inside their circles.
  double rim_sagitta() const {
    const Aperture& a = reflector.aperture;
    if (!spokes) return 0.0;
    double widest = 0.0;  // angle between spokes
    for (std::size_t j = 0; j < nv; ++j) {
      const auto p = outline(static_cast<double>(j) / static_cast<double>(nv));
      const auto q = outline(static_cast<double>((j + 1) % nv) / static_cast<double>(nv));
      widest = std::max(widest, std::abs(std::atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1])));
    }
    const double r = a.shape() == ApertureShape::circle ? a.half_x_mm() : a.hole_radius_mm();
    return r * (1.0 - std::cos(0.5 * widest));
  }
};

double off_surface(const Reflector& reflector, const Vec3& p) {
  const SurfacePoint s = reflector.surface->at(p.x, p.y);
  return std::abs(p.z - s.z_mm) / std::sqrt(1.0 + s.dzdx * s.dzdx + s.dzdy * s.dzdy);
}

/// A point that is on the surface.
Grid::Sample sample_at(const Reflector& reflector, const Vec3& p) {
  const SurfacePoint s = reflector.surface->at(p.x, p.y);
  return {p, {-s.dzdx, -s.dzdy, 1.0}};
}

/// Angle of a chord with the surface at its ends, whichever is more.
double off_slope(const Grid::Sample& a, const Grid::Sample& b) {
  const Vec3 chord = b.point - a.point;
  const double l = length(chord);
  if (!(l > 0.0)) return 0.0;
  double worst = 0.0;
  for (const Grid::Sample* p : {&a, &b}) {
    worst = std::max(worst, std::abs(dot(chord, p->normal)) / (l * length(p->normal)));
  }
  return std::asin(std::min(1.0, worst));
}

/// How far a grid is from its tolerance, 1 = just held: the worse of both tolerances for edges along u and
/// along v. Diagonals of twisted cells count for both.
class GridExcess {
 public:
  GridExcess(const Grid& grid, const CadTolerance& tolerance)
      : grid_(grid),
        chord_(0.75 *
               tolerance.chord_mm),  // in the middle a triangle is off by up to 4/3 of what its edges are
        angle_(0.5 * radians(tolerance.slope_deg)) {  // two edges, each half the angle off, keep the whole
    constexpr std::size_t kRows = 16;
    for (const auto& [u, v] : parallel_map_blocks<std::array<double, 2>>(
             grid.nv, kRows, [&](std::size_t first, std::size_t last) { return rows(first, last); })) {
      worst_ = {std::max(worst_[0], u), std::max(worst_[1], v)};
    }
    worst_[1] = std::max(worst_[1], grid.rim_sagitta() / tolerance.chord_mm);
  }

  const std::array<double, 2>& worst() const { return worst_; }

 private:
  using Row = std::vector<Grid::Sample>;

  Row row(std::size_t j) const {
    Row samples;
    for (std::size_t i = 0; i <= grid_.nu; ++i) samples.push_back(grid_.sample(i, j));
    return samples;
  }

  std::array<double, 2> rows(std::size_t first, std::size_t last) const {
    double u = 0.0, v = 0.0;
    Row near = row(first), far;
    for (std::size_t j = first; j < last; ++j, near.swap(far)) {
      far = row(j + 1);
      for (std::size_t i = 0; i < grid_.nu; ++i) {
        u = std::max(u, edge(near[i], near[i + 1], 1.0));
        v = std::max(v, edge(near[i], far[i], 1.0));
        const double diagonal = edge(near[i + 1], far[i], 0.5);
        if (diagonal > 1.0) {
          u = std::max(u, diagonal);
          v = std::max(v, diagonal);
        }
      }
      v = std::max(v, edge(near[grid_.nu], far[grid_.nu], 1.0));
    }
    return {u, v};
  }

  double edge(const Grid::Sample& a, const Grid::Sample& b, double slope_share) const {
    return std::max(off_surface(grid_.reflector, 0.5 * (a.point + b.point)) / chord_,
                    slope_share * off_slope(a, b) / angle_);
  }

  const Grid& grid_;
  double chord_, angle_;
  std::array<double, 2> worst_{0.0, 0.0};
};

/// More pieces for an excess over the tolerance; a multiple of 8, so that corners stay corners.
std::size_t finer(std::size_t n, double excess) {
  if (excess <= 1.0) return n;
  const double more = static_cast<double>(n) * std::clamp(std::sqrt(excess), 1.05, 2.0);
  return std::max(n + 8, 8 * static_cast<std::size_t>(std::ceil(more / 8.0)));
}

void check_tolerance(const CadTolerance& tolerance) {
  if (!(tolerance.chord_mm > 0.0 && std::isfinite(tolerance.chord_mm))) {
    throw InputError(fmt::format("CAD: the chord tolerance is {} mm, expected a finite number above 0",
                                 tolerance.chord_mm));
  }
  if (!(tolerance.slope_deg > 0.0 && tolerance.slope_deg < 90.0)) {
    throw InputError(
        fmt::format("CAD: the slope tolerance is {} degrees, expected 0 to 90", tolerance.slope_deg));
  }
}

}  // namespace

namespace {

/// The grid that keeps a tolerance with `max` triangles at most; nothing if none does.
std::optional<Grid> grid_for(const Reflector& reflector, const CadTolerance& tolerance, std::size_t max) {
  const bool spokes =
      reflector.aperture.shape() == ApertureShape::circle || reflector.aperture.hole_radius_mm() > 0.0;
  Grid grid{reflector, 8, spokes ? std::size_t{32} : std::size_t{8}, spokes};
  for (;;) {
    const auto [u, v] = GridExcess(grid, tolerance).worst();
    if (u <= 1.0 && v <= 1.0) return grid;
    grid.nu = finer(grid.nu, u);
    grid.nv = finer(grid.nv, v);
    if (2 * grid.nu * grid.nv > max) return std::nullopt;
  }
}

Mesh mesh_of(const Grid& grid) {
  const Reflector& reflector = grid.reflector;
  const bool spokes = grid.spokes;
  Mesh mesh;
  const std::size_t columns = spokes ? grid.nv : grid.nv + 1;
  for (std::size_t i = 0; i <= grid.nu; ++i) {
    for (std::size_t j = 0; j < columns; ++j) mesh.vertices_mm.push_back(grid.vertex(i, j));
  }
  const auto index = [&](std::size_t i, std::size_t j) {
    // On the axis all angles are one point.
    const std::size_t row = spokes && i == 0 && reflector.aperture.hole_radius_mm() == 0.0 ? 0 : j % columns;
    return static_cast<std::uint32_t>(i * columns + row);
  };
  for (std::size_t i = 0; i < grid.nu; ++i) {
    for (std::size_t j = 0; j < grid.nv; ++j) {
      const std::uint32_t a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), d = index(i, j + 1);
      if (a != d) mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({b, c, d});
    }
  }
  return mesh;
}

}  // namespace

Mesh cad_mesh(const Reflector& reflector, const CadTolerance& tolerance) {
  check_tolerance(tolerance);
  if (const auto* faceted = dynamic_cast<const FacetedSurface*>(reflector.surface.get())) {
    throw InputError(fmt::format("CAD: a faceted mirror steps where its facets of {} mm meet, and no "
                                 "connected mesh follows it at any tolerance",
                                 faceted->pitch_mm()),
                     ErrorCause::unsupported);
  }
  const auto grid = grid_for(reflector, tolerance, kMaxTriangles);
  if (!grid) {
    throw InputError(
        fmt::format("CAD: {} mm and {} degrees need more than {} triangles; expected coarser tolerances",
                    tolerance.chord_mm, tolerance.slope_deg, kMaxTriangles));
  }
  return mesh_of(*grid);
}

Mesh cad_mesh_within(const Reflector& reflector, CadTolerance& tolerance) {
  check_tolerance(tolerance);
  const CadTolerance wanted = tolerance;
  std::optional<Mesh> mesh;
  double kept = 1.0;
  const auto fits = [&](double factor) {
    const CadTolerance some{factor * wanted.chord_mm, factor * wanted.slope_deg};
    const auto grid = grid_for(reflector, some, std::size_t{1} << 20);
    if (!grid) return false;
    mesh = mesh_of(*grid);
    tolerance = some;
    kept = factor;
    return true;
  };
  double factor = 1.0;
  while (!fits(factor) && factor * wanted.slope_deg < 45.0) factor *= 2.0;
  if (!mesh) return cad_mesh(reflector, {factor * wanted.chord_mm, factor * wanted.slope_deg});
  // Half of what is kept was too fine; what lies between may not be.
  if (kept > 1.0) {
    for (const double step : {std::sqrt(0.5), std::sqrt(std::sqrt(0.5))}) fits(step * kept);
  }
  return *std::move(mesh);
}

std::string stl_bytes(const Mesh& mesh) {
  std::string out(80, ' ');
  constexpr std::string_view kHeader = "Lucerna reflector, mm";
  out.replace(0, kHeader.size(), kHeader);
  const auto put = [&](const auto& value) {
    out.append(std::string_view(reinterpret_cast<const char*>(&value), sizeof(value)));
  };
  const auto put_vector = [&](const Vec3& v) {
    for (const double x : {v.x, v.y, v.z}) put(static_cast<float>(x));
  };
  put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices_mm[t[0]], &b = mesh.vertices_mm[t[1]], &c = mesh.vertices_mm[t[2]];
    const Vec3 normal = cross(b - a, c - a);
    put_vector(normal / length(normal));
    for (const Vec3& p : {a, b, c}) put_vector(p);
    put(std::uint16_t{0});
  }
  return out;
}

std::string obj_text(const Mesh& mesh) {
  std::string out = "# Lucerna reflector, mm\n";
  for (const Vec3& v : mesh.vertices_mm) out += fmt::format("v {:.9g} {:.9g} {:.9g}\n", v.x, v.y, v.z);
  for (const auto& t : mesh.triangles) out += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return out;
}

std::vector<std::array<double, 2>> cad_profile(const Reflector& reflector, const CadTolerance& tolerance) {
  check_tolerance(tolerance);
  const double r0 = reflector.aperture.hole_radius_mm(), r1 = reflector.aperture.half_x_mm();
  for (std::size_t n = 8;; n *= 2) {
    std::vector<std::array<double, 2>> points;
    double worst = 0.0;
    for (std::size_t i = 0; i <= n; ++i) {
      const double r = i == n ? r1 : r0 + (r1 - r0) * static_cast<double>(i) / static_cast<double>(n);
      points.push_back({r, reflector.surface->at(r, 0.0).z_mm});
      if (i == 0) continue;
      const auto& p = points[i - 1];
      const auto& q = points[i];
      const Vec3 a{p[0], 0.0, p[1]}, b{q[0], 0.0, q[1]};
      worst = std::max(
          {worst, off_surface(reflector, 0.5 * (a + b)) / tolerance.chord_mm,
           off_slope(sample_at(reflector, a), sample_at(reflector, b)) / radians(tolerance.slope_deg)});
    }
    if (worst <= 1.0) return points;
    if (n >= kMaxTriangles) {
      throw InputError(fmt::format("CAD: {} mm needs more than {} points; expected a coarser tolerance",
                                   tolerance.chord_mm, kMaxTriangles));
    }
  }
}

std::string dxf_profile(const std::vector<std::array<double, 2>>& profile) {
  std::string out =
      "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
      "0\nPOLYLINE\n8\nPROFILE\n66\n1\n10\n0.0\n20\n0.0\n30\n0.0\n70\n0\n";
  for (const auto& [r, z] : profile) {
    out += fmt::format("0\nVERTEX\n8\nPROFILE\n10\n{:.9g}\n20\n{:.9g}\n30\n0.0\n", r, z);
  }
  return out + "0\nSEQEND\n8\nPROFILE\n0\nENDSEC\n0\nEOF\n";
}

std::string csv_profile(const std::vector<std::array<double, 2>>& profile) {
  std::string out = "r_mm,z_mm\n";
  for (const auto& [r, z] : profile) out += fmt::format("{:.9g},{:.9g}\n", r, z);
  return out;
}

}  // namespace lucerna
