// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/constraints/light_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

constexpr double kRing_deg = 5.0;
constexpr int kSectors = 12;
/// Of a limit: where its cost begins inside it, and the excess that costs as much as an error of 100 %.
constexpr double kMargin = 0.05;

TentBins glare_zone(double beyond_deg) {
  const int rings = std::max(2, static_cast<int>(std::lround((180.0 - beyond_deg) / kRing_deg)) - 1);
  return TentBins::zone(Frame(), radians(beyond_deg), rings, kSectors);
}

}  // namespace

LightLimits::LightLimits(const DesignLimits& limits, const Reflectance& reflectance)
    : glare_(limits.glare), min_efficiency_(limits.min_efficiency), reflectance_(reflectance) {
  if (glare_) zone_ = glare_zone(glare_->beyond_deg);
}

Evaluation LightLimits::trace(const DesignShape& shape, const DesignRays& rays, std::uint64_t n,
                              const TentBins& bins, bool derivatives) const {
  EvaluationOptions options;
  options.rays = n;
  options.derivatives = derivatives;
  return evaluate(shape, reflectance_, rays, bins, options);
}

double LightLimits::cost(const DesignShape& shape, const DesignRays& rays, std::uint64_t n,
                         ResidualRows* rows) const {
  double cost = 0.0;
  if (glare_) {
    const Evaluation e = trace(shape, rays, n, *zone_, rows != nullptr);
    for (Eigen::Index b = 0; b < e.flux.size(); ++b) {
      const double per =
          1.0 / (kMargin * glare_->max_per_flux * zone_->measure()[static_cast<std::size_t>(b)]);
      const double excess = per * e.flux[b] - (1.0 - kMargin) / kMargin;
      if (excess <= 0.0) continue;
      cost += excess * excess;
      if (rows == nullptr) continue;
      rows->begin(excess);
      for (Eigen::Index p = 0; p < e.jacobian.cols(); ++p) {
        if (e.jacobian(b, p) != 0.0) rows->add(static_cast<int>(p), per * e.jacobian(b, p));
      }
    }
  }
  if (min_efficiency_) {
    const Evaluation e = trace(shape, rays, n, TentBins::rings(Frame(), std::numbers::pi, 2), false);
    const double missing = (*min_efficiency_ - e.reflected - e.direct) / kMargin;
    if (missing > 0.0) cost += missing * missing;
  }
  return cost;
}

void LightLimits::check(const DesignShape& start, const DesignRays& rays) const {
  if (!min_efficiency_) return;
  const Aperture& a = start.aperture();
  const double outer = std::min(a.half_x_mm(), a.half_y_mm()), hole = a.hole_radius_mm();
  double incident = 0.0, all = 0.0;
  const std::uint64_t blocks = rays.size() / kBlockRays;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const DesignRays::Block& block = rays.block(b);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const double weight = static_cast<double>(block.weight[i]);
      all += weight;
      const auto x = static_cast<double>(block.x_mm[i]), y = static_cast<double>(block.y_mm[i]);
      const double r = std::hypot(x, y);
      const double down = -static_cast<double>(block.kz[i]);
      const double aside = static_cast<double>(std::hypot(block.kx[i], block.ky[i]));
      const double height = static_cast<double>(block.z_mm[i]) - start.at(x, y).z_mm;
      if (r > outer || height <= 0.0 || down <= aside) continue;
      const double reach = height / down * aside;  // sideways until the start's height, and as much again
      if (r + 2.0 * reach > outer || (hole > 0.0 && r - 2.0 * reach < hole)) continue;
      incident += weight;
    }
  }
  const double max = 1.0 - (1.0 - reflectance_.max()) * incident / all;
  if (*min_efficiency_ <= max) return;
  throw InputError(
      fmt::format("design.limits: min_efficiency = {} and the reflector's reflectance, at most {}, "
                  "contradict each other: "
                  "at least {:.0f} % of the light hits the mirror, so that no more than {:.3f} leaves",
                  *min_efficiency_, reflectance_.max(), 100.0 * incident / all, max),
      ErrorCause::contradiction);
}

}  // namespace lucerna
