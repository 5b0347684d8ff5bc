// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/design_limits.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "lucerna/core/io/error.h"

namespace lucerna {

ShapeSymmetry read_symmetry(TomlReader& reader, bool revolution, const Frame& world_from_shape) {
  static const std::map<std::string, ShapeSymmetry, std::less<>> kNames{{"none", ShapeSymmetry::none},
                                                                        {"c0-c180", ShapeSymmetry::mirror_y},
                                                                        {"c90-c270", ShapeSymmetry::mirror_x},
                                                                        {"both", ShapeSymmetry::both}};
  const std::string name = reader.word("symmetry").value_or("none");
  if (name == "rotational") {
    if (!revolution) {
      reader.fail("symmetry", "= \"rotational\" contradicts the family; expected \"revolution\"");
    }
    return ShapeSymmetry::none;
  }
  const ShapeSymmetry symmetry = kNames.at(name);
  if (revolution || symmetry == ShapeSymmetry::none) return ShapeSymmetry::none;
  const bool along_x = std::abs(world_from_shape.ex().x) > 1.0 - 1e-9;
  const bool along_y = std::abs(world_from_shape.ex().y) > 1.0 - 1e-9;
  if (!along_x && !along_y) {
    reader.fail("symmetry", "needs an x axis that lies in C0-C180 or C90-C270 (turn_deg)");
  }
  if (along_y && symmetry == ShapeSymmetry::mirror_x) return ShapeSymmetry::mirror_y;
  if (along_y && symmetry == ShapeSymmetry::mirror_y) return ShapeSymmetry::mirror_x;
  return symmetry;
}

namespace {

Mesh box_mesh(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices_mm.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A prism that holds the cylinder: its faces touch it.
Mesh cylinder_mesh(const Vec3& from, const Vec3& to, double radius) {
  constexpr std::uint32_t kSides = 48;
  const Frame frame = Frame::from_z(Direction::from(to - from), from);
  const double length_mm = length(to - from), around = radius / std::cos(std::numbers::pi / kSides);
  Mesh mesh;
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double a = 2.0 * std::numbers::pi * i / kSides;
    mesh.vertices_mm.push_back(frame.point({around * std::cos(a), around * std::sin(a), 0.0}));
    mesh.vertices_mm.push_back(frame.point({around * std::cos(a), around * std::sin(a), length_mm}));
  }
  mesh.vertices_mm.push_back(from);
  mesh.vertices_mm.push_back(to);
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % kSides);
    mesh.triangles.push_back({a, b, a + 1});
    mesh.triangles.push_back({b, b + 1, a + 1});
    mesh.triangles.push_back({2 * kSides, b, a});
    mesh.triangles.push_back({2 * kSides + 1, a + 1, b + 1});
  }
  return mesh;
}

Vec3 required_vector(TomlReader& reader, const char* key) {
  const auto v = reader.vector(key);
  if (!v) reader.fail(key, "is missing: a point [x, y, z] in mm");
  return *v;
}

Mesh read_zone(TomlReader& reader) {
  const std::string kind = reader.required_word("kind");
  if (kind == "mesh") {
    const auto file = reader.file("file");
    if (!file) reader.missing("file", "an STL or OBJ file");
    return read_mesh(*file);
  }
  if (kind == "box") {
    const Vec3 low = required_vector(reader, "min_mm"), high = required_vector(reader, "max_mm");
    if (!(low.x < high.x && low.y < high.y && low.z < high.z)) {
      reader.fail("max_mm", "expected every coordinate above that of min_mm");
    }
    return box_mesh(low, high);
  }
  const Vec3 from = required_vector(reader, "from_mm"), to = required_vector(reader, "to_mm");
  const auto radius = reader.number("radius_mm");
  if (!radius) reader.missing("radius_mm");
  if (!(length(to - from) > 0.0)) reader.fail("to_mm", "is the same point as from_mm");
  return cylinder_mesh(from, to, *radius);
}

void move(Mesh& mesh, const Frame& frame) {
  for (Vec3& v : mesh.vertices_mm) v = frame.point(v);
}

std::vector<KeepOut> read_keep_out(TomlReader& reader, const Frame& mirror_from_world,
                                   const std::vector<Body>& bodies) {
  std::vector<KeepOut> zones;
  for (TomlReader& zone : reader.tables("keep_out")) {
    KeepOut k{fmt::format("keep_out[{}]", zones.size()), read_zone(zone), zone.number("clearance_mm", 0.0)};
    zone.finish();
    move(k.mesh, mirror_from_world);
    zones.push_back(std::move(k));
  }
  if (const auto clearance = reader.number("body_clearance_mm")) {
    if (bodies.empty()) reader.fail("body_clearance_mm", "needs a [[body]] to keep clear of");
    for (const Body& body : bodies) {
      KeepOut k{"body " + body.name, *body.mesh, *clearance};
      move(k.mesh, mirror_from_world * body.world_from_body);
      zones.push_back(std::move(k));
    }
  }
  return zones;
}

std::optional<GlareLimit> read_glare(TomlReader& reader, double source_flux) {
  auto glare = reader.table("glare");
  if (!glare) return std::nullopt;
  GlareLimit limit;
  const auto beyond = glare->number("beyond_deg");
  if (!beyond) glare->fail("beyond_deg", "is missing: the angle from the mirror's axis");
  const auto cd = glare->number("max_cd"), per_klm = glare->number("max_cd_per_klm");
  if (cd.has_value() == per_klm.has_value()) {
    glare->fail("max_cd", "expected either max_cd or max_cd_per_klm");
  }
  glare->finish();
  limit.beyond_deg = *beyond;
  limit.max_per_flux = cd ? *cd / source_flux : *per_klm / 1000.0;
  limit.text = cd ? fmt::format("{} cd beyond {} deg", *cd, *beyond)
                  : fmt::format("{} cd/klm beyond {} deg", *per_klm, *beyond);
  return limit;
}

/// Limits that the fixed aperture alone decides.
void check_aperture(const TomlReader& reader, const DesignLimits& l, const Aperture& aperture) {
  const double diameter = 2.0 * aperture.outer_radius_mm(), hole = 2.0 * aperture.hole_radius_mm();
  const double opening = 2.0 * std::min(aperture.half_x_mm(), aperture.half_y_mm());
  if (l.max_diameter_mm && l.min_opening_mm && *l.min_opening_mm > *l.max_diameter_mm) {
    reader.fail("min_opening_mm",
                fmt::format("= {} contradicts max_diameter_mm = {}", *l.min_opening_mm, *l.max_diameter_mm),
                ErrorCause::contradiction);
  }
  if (l.max_diameter_mm && l.min_hole_diameter_mm && *l.min_hole_diameter_mm >= *l.max_diameter_mm) {
    reader.fail("min_hole_diameter_mm",
                fmt::format("= {} contradicts max_diameter_mm = {}: the hole would be the whole mirror",
                            *l.min_hole_diameter_mm, *l.max_diameter_mm),
                ErrorCause::contradiction);
  }
  if (l.max_diameter_mm && diameter > *l.max_diameter_mm) {
    reader.fail(
        "max_diameter_mm",
        fmt::format("= {} contradicts the reflector's aperture, {} mm across", *l.max_diameter_mm, diameter),
        ErrorCause::contradiction);
  }
  if (l.min_opening_mm && opening < *l.min_opening_mm) {
    reader.fail(
        "min_opening_mm",
        fmt::format("= {} contradicts the reflector's aperture, {} mm wide", *l.min_opening_mm, opening),
        ErrorCause::contradiction);
  }
  if (l.min_hole_diameter_mm && hole < *l.min_hole_diameter_mm) {
    reader.fail(
        "min_hole_diameter_mm",
        fmt::format("= {} contradicts the reflector's hole_diameter_mm = {}", *l.min_hole_diameter_mm, hole),
        ErrorCause::contradiction);
  }
}

}  // namespace

DesignLimits read_limits(TomlReader reader, const Aperture& aperture, bool revolution,
                         const Frame& world_from_mirror, const std::vector<Body>& bodies,
                         double source_flux) {
  DesignLimits limits;
  limits.max_diameter_mm = reader.number("max_diameter_mm");
  limits.min_opening_mm = reader.number("min_opening_mm");
  limits.min_hole_diameter_mm = reader.number("min_hole_diameter_mm");
  limits.max_height_mm = reader.number("max_height_mm");
  limits.max_slope_deg = reader.number("max_slope_deg");
  limits.min_radius_mm = reader.number("min_radius_mm");
  limits.min_efficiency = reader.number("min_efficiency");
  limits.symmetry = read_symmetry(reader, revolution, world_from_mirror);
  limits.keep_out = read_keep_out(reader, world_from_mirror.inverse(), bodies);
  limits.glare = read_glare(reader, source_flux);
  reader.finish();
  check_aperture(reader, limits, aperture);
  return limits;
}

}  // namespace lucerna
