// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/mesh/faced_solid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
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

/// Vertices about the axis, the first at +x; one on the axis.
struct SpokeRing {
  std::uint32_t first = 0, count = 1;
};

class FacedMesh {
 public:
  Mesh mesh;

  /// A ring of as many vertices as `count`, each where `place` puts the angle's cosine and sine.
  template <class Place>
  SpokeRing ring(int count, Place&& place) {
    const SpokeRing out{static_cast<std::uint32_t>(mesh.vertices_mm.size()),
                        static_cast<std::uint32_t>(count)};
    for (int s = 0; s < count; ++s) {
      const double angle = 2.0 * std::numbers::pi * s / count;
      mesh.vertices_mm.push_back(place(std::cos(angle), std::sin(angle)));
    }
    return out;
  }

  /// Triangles from ring to ring, the outside to the right of the way with r to the right and z up. Both have
  /// as many vertices, or one half of them, or one of the two is on the axis.
  void band(const SpokeRing& a, const SpokeRing& b) {
    const std::uint32_t n = std::max(a.count, b.count);
    const auto vertex = [n](const SpokeRing& r, std::uint32_t s) {
      return r.first + s / (n / r.count) % r.count;
    };
    for (std::uint32_t s = 0; s < n; ++s) {
      const std::uint32_t a0 = vertex(a, s), a1 = vertex(a, s + 1), b0 = vertex(b, s), b1 = vertex(b, s + 1);
      if (a.count > 1 && a0 != a1) mesh.triangles.push_back({a0, a1, b0});
      if (b.count > 1 && b0 != b1) mesh.triangles.push_back({a1, b1, b0});
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

/// The base from the ring at which it begins; the ring of the wall's lower end.
SpokeRing add_base(FacedMesh& mesh, SpokeRing at, const std::vector<OutlineSide>& sides, int spokes) {
  OutlinePoint place = sides.front().from;
  for (const OutlineSide& side : sides) {
    if (side.from != place) at = circle(mesh, side.from, spokes);  // a stretch of the axis lies between
    const double r = side.to[0] - side.from[0], z = side.to[1] - side.from[1];
    const int n = pieces_of(std::hypot(r, z), std::max(side.from[0], side.to[0]), spokes);
    for (int k = 1; k <= n; ++k) {
      const double to = static_cast<double>(k) / n;
      const SpokeRing next =
          circle(mesh, k == n ? side.to : OutlinePoint{side.from[0] + to * r, side.from[1] + to * z}, spokes);
      mesh.band(at, next);
      at = next;
    }
    place = side.to;
  }
  return at;
}

/// The longest piece of a wall of this lower end below its face's rim, mm.
double wall_height_mm(const OutlinePoint& low, const HeightSurface& face, int spokes) {
  double longest = 0.0;
  for (int s = 0; s < spokes; ++s) {
    const double angle = 2.0 * std::numbers::pi * s / spokes;
    longest = std::max(longest, face.at(low[0] * std::cos(angle), low[0] * std::sin(angle)).z_mm - low[1]);
  }
  return longest;
}

/// The ring of a wall at this share of the way from its lower end to its face's rim.
SpokeRing wall_ring(FacedMesh& mesh, const OutlinePoint& low, const HeightSurface& face, double share,
                    int spokes) {
  return mesh.ring(spokes, [&](double c, double s) {
    Vec3 p = face_point(face, low[0] * c, low[0] * s);
    if (share < 1.0) p.z = low[1] + share * (p.z - low[1]);
    return p;
  });
}

/// From the wall's lower end to the face's rim, whose ring it returns.
SpokeRing add_wall(FacedMesh& mesh, SpokeRing at, const OutlinePoint& low, const HeightSurface& face,
                   int spokes) {
  const int n = pieces_of(wall_height_mm(low, face, spokes), low[0], spokes);
  for (int k = 1; k <= n; ++k) {
    const SpokeRing next = wall_ring(mesh, low, face, static_cast<double>(k) / n, spokes);
    mesh.band(at, next);
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
    mesh.band(at, next);
    at = next;
  }
}

/// A bottom face from the axis out; the ring of its rim.
SpokeRing add_bottom(FacedMesh& mesh, double radius, const HeightSurface& face, int rings,
                     int spokes_at_rim) {
  const std::vector<int> spokes = spokes_of_rings(rings, spokes_at_rim);
  SpokeRing at;
  for (int k = 0; k <= rings; ++k) {
    const double r = radius * k / rings;
    const SpokeRing next = mesh.ring(spokes[static_cast<std::size_t>(k)],
                                     [&](double c, double s) { return face_point(face, r * c, r * s); });
    if (k > 0) mesh.band(at, next);
    at = next;
  }
  return at;
}

/// From a bottom face's rim down to the lower end of the wall about it, whose ring it returns.
SpokeRing add_inner_wall(FacedMesh& mesh, SpokeRing at, const OutlinePoint& low, const HeightSurface& face) {
  const int spokes = static_cast<int>(at.count);
  const int n = pieces_of(wall_height_mm(low, face, spokes), low[0], spokes);
  for (int k = n - 1; k >= 0; --k) {
    const SpokeRing next = wall_ring(mesh, low, face, static_cast<double>(k) / n, spokes);
    mesh.band(at, next);
    at = next;
  }
  return at;
}

/// How far triangles from number `first` on leave the face, at the middles of their sides, mm.
double face_deviation_mm(const Mesh& mesh, std::size_t first, const HeightSurface& face) {
  double worst = 0.0;
  for (std::size_t t = first; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& corners = mesh.triangles[t];
      const Vec3 p = 0.5 * (mesh.vertices_mm[corners[k]] + mesh.vertices_mm[corners[(k + 1) % 3]]);
      const SurfacePoint at = face.at(p.x, p.y);
      // Across the face, not along z.
      const double steep = std::hypot(at.dzdx, at.dzdy, 1.0);
      worst = std::max(worst, std::abs(at.z_mm - p.z) / steep);
    }
  }
  return worst;
}

}  // namespace

Mesh faced_solid(std::span<const OutlinePoint> corners_mm, const BodyFaces& faces, double smooth_below_deg,
                 double tolerance) {
  const double tolerance_mm = tolerance * faced_reach_mm(corners_mm, faces);
  const std::vector<OutlineSide> sides = faced_base_sides(corners_mm, smooth_below_deg, tolerance_mm);
  const OutlinePoint& low = corners_mm[corners_mm.size() - 2];
  for (int rings = kFirstRings;;) {
    const double arcs = 2.0 * std::numbers::pi * rings / kArcOverRing;
    const int spokes = std::max(spokes_for(tolerance), in_spoke_units(arcs));
    FacedMesh body;
    double off = 0.0;  // of the faces, over the tolerance
    const auto measure = [&](std::size_t first, const HeightSurface& face) {
      off = std::max(off, face_deviation_mm(body.mesh, first, face) / tolerance_mm);
    };
    SpokeRing at;
    if (faces.bottom) {
      at = add_bottom(body, corners_mm[1][0], *faces.bottom, rings, spokes);
      measure(0, *faces.bottom);
      at = add_inner_wall(body, at, corners_mm[1], *faces.bottom);
    } else {
      at = circle(body, sides.front().from, spokes);
    }
    const SpokeRing rim = add_wall(body, add_base(body, at, sides, spokes), low, faces.top, spokes);
    const std::size_t first = body.mesh.triangles.size();
    add_face(body, rim, low[0], faces.top, rings);
    measure(first, faces.top);
    if (off <= 1.0 || rings == kMaxRings) return std::move(body.mesh);
    // Deviations fall with the square of the rings' distance.
    rings =
        std::min(kMaxRings, static_cast<int>(std::ceil(rings * std::clamp(1.1 * std::sqrt(off), 1.1, 4.0))));
  }
}

}  // namespace lucerna
