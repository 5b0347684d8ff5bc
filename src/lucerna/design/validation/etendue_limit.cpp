// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/etendue_limit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/design/evaluation/tent_bins.h"

namespace lucerna {

namespace {

/// Bins in the order of falling intensity; dark ones left out.
std::vector<std::size_t> brightest_first(const TentBins& bins, const Eigen::VectorXd& target) {
  const auto intensity = [&](std::size_t i) {
    const double omega = bins.measure()[i];
    return omega > 0.0 ? target[static_cast<Eigen::Index>(i)] / omega : 0.0;
  };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    if (intensity(i) > 0.0) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return intensity(a) > intensity(b); });
  return order;
}

/// What the étendue of the opening lets the sources send, by their curve.
void bound_by_etendue(const EtendueCurve& curve, const TentBins& bins, const Eigen::VectorXd& target,
                      TargetMode mode, EtendueLimit& limit) {
  const double total = target.sum();
  double part = 0.0, etendue = 0.0;
  bool half = false;
  limit.max_share = 1.0;
  for (const std::size_t i : brightest_first(bins, target)) {
    part += target[static_cast<Eigen::Index>(i)] / total;
    const double cosine = std::abs(bin_direction(bins, i, {}).z());
    etendue += bins.measure()[i] * (cosine * limit.opening_mm2);
    limit.max_share = std::min(limit.max_share, share_in(curve, etendue) / part);
    if (half || part < 0.5) continue;
    half = true;
    limit.etendue_mm2sr = etendue;
    const double share = mode == TargetMode::absolute ? std::min(1.0, total * part) : part;
    limit.needed_mm2sr = curve.degenerate() ? 0.0 : curve.at(share);
  }
}

/// What that forbids.
std::vector<std::string> etendue_statements(const EtendueLimit& limit, TargetMode mode,
                                            double min_efficiency) {
  std::vector<std::string> statements;
  const auto forbids = [&](const char* what, double share) {
    statements.push_back(fmt::format(
        "etendue: an opening of {:.4g} mm2 passes {:.3g} mm2 sr towards the brighter half of the target, "
        "where the sources' light needs {:.3g}; at most {:.1f} % of it can have the target's distribution, "
        "{} {:.1f} %",
        limit.opening_mm2, limit.etendue_mm2sr, limit.needed_mm2sr, 100.0 * limit.max_share, what,
        100.0 * share));
  };
  const double max = kEtendueTolerance * limit.max_share;
  if (limit.target_share > max && limit.target_share <= 1.0) {
    forbids("the target asks for", limit.target_share);
  }
  if (mode == TargetMode::shape && max < 1.0) forbids("the sources have", 1.0);
  if (min_efficiency > max) {
    statements.push_back(
        fmt::format("efficiency: {:.3f} is asked for, the etendue lets {:.3f} have the target's distribution",
                    min_efficiency, limit.max_share));
  }
  return statements;
}

}  // namespace

double share_in(const EtendueCurve& curve, double etendue_mm2sr) {
  if (curve.degenerate() || curve.at(1.0) <= etendue_mm2sr) return 1.0;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (curve.at(middle) <= etendue_mm2sr ? low : high) = middle;
  }
  return low;
}

double opening_mm2(const DesignShape& shape, const RayBlock& rays) {
  const Aperture& a = shape.aperture();
  const double outline = a.shape() == ApertureShape::circle ? std::numbers::pi * a.half_x_mm() * a.half_x_mm()
                                                            : 4.0 * a.half_x_mm() * a.half_y_mm();
  Vec3 mean;
  const auto n = static_cast<double>(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) mean += rays.ray(i).origin_mm / n;
  std::vector<double> distance;
  for (std::size_t i = 0; i < rays.size(); ++i) distance.push_back(length(rays.ray(i).origin_mm - mean));
  const auto at = distance.begin() + static_cast<std::ptrdiff_t>(0.98 * n);
  std::nth_element(distance.begin(), at, distance.end());
  return outline + std::numbers::pi * *at * *at;
}

EtendueLimit etendue_limit(const DesignRays& rays, SourceEtendue& etendue, const DesignShape& shape,
                           const TentBins& bins, const Eigen::VectorXd& target, TargetMode mode,
                           double min_efficiency) {
  EtendueLimit limit;
  const double total = target.sum();
  LUCERNA_CHECK(total > 0.0, "a target without light in its window");
  if (mode == TargetMode::absolute) {
    limit.target_share = total;
    if (total > 1.0) {
      limit.statements.push_back(fmt::format(
          "flux: the target has {:.4g} {} in its window, the sources {:.4g}; no mirror adds light",
          total * rays.flux(), symbol(rays.unit()), rays.flux()));
    }
  }
  if (bins.is_plane()) return limit;
  limit.opening_mm2 = opening_mm2(shape, etendue.rays());
  bound_by_etendue(etendue.quick(), bins, target, mode, limit);
  if (!etendue_statements(limit, mode, min_efficiency).empty()) {
    bound_by_etendue(etendue.searched(), bins, target, mode, limit);
  }
  const auto forbidden = etendue_statements(limit, mode, min_efficiency);
  limit.statements.insert(limit.statements.end(), forbidden.begin(), forbidden.end());
  return limit;
}

}  // namespace lucerna
