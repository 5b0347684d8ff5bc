// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solids_apart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/mesh.h"
#include "lucerna/optics/mesh/mesh_shells.h"
#include "lucerna/trace/kernels/triangle_bvh.h"

namespace lucerna {

namespace {

/// A solid as triangles.
Body as_body(const Solid& solid, std::shared_ptr<const Mesh> mesh) {
  Body body;
  body.name = solid.name;
  body.mesh = std::move(mesh);
  body.world_from_body = solid.world_from_solid;
  return body;
}

/// A cover glass as triangles.
Body as_body(const CoverGlass& glass) {
  const Aperture& a = glass.aperture;
  const double x = a.half_x_mm(), y = a.half_y_mm(), d = glass.thickness_mm;
  Mesh mesh;
  if (a.shape() == ApertureShape::circle) {
    mesh = solid_of_revolution(std::vector<std::array<double, 2>>{{0, 0}, {x, 0}, {x, d}, {0, d}});
  } else {
    for (int i = 0; i < 8; ++i)
      mesh.vertices_mm.push_back({(i & 1) != 0 ? x : -x, (i & 2) != 0 ? y : -y, (i & 4) != 0 ? d : 0.0});
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  }
  Body body;
  body.name = glass.name;
  body.mesh = std::make_shared<const Mesh>(std::move(mesh));
  body.world_from_body = glass.world_from_glass;
  return body;
}

/// Solids that are nearer to each other than this touch, mm.
constexpr double kTouch = 5e-3;

struct Extents {
  Vec3 low_mm, high_mm;
};

Extents extents_of(const Body& body) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Extents box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (const Vec3& v : body.mesh->vertices_mm) {
    const Vec3 p = body.world_from_body.point(v);
    box.low_mm = {std::min(box.low_mm.x, p.x), std::min(box.low_mm.y, p.y), std::min(box.low_mm.z, p.z)};
    box.high_mm = {std::max(box.high_mm.x, p.x), std::max(box.high_mm.y, p.y), std::max(box.high_mm.z, p.z)};
  }
  return box;
}

/// Are bodies in these boxes so far apart that they cannot touch?
bool are_far(const Extents& a, const Extents& b) {
  return a.low_mm.x > b.high_mm.x + kTouch || b.low_mm.x > a.high_mm.x + kTouch ||
         a.low_mm.y > b.high_mm.y + kTouch || b.low_mm.y > a.high_mm.y + kTouch ||
         a.low_mm.z > b.high_mm.z + kTouch || b.low_mm.z > a.high_mm.z + kTouch;
}

bool is_within(const Extents& box, const Vec3& p) {
  return p.x >= box.low_mm.x && p.x <= box.high_mm.x && p.y >= box.low_mm.y && p.y <= box.high_mm.y &&
         p.z >= box.low_mm.z && p.z <= box.high_mm.z;
}

/// A closed or open mesh in the luminaire frame, and a tree over it, which is made when it is asked for: most
/// bodies are far from each other.
class Placed {
 public:
  explicit Placed(Body body)
      : name(body.name), extents(extents_of(body)), mesh(*body.mesh), body_(std::move(body)) {
    for (const Vec3& v : mesh.vertices_mm) vertices_mm.push_back(body_.world_from_body.point(v));
  }

  TriangleBvhView tree() {
    if (!tree_) tree_.emplace(std::vector<Body>{body_}, true);
    return tree_->view();
  }

  std::string name;
  Extents extents;
  std::vector<Vec3> vertices_mm;
  const Mesh& mesh;

 private:
  Body body_;
  std::optional<TriangleBvh> tree_;
};

/// Does anything of `p` lie on the way from a to b, its ends left out?
bool crosses(Placed& p, const Vec3& a, const Vec3& b) {
  const double reach = length(b - a);
  if (!(reach > 0.0)) return false;
  return first_triangle(p.tree(), a, (b - a) / reach, 1e-9 * reach, (1.0 - 1e-9) * reach).triangle >= 0;
}

/// Is a point within a closed mesh? By how many surfaces a ray that is parallel to no axis meets.
bool contains(Placed& p, Vec3 point) {
  const Direction d = Direction::from({0.8017, 0.3141, 0.5087});
  bool inside = false;
  for (int i = 0; i < 10000; ++i) {
    const TriangleHit hit = first_triangle(p.tree(), point, d.vec(), i == 0 ? 0.0 : 1e-9,
                                           std::numeric_limits<double>::infinity());
    if (hit.triangle < 0) return inside;
    inside = !inside;
    point = point + hit.t * d.vec();
  }
  return inside;
}

/// A corner of it.
const Vec3& corner_of(const Placed& p) { return p.vertices_mm[p.mesh.triangles.front()[0]]; }

/// Does an edge of `a` run through the surface of `b`?
bool edges_cut(const Placed& a, Placed& b) {
  for (const auto& t : a.mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = t[k], to = t[(k + 1) % 3];
      if (from < to && crosses(b, a.vertices_mm[from], a.vertices_mm[to])) return true;
    }
  }
  return false;
}

/// Does the surface of one run through that of the other?
bool cut(Placed& a, Placed& b) { return edges_cut(a, b) || edges_cut(b, a); }

/// Does the middle of a triangle of `a` lie on `b`?
bool touches(const Placed& a, Placed& b) {
  for (const auto& t : a.mesh.triangles) {
    const Vec3 &p = a.vertices_mm[t[0]], &q = a.vertices_mm[t[1]], &r = a.vertices_mm[t[2]];
    const Vec3 across = cross(q - p, r - p), middle = (1.0 / 3.0) * (p + q + r);
    if (!(length(across) > 0.0)) continue;
    const Vec3 step = (kTouch / length(across)) * across;
    if (crosses(b, middle - step, middle + step)) return true;
  }
  return false;
}

/// Points of a mirror, dense enough for what is as large as a lens.
std::vector<Vec3> points_of(const PlacedReflector& mirror) {
  constexpr int kSide = 24;
  std::vector<Vec3> out;
  const Aperture& a = mirror.reflector.aperture;
  if (!mirror.reflector.surface) return out;  // a swept curve
  for (int i = 0; i <= kSide; ++i) {
    for (int k = 0; k <= kSide; ++k) {
      const double x = a.half_x_mm() * (2.0 * i / kSide - 1.0), y = a.half_y_mm() * (2.0 * k / kSide - 1.0);
      if (!a.contains(x, y)) continue;
      out.push_back(mirror.world_from_reflector.point({x, y, mirror.reflector.surface->at(x, y).z_mm}));
    }
  }
  return out;
}

/// Does one of two closed surfaces hold, cut or touch the other?
bool meet(Placed& a, Placed& b) {
  return !are_far(a.extents, b.extents) && (cut(a, b) || contains(a, corner_of(b)) ||
                                            contains(b, corner_of(a)) || touches(a, b) || touches(b, a));
}

void check_shells(const Solid& solid) {
  std::vector<Mesh> meshes = shells_of(*solid.mesh);
  if (meshes.size() < 2) return;
  std::vector<bool> outward;
  std::vector<std::unique_ptr<Placed>> shells;
  for (Mesh& mesh : meshes) {
    outward.push_back(signed_volume(mesh) > 0.0);
    shells.push_back(std::make_unique<Placed>(as_body(solid, std::make_shared<const Mesh>(std::move(mesh)))));
  }
  std::optional<bool> turned;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    bool is_hollow = false;
    for (std::size_t k = 0; k < shells.size(); ++k) {
      if (k == i || are_far(shells[i]->extents, shells[k]->extents)) continue;
      if (cut(*shells[i], *shells[k]))
        throw InputError(
            fmt::format("solid '{}': shells of its mesh cut each other; expected them apart, or one "
                        "as a hollow within another",
                        solid.name));
      is_hollow = is_hollow != contains(*shells[k], corner_of(*shells[i]));
    }
    const bool as_outer = outward[i] != is_hollow;
    if (turned.value_or(as_outer) != as_outer)
      throw InputError(
          fmt::format("solid '{}': one of {} shells of its mesh is turned the wrong way; expected "
                      "all of them alike, and hollows within them the other way",
                      solid.name, shells.size()));
    turned = as_outer;
  }
}

[[noreturn]] void fail_apart(const std::string& solid, const std::string& other) {
  throw InputError(fmt::format("solid '{}' and {}: one holds, cuts or touches the other; expected them apart",
                               solid, other));
}

/// What is less than this within a plate only touches it, mm.
constexpr double kSkin = 1e-3;

/// Is a point of a plate's frame within it, not just on it?
bool is_within(const CoverGlass& glass, const Vec3& p) {
  return p.z > kSkin && p.z < glass.thickness_mm - kSkin && glass.aperture.contains(p.x, p.y);
}

/// Points within a plate, from just within its faces on.
std::vector<Vec3> points_of(const CoverGlass& glass) {
  constexpr int kSide = 16;
  std::vector<Vec3> out;
  const Aperture& a = glass.aperture;
  for (int i = 0; i <= kSide; ++i) {
    for (int k = 0; k <= kSide; ++k) {
      const double x = a.half_x_mm() * (2.0 * i / kSide - 1.0), y = a.half_y_mm() * (2.0 * k / kSide - 1.0);
      if (!a.contains(x, y)) continue;
      for (const double share : {0.01, 0.5, 0.99})
        out.push_back(glass.world_from_glass.point({x, y, share * glass.thickness_mm}));
    }
  }
  return out;
}

/// Plates may touch each other, but not share room.
void check_plates_apart(const std::vector<CoverGlass>& glasses) {
  std::vector<Extents> boxes;
  std::vector<std::vector<Vec3>> points;
  for (const CoverGlass& glass : glasses) {
    boxes.push_back(extents_of(as_body(glass)));
    points.push_back(points_of(glass));
  }
  for (std::size_t i = 0; i < glasses.size(); ++i) {
    const CoverGlass& glass = glasses[i];
    const Frame glass_from_world = glass.world_from_glass.inverse();
    const auto is_in_glass = [&](const Vec3& p) { return is_within(glass, glass_from_world.point(p)); };
    for (std::size_t k = 0; k < glasses.size(); ++k) {
      const CoverGlass& other = glasses[k];
      if (k == i || are_far(boxes[i], boxes[k]) || !std::ranges::any_of(points[k], is_in_glass)) continue;
      throw InputError(fmt::format("cover glass '{}' and cover glass '{}' share room; expected them apart",
                                   glass.name, other.name));
    }
  }
}

/// What of a plate is not skin; none if it is all skin.
std::optional<CoverGlass> without_skin(const CoverGlass& glass) {
  const Aperture& a = glass.aperture;
  const double x = 2.0 * (a.half_x_mm() - kSkin), y = 2.0 * (a.half_y_mm() - kSkin);
  if (!(std::min({x, y, glass.thickness_mm - 2.0 * kSkin}) > 0.0)) return std::nullopt;
  CoverGlass core = glass;
  core.aperture = a.shape() == ApertureShape::circle ? Aperture::circle(x) : Aperture::rectangle(x, y);
  core.thickness_mm -= 2.0 * kSkin;
  core.world_from_glass = glass.world_from_glass * Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, kSkin});
  return core;
}

/// Lines over a mirror, from its axis or one side to the rim and none over a hole, dense enough for what is
/// as large as a plate.
std::vector<std::vector<Vec3>> lines_on(const PlacedReflector& mirror) {
  constexpr int kLines = 96, kSteps = 48;
  std::vector<std::vector<Vec3>> lines;
  const Aperture& a = mirror.reflector.aperture;
  if (!mirror.reflector.surface) return lines;  // a swept curve
  for (int i = 0; i <= kLines; ++i) {
    lines.emplace_back();
    const double turn = 2.0 * std::numbers::pi * i / kLines, y_mm = a.half_y_mm() * (2.0 * i / kLines - 1.0);
    for (int k = 0; k <= kSteps; ++k) {
      const double share = static_cast<double>(k) / kSteps, r_mm = share * (1.0 - 1e-12) * a.half_x_mm();
      const bool round = a.shape() == ApertureShape::circle;
      const double x = round ? r_mm * std::cos(turn) : a.half_x_mm() * (2.0 * share - 1.0);
      const double y = round ? r_mm * std::sin(turn) : y_mm;
      if (a.contains(x, y)) {
        const double z = mirror.reflector.surface->at(x, y).z_mm;
        lines.back().push_back(mirror.world_from_reflector.point({x, y, z}));
      } else if (!lines.back().empty()) {
        lines.emplace_back();
      }
    }
  }
  return lines;
}

bool reaches_into(const PlacedReflector& mirror, Placed& plate) {
  for (const std::vector<Vec3>& line : lines_on(mirror)) {
    for (std::size_t k = 0; k < line.size(); ++k) {
      if (is_within(plate.extents, line[k]) && contains(plate, line[k])) return true;
      if (k > 0 && crosses(plate, line[k - 1], line[k])) return true;
    }
  }
  return false;
}

bool reaches_into(const Body& body, Placed& plate) {
  if (are_far(extents_of(body), plate.extents)) return false;
  Placed b(body);
  return cut(b, plate) || contains(plate, corner_of(b));
}

}  // namespace

void check_apart(const Scene& scene) {
  check_plates_apart(scene.glasses);
  std::vector<std::unique_ptr<Placed>> solids, plates;
  for (const CoverGlass& glass : scene.glasses) plates.push_back(std::make_unique<Placed>(as_body(glass)));
  for (const Solid& solid : scene.solids) {
    check(solid);
    if (solid.mesh != nullptr) check_shells(solid);
    Placed& s = *solids.emplace_back(std::make_unique<Placed>(as_body(solid, surface_mesh(solid))));
    for (std::size_t k = 0; k + 1 < solids.size(); ++k) {
      Placed& other = *solids[k];
      if (meet(s, other)) fail_apart(s.name, fmt::format("solid '{}'", other.name));
    }
    for (const auto& plate : plates) {
      if (meet(s, *plate)) fail_apart(s.name, fmt::format("cover glass '{}'", plate->name));
    }
    for (const Body& body : scene.bodies) {
      if (are_far(s.extents, extents_of(body))) continue;
      Placed b(body);
      if (cut(b, s) || contains(s, corner_of(b))) fail_apart(s.name, fmt::format("body '{}'", body.name));
    }
    for (std::size_t m = 0; m < scene.reflectors.size(); ++m) {
      for (const Vec3& point : points_of(scene.reflectors[m])) {
        if (is_within(s.extents, point) && contains(s, point))
          fail_apart(s.name, fmt::format("reflector {}", m + 1));
      }
    }
  }
}

std::vector<std::string> within_plates(const Scene& scene) {
  std::vector<std::string> lines;
  for (const CoverGlass& glass : scene.glasses) {
    const std::optional<CoverGlass> core = without_skin(glass);
    if (!core) continue;
    Placed plate(as_body(*core));
    const auto add = [&](const std::string& what) {
      lines.push_back(
          fmt::format("{} reaches into cover glass '{}': light crosses the glass in one step and passes what "
                      "is within; expected the glass beyond it",
                      what, glass.name));
    };
    for (std::size_t m = 0; m < scene.reflectors.size(); ++m) {
      if (reaches_into(scene.reflectors[m], plate)) add(fmt::format("reflector {}", m + 1));
    }
    for (const Body& body : scene.bodies) {
      if (reaches_into(body, plate)) add(fmt::format("body '{}'", body.name));
    }
  }
  return lines;
}

}  // namespace lucerna
