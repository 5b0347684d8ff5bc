// SPDX-License-Identifier: Apache-2.0
#include "lucerna/reflector/cad_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "lucerna/core/error.h"

namespace lucerna {

namespace {

constexpr std::size_t kMostTriangles = std::size_t{1} << 22;
static_assert(std::endian::native == std::endian::little, "STL is little-endian");

/// Places of a grid of (nu + 1) x (nv + 1) points over an aperture.
struct Grid {
  const Reflector& reflector;
  std::size_t nu, nv;
  bool polar;

  Vec3 vertex(std::size_t i, std::size_t j) const {
    const Aperture& a = reflector.aperture;
    double x, y;
    if (polar) {
      const double r0 = a.hole_radius_mm(),
                   r = r0 + (a.half_x_mm() - r0) * static_cast<double>(i) / static_cast<double>(nu);
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(j % nv) / static_cast<double>(nv);
      x = r * std::cos(angle);
      y = r * std::sin(angle);
    } else {
      x = a.half_x_mm() * (2.0 * static_cast<double>(i) / static_cast<double>(nu) - 1.0);
      y = a.half_y_mm() * (2.0 * static_cast<double>(j) / static_cast<double>(nv) - 1.0);
    }
    return {x, y, reflector.surface->at(x, y).z_mm};
  }
  /// A cell of a rectangle that reaches into the hole is left out.
  bool in_hole(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
    const double hole = reflector.aperture.hole_radius_mm();
    if (polar || hole <= 0.0) return false;
    for (const Vec3& p : {a, b, c, d}) {
      if (std::hypot(p.x, p.y) < hole) return true;
    }
    return false;
  }
};

double off_surface(const Reflector& reflector, const Vec3& p) {
  const SurfacePoint s = reflector.surface->at(p.x, p.y);
  return std::abs(p.z - s.z_mm) / std::sqrt(1.0 + s.dzdx * s.dzdx + s.dzdy * s.dzdy);
}

/// The largest distance of edge middles from the surface, along u and along v (with the diagonals).
std::array<double, 2> deviations(const Grid& grid) {
  double u = 0.0, v = 0.0;
  const auto middle = [&](const Vec3& a, const Vec3& b) {
    return off_surface(grid.reflector, 0.5 * (a + b));
  };
  for (std::size_t j = 0; j < grid.nv; ++j) {
    for (std::size_t i = 0; i < grid.nu; ++i) {
      const Vec3 a = grid.vertex(i, j), b = grid.vertex(i + 1, j), d = grid.vertex(i, j + 1);
      u = std::max(u, middle(a, b));
      v = std::max({v, middle(a, d), middle(b, d)});
      if (i + 1 == grid.nu) v = std::max(v, middle(b, grid.vertex(i + 1, j + 1)));
    }
  }
  return {u, v};
}

void check_tolerance(const CadTolerance& tolerance) {
  if (!(tolerance.chord_mm > 0.0 && std::isfinite(tolerance.chord_mm))) {
    throw InputError(fmt::format("CAD: the chord tolerance is {} mm, expected a finite number above 0",
                                 tolerance.chord_mm));
  }
}

}  // namespace

Mesh cad_mesh(const Reflector& reflector, const CadTolerance& tolerance) {
  check_tolerance(tolerance);
  const bool polar = reflector.aperture.shape() == ApertureShape::circle;
  Grid grid{reflector, 8, polar ? std::size_t{32} : std::size_t{8}, polar};
  for (;;) {
    const auto [u, v] = deviations(grid);
    if (u <= tolerance.chord_mm && v <= tolerance.chord_mm) break;
    if (u > tolerance.chord_mm) grid.nu *= 2;
    if (v > tolerance.chord_mm) grid.nv *= 2;
    if (2 * grid.nu * grid.nv > kMostTriangles) {
      throw InputError(fmt::format("CAD: {} mm needs more than {} triangles; expected a coarser tolerance",
                                   tolerance.chord_mm, kMostTriangles));
    }
  }
  Mesh mesh;
  const std::size_t columns = polar ? grid.nv : grid.nv + 1;
  for (std::size_t i = 0; i <= grid.nu; ++i) {
    for (std::size_t j = 0; j < columns; ++j) mesh.vertices_mm.push_back(grid.vertex(i, j));
  }
  const auto index = [&](std::size_t i, std::size_t j) {
    // On the axis all angles are one point.
    const std::size_t row = polar && i == 0 && reflector.aperture.hole_radius_mm() == 0.0 ? 0 : j % columns;
    return static_cast<std::uint32_t>(i * columns + row);
  };
  for (std::size_t i = 0; i < grid.nu; ++i) {
    for (std::size_t j = 0; j < grid.nv; ++j) {
      const std::uint32_t a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), d = index(i, j + 1);
      const auto& v = mesh.vertices_mm;
      if (grid.in_hole(v[a], v[b], v[c], v[d])) continue;
      if (a != d) mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({b, c, d});
    }
  }
  return mesh;
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
      worst = std::max(worst, off_surface(reflector, {0.5 * (p[0] + q[0]), 0.0, 0.5 * (p[1] + q[1])}));
    }
    if (worst <= tolerance.chord_mm) return points;
    if (n >= kMostTriangles) {
      throw InputError(fmt::format("CAD: {} mm needs more than {} points; expected a coarser tolerance",
                                   tolerance.chord_mm, kMostTriangles));
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
