// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/random.h"
#include "lucerna/trace/kernels/slope_error.h"

namespace lucerna {

// What light does at a plane-parallel plate of glass; small functions that CPU and GPU share. The plate fills
// 0 <= z <= thickness of its own frame.

/// A plate as a kernel reads it; plain data.
struct CoverGlassView {
  bool round;  ///< a disk of radius half_x, or a box
  double half_x_mm, half_y_mm, thickness_mm;
  double index;              ///< of refraction, >= 1
  double absorption_per_mm;  ///< natural logarithm per mm of path
};

/// What a plate returns and lets through of one polarisation, all inter-reflections summed.
struct PlateShares {
  double reflected = 1.0, transmitted = 0.0;
  double interface = 1.0;  ///< reflectance of one interface
  double passage = 1.0;    ///< what one way through the glass leaves
};

/// Sums the incoherent series of a plate (M. Born, E. Wolf, "Principles of Optics", 7th ed., 1.5.2 for an
/// interface): T = (1 - r)^2 a / (1 - r^2 a^2), R = r (1 + a T).
LUCERNA_HD inline PlateShares plate_shares(double interface, double passage) {
  if (interface >= 1.0) return {};
  const double ra = interface * passage, once = 1.0 - interface;
  const double transmitted = once * once * passage / (1.0 - ra * ra);
  return {interface * (1.0 + passage * transmitted), transmitted, interface, passage};
}

/// Both polarisations at one angle.
struct CoverGlassAtAngle {
  PlateShares s, p;
  double cos_inside = 1.0;
};
LUCERNA_HD inline CoverGlassAtAngle cover_glass_at_angle(const CoverGlassView& cover_glass,
                                                         double cos_incidence) {
  const double ci = cos_incidence < 1.0 ? cos_incidence : 1.0, n = cover_glass.index;
  const double ct = std::sqrt(1.0 - (1.0 - ci * ci) / (n * n));
  if (!(ci > 0.0)) return {{}, {}, ct};
  const double s = (ci - n * ct) / (ci + n * ct), p = (n * ci - ct) / (n * ci + ct);
  const double passage = std::exp(-cover_glass.absorption_per_mm * cover_glass.thickness_mm / ct);
  return {plate_shares(s * s, passage), plate_shares(p * p, passage), ct};
}

LUCERNA_HD inline bool on_cover_glass(const CoverGlassView& cover_glass, double x_mm, double y_mm) {
  if (cover_glass.round) return x_mm * x_mm + y_mm * y_mm <= cover_glass.half_x_mm * cover_glass.half_x_mm;
  return std::abs(x_mm) <= cover_glass.half_x_mm && std::abs(y_mm) <= cover_glass.half_y_mm;
}

/// Where a ray from outside enters a plate.
struct CoverGlassEntry {
  bool is_hit = false;
  bool edge = false;  ///< through the rim, which is black
  double t_mm = 0.0;
};

/// First entry at t >= 0 of a ray in the plate's frame. A ray that starts inside the plate, or on a face and
/// leaves, does not meet it.
LUCERNA_HD inline CoverGlassEntry cover_glass_entry(const CoverGlassView& cover_glass, const Vec3& o,
                                                    const Vec3& d) {
  // The rim's part of the ray, then the faces'; a plate is convex, so one interval each.
  double in = -1e300, out = 1e300;
  const auto clip = [&in, &out](double low, double high) {
    in = low > in ? low : in;
    out = high < out ? high : out;
  };
  const auto clip_axis = [&clip](double start, double step, double low, double high) {
    if (step == 0.0) {
      if (start < low || start > high) clip(1e300, -1e300);
      return;
    }
    const double a = (low - start) / step, b = (high - start) / step;
    clip(a < b ? a : b, a < b ? b : a);
  };
  if (cover_glass.round) {
    const double a = d.x * d.x + d.y * d.y, b = o.x * d.x + o.y * d.y;
    const double c = o.x * o.x + o.y * o.y - cover_glass.half_x_mm * cover_glass.half_x_mm;
    const double disc = b * b - a * c;
    if (a == 0.0 ? c > 0.0 : disc < 0.0) return {};
    if (a > 0.0) {
      const double root = std::sqrt(disc), w = b < 0.0 ? -b + root : -b - root;
      const double t = w == 0.0 ? 0.0 : c / w;
      clip(w / a < t ? w / a : t, w / a < t ? t : w / a);
    }
  } else {
    clip_axis(o.x, d.x, -cover_glass.half_x_mm, cover_glass.half_x_mm);
    clip_axis(o.y, d.y, -cover_glass.half_y_mm, cover_glass.half_y_mm);
  }
  const double through_rim = in;
  clip_axis(o.z, d.z, 0.0, cover_glass.thickness_mm);
  if (!(in < out) || in < 0.0) return {};
  return {true, in == through_rim, in};
}

/// What becomes of a ray that met a plate.
struct CoverGlassOutcome {
  /// Share of its flux that goes on; the rest stays in the plate.
  double throughput = 0.0;
  bool transmitted = false;
  /// How often it went through the glass: odd if transmitted, even if reflected.
  double ways = 0.0;
  Vec3 origin_mm;
  Vec3 direction;
};

/// Which of the light that a plate returns and lets through goes on.
enum class GlassSides { both, transmitted, reflected };

/// `u` and `v` are uniform in [0, 1): u picks polarisation and side in proportion to what they carry (so that
/// `throughput` is the share that all sides asked for get together), v how often the light went to and fro
/// inside.
LUCERNA_HD inline CoverGlassOutcome pass_cover_glass(const CoverGlassView& cover_glass, const Vec3& o,
                                                     const Vec3& d, const CoverGlassEntry& entry,
                                                     GlassSides sides, double u, double v) {
  if (entry.edge) return {};
  const CoverGlassAtAngle at = cover_glass_at_angle(cover_glass, std::abs(d.z));
  const double r = sides == GlassSides::transmitted ? 0.0 : 1.0;
  const double t = sides == GlassSides::reflected ? 0.0 : 1.0;
  const double s_share = r * at.s.reflected + t * at.s.transmitted;
  const double all = s_share + r * at.p.reflected + t * at.p.transmitted;
  double pick = u * all;
  CoverGlassOutcome out;
  out.throughput = 0.5 * all;
  const bool s = pick < s_share;
  if (!s) pick -= s_share;
  const PlateShares& share = s ? at.s : at.p;
  out.transmitted = sides == GlassSides::both ? pick < share.transmitted : sides == GlassSides::transmitted;
  // Ways through the glass: 1, 3, 5 ... if transmitted, 0, 2, 4 ... if reflected; each pair has ra^2 times
  // the light of the pair before, the reflection outside being the first.
  const double ra = share.interface * share.passage, ratio = ra * ra;
  double ways = out.transmitted ? 1.0 : 0.0, rest = v;
  bool inside = out.transmitted;
  if (!out.transmitted) {
    const double first = share.interface / share.reflected;
    inside = v >= first;
    if (inside) {
      rest = (v - first) / (1.0 - first);
      ways = 2.0;
    }
  }
  if (inside && ratio > 0.0) ways += 2.0 * std::floor(std::log(1.0 - rest) / std::log(ratio));
  out.ways = ways;
  const double shift = ways * cover_glass.thickness_mm / (cover_glass.index * at.cos_inside);
  const bool from_above = d.z < 0.0;
  const bool leaves_above = from_above != out.transmitted;
  out.origin_mm = {o.x + (entry.t_mm + shift) * d.x, o.y + (entry.t_mm + shift) * d.y,
                   leaves_above ? cover_glass.thickness_mm : 0.0};
  out.direction = {d.x, d.y, out.transmitted ? d.z : -d.z};
  if (!on_cover_glass(cover_glass, out.origin_mm.x, out.origin_mm.y))
    out.throughput = ways > 0.0 ? 0.0 : out.throughput;
  return out;
}

/// A plate in the luminaire frame.
struct PlacedCoverGlass {
  CoverGlassView cover_glass;
  Frame world_from_glass, glass_from_world;
};

struct GlassHit {
  double t_mm = 0.0;
  std::size_t glass = 0;
  bool edge = false;
  /// Of a clear body: the triangle or the side of its outline, and where on it; a plate has none.
  std::int32_t part = -1;
  double u = 0.0, v = 0.0;
};

/// The first of n plates within [0, t_max_mm) of a ray in the luminaire frame.
LUCERNA_HD inline std::optional<GlassHit> first_cover_glass(const PlacedCoverGlass* cover_glasses,
                                                            std::size_t n, const Ray& ray, double t_max_mm) {
  std::optional<GlassHit> first;
  for (std::size_t i = 0; i < n; ++i) {
    const Ray local = cover_glasses[i].glass_from_world.ray(ray);
    const CoverGlassEntry entry =
        cover_glass_entry(cover_glasses[i].cover_glass, local.origin_mm, local.direction.vec());
    if (!entry.is_hit || !(entry.t_mm < t_max_mm)) continue;
    t_max_mm = entry.t_mm;
    first = GlassHit{entry.t_mm, i, entry.edge};
  }
  return first;
}

/// A ray after a plate or a clear body, in the luminaire frame.
struct GlassPassage {
  /// Share of the flux that goes on; 0: the ray ends here, and `ray` is nothing.
  double throughput = 0.0;
  bool transmitted = false;
  /// How often it went through a plate, face to face.
  int ways = 0;
  Ray ray;
  /// Given up in a body: what goes on is lost.
  bool lost = false;
};

/// What becomes of a ray that met a plate. `key.bounce` counts all that the ray hit before, plates included.
LUCERNA_HD inline GlassPassage through_cover_glass(const PlacedCoverGlass& cover_glass, const Ray& ray,
                                                   const GlassHit& hit, const ReflectionKey& key,
                                                   GlassSides sides = GlassSides::both) {
  const Ray local = cover_glass.glass_from_world.ray(ray);
  // Streams below 2^17 belong to whoever emits and to slope errors.
  Rng rng(key.sequence_seed, key.ray, 0x20000u + static_cast<std::uint32_t>(key.bounce));
  const double u = rng.uniform(), v = rng.uniform();
  const CoverGlassOutcome out =
      pass_cover_glass(cover_glass.cover_glass, local.origin_mm, local.direction.vec(),
                       {true, hit.edge, hit.t_mm}, sides, u, v);
  if (!(out.throughput > 0.0)) return {};
  // What goes straight on keeps the direction that it came with, to the bit.
  const Direction direction =
      out.transmitted ? ray.direction
                      : cover_glass.world_from_glass.direction(Direction::from_unit(out.direction));
  return {out.throughput,
          out.transmitted,
          static_cast<int>(out.ways),
          {cover_glass.world_from_glass.point(out.origin_mm), direction},
          false};
}

}  // namespace lucerna
