// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/measured_scatter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// Points along each side of a cell; more where the surface cuts it.
constexpr int kPoints = 8, kPointsAtHorizon = 32;

std::vector<double> in_radians(const std::vector<double>& angles_deg) {
  std::vector<double> out;
  for (const double a : angles_deg) out.push_back(radians(a));
  return out;
}

std::int32_t count_of(const std::vector<double>& v) { return static_cast<std::int32_t>(v.size()); }

/// Throws InputError for a table that no reader makes.
const BsdfTable& checked(const BsdfTable& t) {
  const auto ascend = [](const std::vector<double>& angles, std::size_t least) {
    return angles.size() >= least &&
           std::ranges::adjacent_find(angles, std::greater_equal<>()) == angles.end();
  };
  if (!ascend(t.incidence_deg, 1) || !ascend(t.azimuth_deg, 2) || !ascend(t.radial_deg, 2))
    throw InputError(
        "a BRDF: found angles that do not ascend, expected an incidence, two azimuths and two radial "
        "angles at least");
  if (t.is_about_normal && t.radial_deg.back() > 90.0)
    throw InputError(
        fmt::format("a BRDF: found {} degrees from the normal, expected at most 90", t.radial_deg.back()));
  const std::size_t values = t.row(t.incidence_deg.size(), 0);
  if (t.brdf.size() != values)
    throw InputError(fmt::format("a BRDF: found {} values, expected {}", t.brdf.size(), values));
  return t;
}

/// Does the surface cut it, by its corners?
bool is_cut(const BsdfCell& cell) {
  int above = 0;
  for (const double azimuth : {cell.azimuth_from, cell.azimuth_to}) {
    for (const double radial : {cell.radial_from, cell.radial_to})
      above += cell.cosine(azimuth, std::cos(radial)) > 0.0 ? 1 : 0;
  }
  return above != 4;
}

/// The light of a cell, each direction times its weight, by the midpoint rule over solid angle with n points
/// along each side.
template <class Weight>
double light_in(const BsdfCell& cell, int n, const Weight& weight) {
  const double high = std::cos(cell.radial_from), low = std::cos(cell.radial_to);
  const double wide = cell.azimuth_to - cell.azimuth_from;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      const BsdfAngles a{cell.azimuth_from + wide * (i + 0.5) / n, low + (high - low) * (k + 0.5) / n};
      const double density = cell.density(a.azimuth, a.cos_radial);
      if (density > 0.0) sum += density * weight(a);
    }
  }
  return sum * wide * (high - low) / (n * n);
}

double light_in(const BsdfCell& cell) {
  return light_in(cell, is_cut(cell) ? kPointsAtHorizon : kPoints, [](const BsdfAngles&) { return 1.0; });
}

}  // namespace

MeasuredScatter::MeasuredScatter(const BsdfTable& table)
    : incidence_(in_radians(checked(table).incidence_deg)),
      azimuth_(in_radians(table.azimuth_deg)),
      radial_(in_radians(table.radial_deg)),
      brdf_(table.brdf),
      sums_(table.incidence_deg.size() * (table.azimuth_deg.size() - 1) * (table.radial_deg.size() - 1)),
      view_{incidence_.data(),      azimuth_.data(),      radial_.data(),     brdf_.data(),
            sums_.data(),           count_of(incidence_), count_of(azimuth_), count_of(radial_),
            table.is_symmetrical(), table.is_about_normal} {
  const BsdfView& v = view_;
  made_ = std::make_unique<std::once_flag[]>(incidence_.size());
  spread_.resize(incidence_.size());
  double* at = sums_.data();
  for (std::int32_t slice = 0; slice < v.incidences; ++slice) {
    double* const first = at;
    double sum = 0.0;
    for (std::int32_t cell = 0; cell < v.cells(); ++cell) *at++ = sum += light_in(BsdfCell(v, slice, cell));
    if (!(sum > 0.0)) {
      throw InputError(fmt::format("a BRDF has no light above the surface at {} degrees of incidence",
                                   table.incidence_deg[static_cast<std::size_t>(slice)]));
    }
    for (double* s = first; s != at; ++s) *s /= sum;
    integrals_.push_back(v.is_symmetrical ? 2.0 * sum : sum);
  }
}

namespace {

/// Angles of a table of incidence `incidence` for cosines along its axes; the azimuth from -pi.
BsdfAngles angles_of(const BsdfView& v, double incidence, const Vec3& d) {
  if (v.is_about_normal) return {std::atan2(d.y, d.x), d.z};
  const double c = std::cos(incidence), s = std::sin(incidence);
  return {std::atan2(-d.y, s * d.z - c * d.x), s * d.x + c * d.z};
}

/// The integral of the table's density times `spread` of the shift.
double shifted_light(const BsdfView& v, std::int32_t slice, const BsdfShift& shift) {
  constexpr int kSide = 5;
  double sum = 0.0;
  for (std::int32_t i = 0; i < v.cells(); ++i) {
    const BsdfCell cell(v, slice, i);
    sum += light_in(cell, kSide,
                    [&](const BsdfAngles& a) { return shift.spread(direction_of(v, cell.incidence, a)); });
  }
  return v.is_symmetrical ? 2.0 * sum : sum;
}

}  // namespace

double MeasuredScatter::spread_light(std::int32_t slice, const BsdfShift& shift) const {
  // Shifts at even steps, linear between: the integral is smooth.
  const auto at = static_cast<std::size_t>(slice);
  std::call_once(made_[at], [&] {
    for (int i = 0; i <= kShifts; ++i) {
      const BsdfShift one{(2.0 * i / kShifts - 1.0) * kMostBsdfShift};
      spread_[at][static_cast<std::size_t>(i)] = shifted_light(view_, slice, one);
    }
    // Nothing is shifted there: what it differs by is the rule's error.
    const double whole = spread_[at][kShifts / 2];
    for (double& s : spread_[at]) s *= integrals_[at] / whole;
  });
  const double place = std::clamp((shift.k / kMostBsdfShift + 1.0) * 0.5, 0.0, 1.0) * kShifts;
  const auto below = std::min(static_cast<std::size_t>(place), std::size_t{kShifts - 1});
  return std::lerp(spread_[at][below], spread_[at][below + 1], place - static_cast<double>(below));
}

double MeasuredScatter::density(std::int32_t slice, double incidence, const Vec3& out) const {
  const BsdfView& v = view_;
  const auto at = static_cast<std::size_t>(slice);
  const BsdfShift shift = bsdf_shift(std::sin(incidence_[at]), std::sin(incidence));
  const Vec3 d = shift.back(out);
  BsdfAngles a = angles_of(v, incidence_[at], d);
  const double radial = std::acos(std::clamp(a.cos_radial, -1.0, 1.0));
  if (radial > radial_.back() || !(d.z > 0.0)) return 0.0;
  if (a.azimuth < 0.0) a.azimuth = v.is_symmetrical ? -a.azimuth : a.azimuth + 2.0 * std::numbers::pi;
  const auto cell_of = [](const std::vector<double>& angles, double angle) {
    return std::max(first_above(angles.data(), static_cast<std::int32_t>(angles.size()), angle), 1) - 1;
  };
  const BsdfCell cell(v, slice, cell_of(azimuth_, a.azimuth) * (v.radials - 1) + cell_of(radial_, radial));
  // Of cosines along the surface, in which the shift spreads; `spread` is over the most that it does.
  const double brdf = cell.density(a.azimuth, a.cos_radial) / d.z, k = std::abs(shift.k);
  return brdf * out.z / (spread_light(slice, shift) * (1.0 + k) / (1.0 - k));
}

double MeasuredScatter::density(const Direction& normal, const Direction& mirrored,
                                const Direction& out) const {
  const BsdfView& v = view_;
  const BsdfAxes axes(normal, mirrored);
  const Vec3 d{dot(axes.along, out), dot(axes.across, out), dot(axes.normal, out)};
  const double incidence = std::acos(std::clamp(dot(normal, mirrored), 0.0, 1.0));
  // The share of the upper of two is where a uniform number begins to choose the lower one.
  const std::int32_t upper = bsdf_slice(v, incidence, 0.0), lower = bsdf_slice(v, incidence, 1.0);
  if (upper == lower) return density(upper, incidence, d);
  const auto upper_at = static_cast<std::size_t>(upper), lower_at = static_cast<std::size_t>(lower);
  const double share = (incidence - incidence_[lower_at]) / (incidence_[upper_at] - incidence_[lower_at]);
  return share * density(upper, incidence, d) + (1.0 - share) * density(lower, incidence, d);
}

}  // namespace lucerna
