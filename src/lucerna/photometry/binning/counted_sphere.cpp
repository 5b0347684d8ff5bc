// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/binning/counted_sphere.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/photometry/binning/binned_intensity.h"

namespace lucerna {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
/// Planes further apart than this are cut.
constexpr std::size_t kMinPlanes = 72;
/// Planes to either side that a kernel spans at least: a mean needs its neighbours, a quadratic two of them.
constexpr double kMeanPlanes = 1.2, kFitPlanes = 2.4;
constexpr double kWidestC_rad = kWidestKernelC_deg * std::numbers::pi / 180.0;

/// Into how many parts each of `planes` is cut; odd, so that one lies where the plane was.
std::size_t parts_of(std::size_t planes) {
  if (planes >= kMinPlanes) return 1;
  return ((kMinPlanes + planes - 1) / planes) | std::size_t{1};
}

/// The directions of growing C and gamma about a direction.
struct Axes {
  Vec3 centre, to_c, to_gamma;
  explicit Axes(const TypeCAngles& at)
      : centre(direction_from_type_c(at).vec()),
        to_c{-std::sin(at.c_rad), std::cos(at.c_rad), 0.0},
        to_gamma{std::cos(at.gamma_rad) * std::cos(at.c_rad), std::cos(at.gamma_rad) * std::sin(at.c_rad),
                 std::sin(at.gamma_rad)} {}
};

JackknifedFlux cut_planes(const JackknifedFlux& flux, std::size_t planes, std::size_t gammas,
                          std::size_t parts) {
  JackknifedFlux out(flux.cells() * parts, flux.replicates());
  const std::size_t all = planes * parts;
  for (std::size_t c = 0; c < all; ++c) {
    const std::size_t from = ((c + parts / 2) / parts) % planes;
    for (std::size_t g = 0; g < gammas; ++g) {
      const auto row = flux.row(from * gammas + g);
      const auto to = out.row(c * gammas + g);
      for (std::size_t i = 0; i < row.size(); ++i) to[i] = row[i] / static_cast<double>(parts);
    }
  }
  return out;
}

}  // namespace

Jackknife LocalFit::at(double x, double y) const {
  Jackknife value = coefficients[0];
  const double powers[6] = {1.0, x, y, x * x, x * y, y * y};
  for (std::size_t k = 1; k < 6; ++k) value.add(powers[k], coefficients[k].values());
  return value;
}

Direction LocalFit::direction(double x, double y) const {
  const double across = x * x_radius_rad, along = y * y_radius_rad;
  if (!round) {
    return direction_from_type_c(
        {centre.c_rad + across / std::sin(centre.gamma_rad), centre.gamma_rad + along});
  }
  const Axes axes(centre);
  const double rest = std::sqrt(std::max(0.0, 1.0 - across * across - along * along));
  return Direction::from(across * axes.to_c + along * axes.to_gamma + rest * axes.centre);
}

CountedSphere::CountedSphere(std::size_t planes, std::size_t gammas, FluxUnit unit,
                             const JackknifedFlux& flux, bool tent)
    : gammas_(gammas), unit_(unit) {
  if (planes < 1 || gammas < 3 || flux.cells() != planes * gammas) {
    throw InputError(
        fmt::format("{} cells, expected {} planes of {} gammas, at least 3", flux.cells(), planes, gammas));
  }
  const std::size_t parts = parts_of(planes);
  planes_ = planes * parts;
  flux_ = parts == 1 ? flux : cut_planes(flux, planes, gammas, parts);
  all_ = flux_.fluxes();
  c_step_rad_ = kTurn / static_cast<double>(planes_);
  gamma_step_rad_ = std::numbers::pi / static_cast<double>(gammas - 1);
  std::vector<double> gamma_deg(gammas);
  for (std::size_t g = 0; g < gammas; ++g) gamma_deg[g] = degrees(gamma_step_rad_ * static_cast<double>(g));
  gamma_deg.back() = 180.0;
  const std::vector<double> dealt = tent ? tent_integrals(gamma_deg) : std::vector<double>();
  for (std::size_t g = 0; g < gammas; ++g) {
    const bool pole = g == 0 || g + 1 == gammas;
    const double middle = gamma_step_rad_ * static_cast<double>(g);
    // The centroid of a wedge of a small cap is two thirds of its radius from the pole.
    const double centroid =
        !pole ? middle : (g == 0 ? gamma_step_rad_ / 3.0 : std::numbers::pi - gamma_step_rad_ / 3.0);
    const double band = pole ? 2.0 * std::pow(std::sin(0.25 * gamma_step_rad_), 2.0)
                             : 2.0 * std::sin(middle) * std::sin(0.5 * gamma_step_rad_);
    gamma_rad_.push_back(centroid);
    cos_gamma_.push_back(std::cos(centroid));
    sin_gamma_.push_back(std::sin(centroid));
    solid_angle_sr_.push_back(c_step_rad_ * (tent ? dealt[g] : band));
  }
  for (std::size_t c = 0; c < planes_; ++c) {
    cos_c_.push_back(std::cos(c_step_rad_ * static_cast<double>(c)));
    sin_c_.push_back(std::sin(c_step_rad_ * static_cast<double>(c)));
  }
}

double CountedSphere::resolution_deg() const { return degrees(1.5 * gamma_step_rad_); }

double CountedSphere::resolution_along_c_deg(const Direction& direction) const {
  return degrees(std::min(kMeanPlanes * c_step_rad_, kWidestC_rad) *
                 std::sin(type_c_angles(direction).gamma_rad));
}

CountedSphere::Window CountedSphere::window(const Direction& direction, const Kernel& kernel,
                                            double planes) const {
  const TypeCAngles at = type_c_angles(direction);
  const Axes axes(at);
  const double high = radians(kernel.radius_deg), sin_at = std::sin(at.gamma_rad);
  const double asked = std::min(radians(kernel.c_radius_deg), kWidestC_rad * sin_at);
  const double wide = std::max({high, asked, std::min(planes * c_step_rad_, kWidestC_rad) * sin_at});
  return {at, axes.centre, axes.to_c, axes.to_gamma, high, wide, wide <= 1.001 * high};
}

template <class Visit>
void CountedSphere::for_cells_of_row(const Window& w, std::size_t g, double half_c_rad,
                                     const Visit& visit) const {
  std::size_t from = 0, count = planes_;
  const double middle = w.at.c_rad / c_step_rad_, half = half_c_rad / c_step_rad_;
  if (half_c_rad < std::numbers::pi) {
    const double low = std::ceil(middle - half), top = std::floor(middle + half);
    if (top < low) return;
    count = std::min(planes_, static_cast<std::size_t>(top - low) + 1);
    from = static_cast<std::size_t>(low + static_cast<double>(planes_)) % planes_;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t c = from + k < planes_ ? from + k : from + k - planes_;
    double x = 0.0, y = 0.0;
    if (w.round) {
      const Vec3 p{sin_gamma_[g] * cos_c_[c], sin_gamma_[g] * sin_c_[c], -cos_gamma_[g]};
      x = dot(p, w.to_c) / w.wide_rad;
      y = dot(p, w.to_gamma) / w.high_rad;
    } else {
      const double off = std::remainder(static_cast<double>(c) - middle, static_cast<double>(planes_));
      x = off * c_step_rad_ * std::sin(w.at.gamma_rad) / w.wide_rad;
      y = (gamma_rad_[g] - w.at.gamma_rad) / w.high_rad;
    }
    const double weight = 1.0 - x * x - y * y;
    if (weight > 0.0) visit(c * gammas_ + g, g, x, y, weight);
  }
}

template <class Visit>
void CountedSphere::for_cells_in(const Window& w, const Visit& visit) const {
  const double cos_at = std::cos(w.at.gamma_rad), sin_at = std::sin(w.at.gamma_rad);
  const double cos_radius = std::cos(w.high_rad);
  const double low = (w.at.gamma_rad - w.high_rad) / gamma_step_rad_,
               high = (w.at.gamma_rad + w.high_rad) / gamma_step_rad_ + 1.0;
  const auto first = static_cast<std::size_t>(std::max(0.0, low));
  const auto last = std::min(gammas_ - 1, static_cast<std::size_t>(std::max(0.0, high)));
  for (std::size_t g = first; g <= last; ++g) {
    if (!w.round) {
      for_cells_of_row(w, g, w.wide_rad / sin_at, visit);
      continue;
    }
    const double across = sin_gamma_[g] * sin_at, rest = cos_radius - cos_gamma_[g] * cos_at;
    if (rest > across) continue;
    for_cells_of_row(w, g, rest > -across ? std::acos(rest / across) : kTurn, visit);
  }
}

Jackknife CountedSphere::mean_cd(const Direction& direction, const Kernel& kernel) const {
  Jackknife sum(replicates());
  double area = 0.0;
  for_cells_in(window(direction, kernel, kMeanPlanes),
               [&](std::size_t cell, std::size_t g, double, double, double weight) {
                 sum.add(weight, flux_.row(cell));
                 area += weight * solid_angle_sr_[g];
               });
  for (double& v : sum.values()) v = area > 0.0 ? v / area : 0.0;
  return sum;
}

double CountedSphere::mean_cd_of(std::span<const double> flux, const Direction& direction,
                                 const Kernel& kernel) const {
  double sum = 0.0, area = 0.0;
  for_cells_in(window(direction, kernel, kMeanPlanes),
               [&](std::size_t cell, std::size_t g, double, double, double weight) {
                 sum += weight * flux[cell];
                 area += weight * solid_angle_sr_[g];
               });
  return area > 0.0 ? sum / area : 0.0;
}

std::vector<double> CountedSphere::half_of_flux(bool odd) const {
  std::vector<double> half(flux_.cells());
  for (std::size_t i = 0; i < half.size(); ++i) half[i] = half_estimate(flux_.row(i), odd).mean;
  return half;
}

LocalFit CountedSphere::fit(const Direction& direction, const Kernel& kernel) const {
  const Window w = window(direction, kernel, kFitPlanes);
  LocalFit out{w.at, w.wide_rad, w.high_rad, w.round, {}};
  for (Jackknife& c : out.coefficients) c = Jackknife(replicates());
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  for_cells_in(w, [&](std::size_t cell, std::size_t g, double x, double y, double weight) {
    // A cell holds the mean of the quadratic over it: its second moments are its centre's and its own. About
    // a pole cells are so narrow that only their height counts, whichever way it points.
    const double wide = c_step_rad_ * sin_gamma_[g] / w.wide_rad, high = gamma_step_rad_ / w.high_rad;
    const bool turned = w.at.gamma_rad < w.high_rad || std::numbers::pi - w.at.gamma_rad < w.high_rad;
    const double xx = turned ? 0.5 * high * high : wide * wide, yy = turned ? xx : high * high;
    Eigen::Matrix<double, 6, 1> basis;
    basis << 1.0, x, y, x * x + xx / 12.0, x * y, y * y + yy / 12.0;
    normal.noalias() += weight * solid_angle_sr_[g] * basis * basis.transpose();
    const auto row = flux_.row(cell);
    for (std::size_t k = 0; k < 6; ++k)
      out.coefficients[k].add(weight * basis[static_cast<Eigen::Index>(k)], row);
  });
  // Too few cells for six coefficients leave the rest near zero instead of wild.
  normal.diagonal().array() += 1e-9 * normal(0, 0) + 1e-300;
  const auto solver = normal.ldlt();
  for (std::size_t i = 0; i <= replicates(); ++i) {
    Eigen::Matrix<double, 6, 1> v;
    for (std::size_t k = 0; k < 6; ++k) v[static_cast<Eigen::Index>(k)] = out.coefficients[k].values()[i];
    v = solver.solve(v).eval();
    for (std::size_t k = 0; k < 6; ++k) out.coefficients[k].values()[i] = v[static_cast<Eigen::Index>(k)];
  }
  return out;
}

/// Sums rows of cells between two gammas; `share_of_plane(c)` is the part of the cells of a plane that
/// counts.
template <class Share>
Jackknife CountedSphere::band_flux(double from_deg, double to_deg, const Share& share_of_plane) const {
  Jackknife sum(replicates());
  const double from = radians(from_deg), to = radians(to_deg);
  for (std::size_t g = 0; g < gammas_; ++g) {
    const double middle = gamma_step_rad_ * static_cast<double>(g);
    const double low = std::max(0.0, middle - 0.5 * gamma_step_rad_),
                 high = std::min(std::numbers::pi, middle + 0.5 * gamma_step_rad_);
    const double a = std::clamp(from, low, high), b = std::clamp(to, low, high);
    const double share = (std::cos(a) - std::cos(b)) / (std::cos(low) - std::cos(high));
    if (share <= 0.0) continue;
    for (std::size_t c = 0; c < planes_; ++c) {
      const double part = share * share_of_plane(c);
      if (part > 0.0) sum.add(part, flux_.row(c * gammas_ + g));
    }
  }
  return sum;
}

Jackknife CountedSphere::zone_flux(double from_deg, double to_deg) const {
  return band_flux(from_deg, to_deg, [](std::size_t) { return 1.0; });
}

Jackknife CountedSphere::half_zone_flux(double from_deg, double to_deg, double c_deg) const {
  const double step = degrees(c_step_rad_);
  return band_flux(from_deg, to_deg, [&](std::size_t c) {
    const double off = std::abs(std::remainder(static_cast<double>(c) * step - c_deg, 360.0));
    return std::clamp((90.0 - off) / step + 0.5, 0.0, 1.0);
  });
}

}  // namespace lucerna
