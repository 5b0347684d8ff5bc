// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/zone_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"

namespace lucerna {

namespace {

constexpr std::size_t kZones = 100, kLevels = 9;
/// Tilts per ring across the window: a tilt turns the light by twice as much.
constexpr double kTiltsPerRing = 1.0;
/// Where a ray meets the base nearly along its face, how much more of it a tilted zone may catch.
constexpr double kMostGain = 8.0;

}  // namespace

ZoneTable::ZoneTable(const DesignShape& family, const Reflectance& reflectance, const DesignRays& rays,
                     std::uint64_t count, const TentBins& bins, double half_height_mm,
                     Eigen::VectorXd constant)
    : rings_(bins.size()), half_height_mm_(half_height_mm), constant_(std::move(constant)) {
  LUCERNA_CHECK(family.is_revolution() && bins.is_rings(), "zones of a mirror without symmetry");
  const double radius = family.aperture().outer_radius_mm(), k = 0.25 / family.focal_mm();
  for (std::size_t j = 0; j < kZones; ++j) {
    const double r = radius * (static_cast<double>(j) + 0.5) / kZones;
    zones_.push_back({r, std::atan(2.0 * k * r)});
  }
  level_step_mm_ = 2.0 * half_height_mm / (kLevels - 1);
  // The paraboloid sends light along the axis: a zone that turns it out of the window is lost to it.
  half_tilt_ = std::min(0.6, 0.75 * bins.extent() + 0.1);
  tilt_step_ = 0.5 * bins.extent() / static_cast<double>(rings_) / kTiltsPerRing * 2.0;
  tilts_ = static_cast<std::size_t>(std::ceil(2.0 * half_tilt_ / tilt_step_)) + 1;
  tilt_step_ = 2.0 * half_tilt_ / static_cast<double>(tilts_ - 1);
  table_.assign(kLevels * kZones * tilts_ * rings_, 0.0f);
  parallel_blocks(kLevels, 1, [&](std::size_t level, std::size_t) {
    fill(level, family, reflectance, rays, count, bins);
  });
}

void ZoneTable::fill(std::size_t level, const DesignShape& family, const Reflectance& reflectance,
                     const DesignRays& rays, std::uint64_t count, const TentBins& bins) {
  const double k = 0.25 / family.focal_mm(), radius = family.aperture().outer_radius_mm();
  const double hole = family.aperture().hole_radius_mm();
  const double h = static_cast<double>(level) * level_step_mm_ - half_height_mm_;
  const double side = bins.axes().ez().z;
  const double cell = bins.extent() / static_cast<double>(rings_);
  const double least_cos = std::cos(std::min(std::numbers::pi, bins.extent() + 0.5 * cell));
  std::vector<double> cos_2t(tilts_), sin_2t(tilts_), tan_t(tilts_);
  for (std::size_t t = 0; t < tilts_; ++t) {
    const double tilt = static_cast<double>(t) * tilt_step_ - half_tilt_;
    cos_2t[t] = std::cos(2.0 * tilt);
    sin_2t[t] = std::sin(2.0 * tilt);
    tan_t[t] = std::tan(tilt);
  }
  double all = 0.0;
  for (std::uint64_t b = 0; b < count / kBlockRays; ++b) {
    const DesignRays::Block& block = rays.block(b);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const double weight = block.weight[i];
      all += weight;
      const Vec3 o{block.x_mm[i], block.y_mm[i], block.z_mm[i]}, d{block.kx[i], block.ky[i], block.kz[i]};
      const double c0 = o.z - h - k * (o.x * o.x + o.y * o.y), c1 = d.z - 2.0 * k * (o.x * d.x + o.y * d.y);
      const double c2 = k * (d.x * d.x + d.y * d.y) + 1e-30, root = c1 * c1 + 4.0 * c2 * c0;
      if (!(c0 > 0.0)) continue;
      const double w = std::sqrt(root), t_hit = c1 > 0.0 ? (c1 + w) / (2.0 * c2) : 2.0 * c0 / (w - c1);
      const double x = o.x + t_hit * d.x, y = o.y + t_hit * d.y, r = std::sqrt(x * x + y * y);
      if (!(r < radius && r >= hole && r > 0.0)) continue;
      const double d_r = (d.x * x + d.y * y) / r, p = 2.0 * k * r;
      const double facing = p * d_r - d.z;  // > 0 on the face
      if (!(facing > 0.0)) continue;
      const double per = 1.0 / (1.0 + p * p), sin_2 = 2.0 * p * per, cos_2 = (1.0 - p * p) * per;
      const double along = d_r * sin_2 - d.z * cos_2, across = d_r * cos_2 + d.z * sin_2;
      const double energy = weight * reflectance.at(std::min(1.0, facing * std::sqrt(per)));
      const auto zone = std::min(kZones - 1, static_cast<std::size_t>(r / radius * kZones));
      for (std::size_t t = 0; t < tilts_; ++t) {
        const double c = side * (along * cos_2t[t] + across * sin_2t[t]);
        if (!(c > least_cos)) continue;
        const double slope = (p + tan_t[t]) / (1.0 - p * tan_t[t]);
        const double gain = (slope * d_r - d.z) / facing;
        if (!(gain > 0.0)) continue;
        const double s = std::acos(std::min(1.0, c)) / cell - 0.5;
        const double e = energy * std::min(kMostGain, gain);
        float* to = row(level, zone, t);
        if (s < 0.0) {
          to[0] += static_cast<float>(e);
          continue;
        }
        const auto ring = static_cast<std::size_t>(s);
        if (ring >= rings_) continue;
        const double f = s - static_cast<double>(ring);
        to[ring] += static_cast<float>((1.0 - f) * e);
        if (ring + 1 < rings_) to[ring + 1] += static_cast<float>(f * e);
      }
    }
  }
  const auto per_all = static_cast<float>(1.0 / all);
  float* first = row(level, 0, 0);
  for (std::size_t i = 0; i < zones_.size() * tilts_ * rings_; ++i) first[i] *= per_all;
}

Evaluation ZoneTable::evaluate(const DesignShape& shape) const {
  const auto& profile = std::get<RevolutionShape>(shape.family());
  const std::vector<int>& parameter_of = shape.parameter_of();
  const auto n = static_cast<Eigen::Index>(shape.parameter_count()), m = static_cast<Eigen::Index>(rings_);
  Eigen::VectorXf flux = Eigen::VectorXf::Zero(m), by_height(m), by_slope(m);
  Eigen::MatrixXf jacobian = Eigen::MatrixXf::Zero(m, n);
  using Row = Eigen::Map<const Eigen::VectorXf>;
  const RevolutionView view = profile.view();
  const double k2 = 0.5 / profile.focal_mm();
  for (std::size_t j = 0; j < zones_.size(); ++j) {
    const Zone& zone = zones_[j];
    const KnotRow::Place place = profile.row().place(zone.r_mm);
    const CubicBasis basis = cubic_basis(place.t), slope = cubic_basis_slope(place.t);
    const auto [s, s_r] = view.offset_at(zone.r_mm);
    const double p = k2 * zone.r_mm + s_r;
    const double a = (std::atan(p) - zone.angle_rad + half_tilt_) / tilt_step_;
    const double b = (s + half_height_mm_) / level_step_mm_;
    if (!(a >= 0.0 && a < static_cast<double>(tilts_ - 1))) continue;  // out of the window
    const auto it = static_cast<std::size_t>(a);
    const auto ih = static_cast<std::size_t>(std::clamp(b, 0.0, static_cast<double>(kLevels) - 1.001));
    const auto ft = static_cast<float>(a - static_cast<double>(it));
    const auto fh = static_cast<float>(std::clamp(b - static_cast<double>(ih), 0.0, 1.0));
    const Row low(row(ih, j, it), m), low_next(row(ih, j, it + 1), m);
    const Row high(row(ih + 1, j, it), m), high_next(row(ih + 1, j, it + 1), m);
    by_slope = (1.0f - fh) * (low_next - low) + fh * (high_next - high);
    by_height = (1.0f - ft) * (high - low) + ft * (high_next - low_next);
    flux += (1.0f - fh) * low + fh * high + ft * by_slope;
    const double per_slope = 1.0 / ((1.0 + p * p) * tilt_step_ * profile.row().step_mm);
    for (std::size_t c = 0; c < 4; ++c) {
      jacobian.col(parameter_of[static_cast<std::size_t>(place.first) + c]) +=
          static_cast<float>(per_slope * slope[c]) * by_slope +
          static_cast<float>(basis[c] / level_step_mm_) * by_height;
    }
  }
  Evaluation e;
  e.flux = flux.cast<double>() + constant_;
  e.variance = Eigen::VectorXd::Zero(m);
  e.jacobian = jacobian.cast<double>();
  return e;
}

}  // namespace lucerna
