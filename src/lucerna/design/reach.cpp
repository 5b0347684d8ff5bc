// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/reach.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "lucerna/core/error.h"
#include "lucerna/design/starts.h"
#include "lucerna/rayset/etendue_curve.h"

namespace lucerna {

namespace {

constexpr std::uint64_t kReachRays = std::uint64_t{1} << 18;
/// Shares that are this close to a bound are not called impossible: the curve is known to a few percent.
constexpr double kSlack = 1.05;

/// The largest share of the flux whose brightest part fits into an étendue.
double share_in(const EtendueCurve& curve, double etendue) {
  if (curve.degenerate() || curve.at(1.0) <= etendue) return 1.0;
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (curve.at(middle) <= etendue ? low : high) = middle;
  }
  return low;
}

/// Area of the opening, and half the surface of the sphere about the rays' starts that holds 98 % of them
/// where they start above it.
double opening(const DesignShape& shape, const RayBlock& rays) {
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

}  // namespace

Reach target_reach(const DesignRays& rays, const DesignShape& shape, const TentBins& bins,
                   const Eigen::VectorXd& target, TargetMode mode, double wanted_efficiency) {
  Reach reach;
  const double total = target.sum();
  LUCERNA_CHECK(total > 0.0, "a target without light in its window");
  if (mode == TargetMode::absolute) {
    reach.wanted_share = total;
    if (total > 1.0) {
      reach.statements.push_back(fmt::format(
          "flux: the target has {:.4g} {} in its window, the sources {:.4g}; no mirror adds light",
          total * rays.flux(), symbol(rays.unit()), rays.flux()));
    }
  }
  if (bins.is_plane()) return reach;
  const RayBlock block = rays.first(kReachRays);
  const EtendueCurve curve = etendue_curve(block);
  reach.opening_mm2 = opening(shape, block);

  // The brightest directions first: bins in the order of falling intensity.
  std::vector<std::size_t> order(bins.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto intensity = [&](std::size_t i) {
    const double omega = bins.measure()[i];
    return omega > 0.0 ? target[static_cast<Eigen::Index>(i)] / omega : 0.0;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return intensity(a) > intensity(b); });
  double part = 0.0, etendue = 0.0;
  bool half = false;
  for (const std::size_t i : order) {
    if (!(intensity(i) > 0.0)) break;
    part += target[static_cast<Eigen::Index>(i)] / total;
    const double cosine = std::abs(bin_direction(bins, i, {}).z());
    etendue += bins.measure()[i] * (cosine * reach.opening_mm2);
    reach.most_share = std::min(reach.most_share, share_in(curve, etendue) / part);
    if (half || part < 0.5) continue;
    half = true;
    reach.etendue_mm2sr = etendue;
    const double share = mode == TargetMode::absolute ? std::min(1.0, total * part) : part;
    reach.needed_mm2sr = curve.degenerate() ? 0.0 : curve.at(share);
  }
  const auto etendue_sentence = [&](const char* what, double share) {
    return fmt::format(
        "etendue: an opening of {:.4g} mm2 passes {:.3g} mm2 sr towards the brighter half of the target, "
        "where "
        "the sources' light needs {:.3g}; at most {:.1f} % of it can have the target's distribution, {} "
        "{:.1f} "
        "%. A wider mirror, a smaller source or a wider beam would do",
        reach.opening_mm2, reach.etendue_mm2sr, reach.needed_mm2sr, 100.0 * reach.most_share, what,
        100.0 * share);
  };
  if (reach.wanted_share > 0.0 && reach.wanted_share <= 1.0 &&
      reach.wanted_share > kSlack * reach.most_share) {
    reach.statements.push_back(etendue_sentence("the target asks for", reach.wanted_share));
  }
  if (mode == TargetMode::shape && kSlack * reach.most_share < 1.0) {
    reach.statements.push_back(etendue_sentence("the sources have", 1.0));
  }
  if (wanted_efficiency > kSlack * reach.most_share) {
    reach.statements.push_back(
        fmt::format("efficiency: {:.3f} is asked for, the etendue lets {:.3f} have the target's distribution",
                    wanted_efficiency, reach.most_share));
  }
  return reach;
}

}  // namespace lucerna
