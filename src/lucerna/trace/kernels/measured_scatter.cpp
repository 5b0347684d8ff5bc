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

/// By the midpoint rule over solid angle.
double light_in(const BsdfCell& cell) {
  const int n = is_cut(cell) ? kPointsAtHorizon : kPoints;
  const double high = std::cos(cell.radial_from), low = std::cos(cell.radial_to);
  const double wide = cell.azimuth_to - cell.azimuth_from;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k)
      sum += cell.density(cell.azimuth_from + wide * (i + 0.5) / n, low + (high - low) * (k + 0.5) / n);
  }
  return sum * wide * (high - low) / (n * n);
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

double MeasuredScatter::density(std::int32_t slice, const Direction& normal, const Direction& mirrored,
                                const Direction& out) const {
  const BsdfView& v = view_;
  const BsdfFrame frame = bsdf_frame(v, slice, normal, mirrored);
  const double cos_radial = std::clamp(dot(frame.pole, out), -1.0, 1.0), radial = std::acos(cos_radial);
  if (radial > radial_.back()) return 0.0;
  const Direction& x = frame.azimuth_0;
  double azimuth = std::atan2(dot(cross(frame.pole.vec(), x.vec()), out.vec()), dot(x, out));
  if (azimuth < 0.0) azimuth = v.is_symmetrical ? -azimuth : azimuth + 2.0 * std::numbers::pi;
  const auto cell_of = [](const std::vector<double>& angles, double angle) {
    return std::max(first_above(angles.data(), static_cast<std::int32_t>(angles.size()), angle), 1) - 1;
  };
  const BsdfCell cell(v, slice, cell_of(azimuth_, azimuth) * (v.radials - 1) + cell_of(radial_, radial));
  return cell.density(azimuth, cos_radial) / integrals_[static_cast<std::size_t>(slice)];
}

double MeasuredScatter::density(const Direction& normal, const Direction& mirrored,
                                const Direction& out) const {
  const BsdfView& v = view_;
  const double incidence = std::acos(std::clamp(dot(normal, mirrored), 0.0, 1.0));
  // The share of the upper of two is where a uniform number begins to choose the lower one.
  const std::int32_t upper = bsdf_slice(v, incidence, 0.0), lower = bsdf_slice(v, incidence, 1.0);
  const auto upper_at = static_cast<std::size_t>(upper), lower_at = static_cast<std::size_t>(lower);
  const double share =
      upper == lower ? 1.0
                     : (incidence - incidence_[lower_at]) / (incidence_[upper_at] - incidence_[lower_at]);
  const Direction image = reflect(out, normal);
  const auto of = [&](std::int32_t slice) {
    return density(slice, normal, mirrored, out) + density(slice, normal, mirrored, image);
  };
  return share * of(upper) + (share < 1.0 ? (1.0 - share) * of(lower) : 0.0);
}

}  // namespace lucerna
