// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/random.h"

namespace lucerna {

// Light that a measured table of a BRDF sends on; small functions that CPU and GPU share. The table of an
// incidence is a density of azimuth and radial angle about the mirrored direction or the normal, linear in
// both between its angles, times the cosine at the surface as the table's own incidence has it.

/// A table as a kernel reads it. Angles in radians, ascending.
struct BsdfView {
  const double* incidence = nullptr;
  const double* azimuth = nullptr;
  const double* radial = nullptr;
  /// [incidence][azimuth][radial].
  const double* brdf = nullptr;
  /// [incidence][cell]: how much of the light is in this cell and those before it; the last is 1. Cells are
  /// numbered by azimuth, then by radial angle.
  const double* sums = nullptr;
  std::int32_t incidences = 0, azimuths = 0, radials = 0;
  /// Azimuths to pi stand for both sides.
  bool is_symmetrical = false;
  /// Angles are about the normal, azimuth 0 towards the mirrored direction; else about that, azimuth 0
  /// towards the normal.
  bool is_about_normal = false;

  LUCERNA_HD std::int32_t cells() const { return (azimuths - 1) * (radials - 1); }
};

/// The first of `count` ascending numbers that is above x; at most count - 1.
LUCERNA_HD inline std::int32_t first_above(const double* ascending, std::int32_t count, double x) {
  std::int32_t low = 0, high = count - 1;
  while (low < high) {
    const std::int32_t middle = low + (high - low) / 2;
    if (ascending[middle] > x) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

/// The cosine at the surface of a direction about that which light of this incidence is mirrored to.
LUCERNA_HD inline double cosine_at_surface(double incidence, double azimuth, double cos_radial) {
  const double sine = std::sqrt(cos_radial < 1.0 ? 1.0 - cos_radial * cos_radial : 0.0);
  return cos_radial * std::cos(incidence) + sine * std::sin(incidence) * std::cos(azimuth);
}

/// One cell of one incidence.
struct BsdfCell {
  double incidence, azimuth_from, azimuth_to, radial_from, radial_to;
  double corner[4];  ///< at azimuth from and to, each at radial from and to
  bool is_about_normal;

  LUCERNA_HD BsdfCell(const BsdfView& v, std::int32_t slice, std::int32_t cell)
      : incidence(v.incidence[slice]), is_about_normal(v.is_about_normal) {
    const std::int32_t a = cell / (v.radials - 1), r = cell % (v.radials - 1);
    azimuth_from = v.azimuth[a];
    azimuth_to = v.azimuth[a + 1];
    radial_from = v.radial[r];
    radial_to = v.radial[r + 1];
    const double* const row = v.brdf + (static_cast<std::size_t>(slice) * v.azimuths + a) * v.radials + r;
    corner[0] = row[0];
    corner[1] = row[1];
    corner[2] = row[v.radials];
    corner[3] = row[v.radials + 1];
  }

  /// At the surface, of a direction by its angles.
  LUCERNA_HD double cosine(double azimuth, double cos_radial) const {
    return is_about_normal ? cos_radial : cosine_at_surface(incidence, azimuth, cos_radial);
  }

  /// BRDF times cosine; 0 below the surface.
  LUCERNA_HD double density(double azimuth, double cos_radial) const {
    const double at_surface = cosine(azimuth, cos_radial);
    if (!(at_surface > 0.0)) return 0.0;
    const double radial = std::acos(cos_radial < 1.0 ? cos_radial : 1.0);
    const double u = (azimuth - azimuth_from) / (azimuth_to - azimuth_from);
    const double w = (radial - radial_from) / (radial_to - radial_from);
    return at_surface * ((1.0 - u) * ((1.0 - w) * corner[0] + w * corner[1]) +
                         u * ((1.0 - w) * corner[2] + w * corner[3]));
  }

  /// No density in it is larger.
  LUCERNA_HD double bound() const {
    double most = 0.0;
    for (const double c : corner) most = c > most ? c : most;
    if (is_about_normal) return most * std::cos(radial_from) * (1.0 + 1e-9);
    // The cosine is the largest where the azimuth is nearest to the normal's, 0 or 2 pi.
    const double end = 2.0 * std::numbers::pi - azimuth_to;
    const double nearest = azimuth_from < end ? azimuth_from : end;
    double best = std::atan2(std::sin(incidence) * std::cos(nearest), std::cos(incidence));
    if (best < radial_from) best = radial_from;
    if (best > radial_to) best = radial_to;
    const double highest = cosine_at_surface(incidence, nearest, std::cos(best));
    return most * (highest > 0.0 ? highest : 0.0) * (1.0 + 1e-9);
  }
};

/// Which of the table's incidences light of this incidence (rad) is scattered by: one of the two about it, by
/// chance. `u` uniform in [0, 1).
LUCERNA_HD inline std::int32_t bsdf_slice(const BsdfView& v, double incidence, double u) {
  const std::int32_t above = first_above(v.incidence, v.incidences, incidence);
  if (above == 0 || !(incidence < v.incidence[above])) return above;
  const double share = (incidence - v.incidence[above - 1]) / (v.incidence[above] - v.incidence[above - 1]);
  return u < share ? above : above - 1;
}

/// Azimuth and cosine of the radial angle.
struct BsdfAngles {
  double azimuth = 0.0, cos_radial = 1.0;
};

/// Drawn by the table of one incidence.
LUCERNA_HD inline BsdfAngles drawn_angles(const BsdfView& v, std::int32_t slice, Rng& rng) {
  const double* const sums = v.sums + static_cast<std::size_t>(slice) * v.cells();
  const BsdfCell cell(v, slice, first_above(sums, v.cells(), rng.uniform()));
  const double bound = cell.bound(), high = std::cos(cell.radial_from), low = std::cos(cell.radial_to);
  BsdfAngles out;
  // A cell that light was found in is accepted far sooner.
  for (int i = 0; i < 100'000; ++i) {
    out.azimuth = cell.azimuth_from + (cell.azimuth_to - cell.azimuth_from) * rng.uniform();
    out.cos_radial = low + (high - low) * rng.uniform();
    if (rng.uniform() * bound <= cell.density(out.azimuth, out.cos_radial)) break;
  }
  if (v.is_symmetrical && rng.uniform() < 0.5) out.azimuth = -out.azimuth;
  return out;
}

/// The axes that a table stands on at one of its incidences: along the surface in the plane of incidence,
/// where the mirrored light goes; across that plane; and the normal.
struct BsdfAxes {
  Direction along, across, normal;

  LUCERNA_HD BsdfAxes(const Direction& n, const Direction& mirrored) : normal(n) {
    const Vec3 flat = mirrored.vec() - dot(n, mirrored) * n.vec();
    along = dot(flat, flat) > 1e-20 ? Direction::from(flat) : Direction::from(Frame::from_z(n).ex());
    across = Direction::from(cross(n.vec(), along.vec()));
  }
};

/// The direction of angles of a table of incidence `incidence`, as cosines along the axes; above the surface
/// where the table has light.
LUCERNA_HD inline Vec3 direction_of(const BsdfView& v, double incidence, const BsdfAngles& a) {
  const double sine = std::sqrt(a.cos_radial < 1.0 ? 1.0 - a.cos_radial * a.cos_radial : 0.0);
  const double x = sine * std::cos(a.azimuth), y = sine * std::sin(a.azimuth);
  if (v.is_about_normal) return {x, y, a.cos_radial};
  // About the mirrored direction, azimuth 0 towards the normal.
  const double c = std::cos(incidence), s = std::sin(incidence);
  return {s * a.cos_radial - c * x, -y, c * a.cos_radial + s * x};
}

/// What a table's direction becomes for light of another incidence. Cosines along the surface, over the
/// longest that they could be, are moved so that the mirrored direction goes to the mirrored one and grazing
/// ones stay: x to (x + k) / (1 + k x). The BRDF goes along, so that one that is even stays even.
struct BsdfShift {
  double k = 0.0;

  LUCERNA_HD static double longest(double across) {
    return across * across < 1.0 ? std::sqrt(1.0 - across * across) : 0.0;
  }
  LUCERNA_HD Vec3 moved(const Vec3& d, double by) const {
    const double c = longest(d.y);
    if (by == 0.0 || !(c > 0.0)) return d;
    const double x = d.x / c, to = (x + by) / (1.0 + by * x);
    const double z2 = 1.0 - to * to;
    return {c * to, d.y, c * std::sqrt(z2 > 0.0 ? z2 : 0.0)};
  }
  LUCERNA_HD Vec3 there(const Vec3& d) const { return moved(d, k); }
  LUCERNA_HD Vec3 back(const Vec3& d) const { return moved(d, -k); }
  /// How much the cosines about a direction of the table are spread, over the most that any are.
  LUCERNA_HD double spread(const Vec3& d) const {
    const double c = longest(d.y), x = c > 0.0 ? d.x / c : 0.0;
    const double least = 1.0 - (k < 0.0 ? -k : k), here = 1.0 + k * x;
    return least * least / (here * here);
  }
};

/// No shift is larger: where it would be, a peak stays behind its light.
inline constexpr double kMostBsdfShift = 0.875;

/// From the incidence of a table to that of the light, by the sines of both. So much at most that one in 64
/// directions at the table's mirrored one is taken (BsdfShift::spread).
LUCERNA_HD inline BsdfShift bsdf_shift(double from, double to) {
  constexpr double kLeast = 1.0 - kMostBsdfShift;
  if (!(from * to < 1.0)) return {};
  const double k = (to - from) / (1.0 - from * to), most = (1.0 - kLeast) / (1.0 + kLeast * from);
  return {k > most ? most : k < -kMostBsdfShift ? -kMostBsdfShift : k};
}

/// Where light goes that a mirror of `normal` would send to `mirrored`: above the surface.
LUCERNA_HD inline Direction scattered_by(const BsdfView& v, const Direction& normal,
                                         const Direction& mirrored, Rng& rng) {
  const double cosine = dot(normal, mirrored);
  const double incidence = std::acos(cosine > 1.0 ? 1.0 : cosine < 0.0 ? 0.0 : cosine);
  const std::int32_t slice = bsdf_slice(v, incidence, rng.uniform());
  const double of_table = v.incidence[slice];
  const BsdfShift shift = bsdf_shift(std::sin(of_table), std::sin(incidence));
  Vec3 d = direction_of(v, of_table, drawn_angles(v, slice, rng));
  // The table's density times how much it is spread: of an even table a fifteenth is taken at least.
  for (int i = 0; i < 100'000 && rng.uniform() > shift.spread(d); ++i)
    d = direction_of(v, of_table, drawn_angles(v, slice, rng));
  const Vec3 out = shift.there(d);
  const BsdfAxes axes(normal, mirrored);
  return Direction::from(out.x * axes.along.vec() + out.y * axes.across.vec() + out.z * axes.normal.vec());
}

}  // namespace lucerna
