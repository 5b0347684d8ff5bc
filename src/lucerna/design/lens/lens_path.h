// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "lucerna/design/lens/lens_curves.h"
#include "lucerna/geometry.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// Hits that a path keeps; a ray with more is lost.
inline constexpr int kMaxLensHits = 24;

/// Of the hits where light may be refracted, counted along the way, those at which it is reflected instead.
struct Ghost {
  int first = -1, second = -1;

  bool reflects_at(int hit) const { return hit == first || hit == second; }
};
/// No hit of a path reflects but where reflection is total.
inline constexpr Ghost kNoGhost{};

/// Where a path meets the surface, kept for its derivative.
struct LensHit {
  Vec3 d;                     ///< where the ray came along
  Vec3 point;                 ///< where it hit
  double t = 0.0;             ///< how far it came from the hit before
  bool inside = false;        ///< it came through the medium
  bool reflected = false;     ///< else refracted
  std::int32_t piece = 0;     ///< which piece of the surface
  double u = 0.0;             ///< where on it
  double nr = 0.0, nz = 0.0;  ///< outward normal in the half plane of the hit; its tangent is (-nz, nr)
  double bend = 0.0;          ///< curvature: how the tangent turns along the curve, 1/mm
  double speed = 1.0;         ///< mm of curve per u
  double ring = 0.0;          ///< nr / r: how the normal turns about the axis, 1/mm
  Vec3 out, across, along;    ///< outward normal, unit about the axis, tangent of the curve
  double sense = 1.0;         ///< -1 where the ray comes from within
  double ratio = 1.0;         ///< index beyond over that before
  double c = 1.0;             ///< cosine of incidence
  double cos_refracted = 0.0;
  /// Shares of light whose field is across (s) and in (p) the plane of incidence that go on, and their
  /// derivatives by c over themselves.
  double s = 1.0, p = 1.0, log_s = 0.0, log_p = 0.0;
};

/// How a path ends.
enum class LensEnd { direct, left, lost };

/// The way of one ray.
struct LensPath {
  LensEnd end = LensEnd::direct;
  int hits = 0;
  /// Hits at which reflection was not total.
  int partial = 0;
  std::array<LensHit, kMaxLensHits> hit;
  /// Where the ray leaves from, and along what.
  Vec3 origin, direction;
  /// Shares of s and p light that boundaries passed on, and of all light that the medium left.
  double s = 1.0, p = 1.0, clear = 1.0;

  /// Share of the ray's flux that goes this way.
  double share() const { return 0.5 * (s + p) * clear; }
};

/// Follows rays through a body of revolution, in its frame, on the way that nearly all light takes: refracted
/// wherever it can be, with Fresnel's share of it. Light of a source that is small beside the lens keeps its
/// plane of incidence from face to face: both polarisations are followed as if it did. Immutable, thread
/// safe; `curves` must outlive it.
class LensTracer {
 public:
  LensTracer(const LensCurves& curves, const MediumView& medium) : curves_(curves), medium_(medium) {}

  /// The way of a ray to where it leaves or is lost. `path` is written anew.
  void follow(const Vec3& origin, const Vec3& direction, const Ghost& ghost, LensPath& path) const;

  /// Whether a ray begins within the medium: what it meets first it meets from within.
  bool begins_inside(const Vec3& origin, const Vec3& direction) const;

 private:
  bool next_hit(const Vec3& origin, const Vec3& direction, bool begun, bool inside, LensHit& hit) const;
  void locate(const SideHit& side, const Vec3& origin, const Vec3& direction, LensHit& hit) const;
  void set_boundary(LensHit& hit) const;

  const LensCurves& curves_;
  MediumView medium_;
};

/// Sensitivity of a figure to a change of the surface at a hit: d(figure) = rise * h + turn * w, with h the
/// change along the outward normal at the point of fixed u, and w how much the curve's tangent turns there
/// (at the fixed u, less what the point's way along the curve makes of it).
struct LensAdjoint {
  double rise = 0.0, turn = 0.0;
};

/// Exact derivatives of a figure of the path up to hit `last` by its adjoint, last hit first. `direction`,
/// `point`: the figure's gradients by the direction that leaves that hit and by its place. `share`: the
/// figure is LensPath::share, and these are added to it.
void lens_adjoint(const LensPath& path, const MediumView& medium, int last, const Vec3& direction,
                  const Vec3& point, bool share, LensAdjoint* out);

/// What the numbers of the hit's piece do to the figure.
std::array<double, kPieceNumbers> piece_derivatives(const LensHit& hit, const LensAdjoint& by);

}  // namespace lucerna
