// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/mesh/faced_solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <utility>

#include "lucerna/optics/shapes/faced_outline.h"

namespace lucerna {

namespace {

/// Spokes are halved up to six times towards the axis: their number at the rim is a multiple of this.
constexpr int kSpokeUnit = 64;
constexpr int kMinSpokes = 128, kMaxSpokes = 4096;
constexpr int kFirstRings = 8, kMaxRings = 512;
/// Arcs between neighbouring spokes are at most this times the distance of rings.
constexpr double kArcOverRing = 1.5;
/// Longest piece of a wall over the width of its triangles, and most pieces.
constexpr double kBandAspect = 8.0;
constexpr int kMaxBands = 64;

int in_spoke_units(double spokes) {
  const double units = std::ceil(std::clamp<double>(spokes, kMinSpokes, kMaxSpokes) / kSpokeUnit);
  return kSpokeUnit * static_cast<int>(units);
}

/// Segments of a circle whose chords leave it by at most this share of its radius.
int spokes_for(double share) {
  return in_spoke_units(std::numbers::pi / std::acos(1.0 - std::min(share, 0.5)));
}

Vec3 face_point(const HeightSurface& face, double x, double y) { return {x, y, face.at(x, y).z_mm}; }

Vec3 face_normal(const HeightSurface& face, const Vec3& p) {
  const SurfacePoint at = face.at(p.x, p.y);
  return Direction::from({-at.dzdx, -at.dzdy, 1.0}).vec();
}

/// Vertices about the axis, the first at +x; one on the axis.
struct SpokeRing {
  std::uint32_t first = 0, count = 1;
};

/// Normal at a place of a band: of its vertex, the angle of the spoke, and whether it is on the band's second
/// ring.
using BandNormal = std::function<Vec3(const Vec3&, double, bool)>;

class FacedMesh {
 public:
  FacedSolid solid;

  /// A ring of as many vertices as `count`, each where `place` puts the angle's cosine and sine.
  template <class Place>
  SpokeRing ring(int count, Place&& place) {
    const SpokeRing out{static_cast<std::uint32_t>(solid.mesh.vertices_mm.size()),
                        static_cast<std::uint32_t>(count)};
    for (int s = 0; s < count; ++s) {
      const double angle = 2.0 * std::numbers::pi * s / count;
      solid.mesh.vertices_mm.push_back(place(std::cos(angle), std::sin(angle)));
    }
    return out;
  }

  /// Triangles from ring to ring, the outside to the right of the way with r to the right and z up. Both have
  /// as many vertices, or `b` half of them, or one of the two is on the axis.
  void band(const SpokeRing& a, const SpokeRing& b, const BandNormal& normal) {
    const std::uint32_t n = std::max(a.count, b.count);
    const auto share = [n](const SpokeRing& r, std::uint32_t s) {
      return r.first + s / (n / r.count) % r.count;
    };
    for (std::uint32_t s = 0; s < n; ++s) {
      const double middle = 2.0 * std::numbers::pi * (s + 0.5) / n;
      const std::array<std::pair<std::uint32_t, bool>, 4> corner{
          {{share(a, s), false}, {share(a, s + 1), false}, {share(b, s), true}, {share(b, s + 1), true}}};
      if (a.count > 1) add({corner[0], corner[1], corner[2]}, middle, normal);
      if (b.count > 1 && corner[2] != corner[3]) add({corner[1], corner[3], corner[2]}, middle, normal);
    }
  }

 private:
  void add(const std::array<std::pair<std::uint32_t, bool>, 3>& corners, double middle,
           const BandNormal& normal) {
    solid.mesh.triangles.push_back({corners[0].first, corners[1].first, corners[2].first});
    for (const auto& [vertex, second] : corners) {
      const Vec3& p = solid.mesh.vertices_mm[vertex];
      const bool on_axis = p.x == 0.0 && p.y == 0.0;
      solid.corner_normals.push_back(normal(p, on_axis ? middle : std::atan2(p.y, p.x), second));
    }
  }
};

int pieces_of(double length_mm, double radius_mm, int spokes) {
  const double width = 2.0 * std::numbers::pi * radius_mm / spokes;
  return static_cast<int>(std::clamp(std::ceil(length_mm / (kBandAspect * width)), 1.0, double{kMaxBands}));
}

SpokeRing circle(FacedMesh& mesh, const OutlinePoint& p, int spokes) {
  return mesh.ring(p[0] == 0.0 ? 1 : spokes, [&](double c, double s) {
    return Vec3{p[0] * c, p[0] * s, p[1]};
  });
}

Vec3 turned_normal(const OutlineSide& side, double share, double angle) {
  const double r = (1.0 - share) * side.from_normal[0] + share * side.to_normal[0];
  const double z = (1.0 - share) * side.from_normal[1] + share * side.to_normal[1];
  return Direction::from({r * std::cos(angle), r * std::sin(angle), z}).vec();
}

/// The base; the ring of the wall's lower end.
SpokeRing add_base(FacedMesh& mesh, const std::vector<OutlineSide>& sides, int spokes) {
  SpokeRing at = circle(mesh, sides.front().from, spokes);
  OutlinePoint place = sides.front().from;
  for (const OutlineSide& side : sides) {
    if (side.from != place) at = circle(mesh, side.from, spokes);  // a stretch of the axis lies between
    const double r = side.to[0] - side.from[0], z = side.to[1] - side.from[1];
    const int n = pieces_of(std::hypot(r, z), std::max(side.from[0], side.to[0]), spokes);
    for (int k = 1; k <= n; ++k) {
      const double from = static_cast<double>(k - 1) / n, to = static_cast<double>(k) / n;
      const SpokeRing next =
          circle(mesh, k == n ? side.to : OutlinePoint{side.from[0] + to * r, side.from[1] + to * z}, spokes);
      mesh.band(at, next, [&](const Vec3&, double angle, bool second) {
        return turned_normal(side, second ? to : from, angle);
      });
      at = next;
    }
    place = side.to;
  }
  return at;
}

/// From the wall's lower end to the face's rim, whose ring it returns.
SpokeRing add_wall(FacedMesh& mesh, SpokeRing at, const OutlinePoint& low, const HeightSurface& face,
                   int spokes) {
  const double radius = low[0];
  double longest = 0.0;
  for (int s = 0; s < spokes; ++s) {
    const double angle = 2.0 * std::numbers::pi * s / spokes;
    longest = std::max(longest, face.at(radius * std::cos(angle), radius * std::sin(angle)).z_mm - low[1]);
  }
  const int n = pieces_of(longest, radius, spokes);
  for (int k = 1; k <= n; ++k) {
    const double share = static_cast<double>(k) / n;
    const SpokeRing next = mesh.ring(spokes, [&](double c, double s) {
      Vec3 p = face_point(face, radius * c, radius * s);
      if (k < n) p.z = low[1] + share * (p.z - low[1]);
      return p;
    });
    mesh.band(at, next, [](const Vec3&, double angle, bool) {
      return Vec3{std::cos(angle), std::sin(angle), 0.0};
    });
    at = next;
  }
  return at;
}

/// Spokes of every ring from the axis to the rim: halved inward wherever arcs stay short.
std::vector<int> spokes_of_rings(int rings, int spokes) {
  std::vector<int> out(static_cast<std::size_t>(rings) + 1, spokes);
  for (int k = rings - 1; k >= 1; --k) {
    const int outer = out[static_cast<std::size_t>(k) + 1];
    const bool even = outer % 2 == 0 && outer > spokes / kSpokeUnit;
    const double arcs = 2.0 * std::numbers::pi * k / kArcOverRing;
    out[static_cast<std::size_t>(k)] = even && outer / 2 >= arcs ? outer / 2 : outer;
  }
  out[0] = 1;
  return out;
}

void add_face(FacedMesh& mesh, SpokeRing at, double radius, const HeightSurface& face, int rings) {
  const std::vector<int> spokes = spokes_of_rings(rings, static_cast<int>(at.count));
  for (int k = rings - 1; k >= 0; --k) {
    const double r = radius * k / rings;
    const SpokeRing next = mesh.ring(spokes[static_cast<std::size_t>(k)],
                                     [&](double c, double s) { return face_point(face, r * c, r * s); });
    mesh.band(at, next, [&](const Vec3& p, double, bool) { return face_normal(face, p); });
    at = next;
  }
}

/// How far triangles of the face leave it, over `reach_mm`, and a tenth of how far their blended normals do:
/// at the middles of their sides.
double face_deviation(const FacedSolid& solid, std::size_t first, const HeightSurface& face,
                      double reach_mm) {
  double worst = 0.0;
  for (std::size_t t = first; t < solid.mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const auto& corners = solid.mesh.triangles[t];
      const Vec3 p = 0.5 * (solid.mesh.vertices_mm[corners[k]] + solid.mesh.vertices_mm[corners[next]]);
      const Vec3 n =
          Direction::from(solid.corner_normals[3 * t + k] + solid.corner_normals[3 * t + next]).vec();
      const Vec3 exact = face_normal(face, p);
      // Heights over the face, not along z: what a triangle is off.
      const double off = std::abs(face.at(p.x, p.y).z_mm - p.z) * exact.z / reach_mm;
      worst = std::max({worst, off, 0.1 * length(n - exact)});
    }
  }
  return worst;
}

}  // namespace

FacedSolid faced_solid(std::span<const OutlinePoint> corners_mm, const HeightSurface& face,
                       double smooth_below_deg, double tolerance) {
  const double reach = faced_reach_mm(corners_mm, face);
  const std::vector<OutlineSide> sides = faced_base_sides(corners_mm, smooth_below_deg, tolerance * reach);
  const OutlinePoint& low = corners_mm[corners_mm.size() - 2];
  for (int rings = kFirstRings;;) {
    const double arcs = 2.0 * std::numbers::pi * rings / kArcOverRing;
    const int spokes = std::max(spokes_for(tolerance), in_spoke_units(arcs));
    FacedMesh mesh;
    const SpokeRing rim = add_wall(mesh, add_base(mesh, sides, spokes), low, face, spokes);
    const std::size_t first = mesh.solid.mesh.triangles.size();
    add_face(mesh, rim, low[0], face, rings);
    const double off = face_deviation(mesh.solid, first, face, reach) / tolerance;
    if (off <= 1.0 || rings == kMaxRings) return std::move(mesh.solid);
    // Deviations fall with the square of the rings' distance.
    rings =
        std::min(kMaxRings, static_cast<int>(std::ceil(rings * std::clamp(1.1 * std::sqrt(off), 1.1, 4.0))));
  }
}

}  // namespace lucerna
